//! One environment.

use crate::actions::{self, Checked};
use crate::errors::{self, ConfigurationError, gymnasium_error, to_python};
use crate::scalars::float64;
use crate::vehicles::{ActuatorTuple, DEFAULT_ARCHITECTURE, SignalNames, action_tuple, layout_dict};
use hp_episode::action::{ActionTable, GROUPS};
use hp_episode::episode::{self, Clock, Facts, Outcome};
use hp_episode::guard::{Guarded, caught, done};
use hp_episode::observation::Observed;
use hp_episode::reward::{PART_NAMES, Parts, RewardParameters, TERM_NAMES, Terms};
use hp_episode::rows::RowSet;
use hp_episode::setup::{Origin, Settings, Setup, Source, Told};
use hp_plant::command::ACTUATOR_PLACES;
use hp_plant::config::vehicle::architecture;
use numpy::{IntoPyArray, PyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBytes, PyDict, PyString, PyTuple};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Settings from JSON, made ready for environments whose trips come from these origins, with the source of each.
pub fn setup(settings: &str, origins: &[Origin]) -> PyResult<(Arc<Setup>, Vec<Source>)> {
    let read = &mut serde_json::Deserializer::from_str(settings);
    let settings: Settings = serde_path_to_error::deserialize(read).map_err(|error| {
        let key = error.path().to_string();
        ConfigurationError::new_err(format!("setting `{key}`: {}", error.into_inner()))
    })?;
    caught(|| Setup::new(&settings, origins)).map_err(to_python)
}

/// Source of trips of one reset; none where it names no scenario and no distribution.
pub fn once(setup: &Setup, origin: Origin) -> PyResult<Option<Source>> {
    if origin.scenario.is_none() && origin.distribution.is_none() {
        return Ok(None);
    }
    caught(|| setup.source(&origin)).map(Some).map_err(to_python)
}

/// Present values of all signals.
pub fn looked(episode: &episode::Episode) -> Vec<f64> {
    let mut row = Vec::new();
    if let (Some((_, experiment)), Some(run)) = (episode.trip(), episode.run()) {
        experiment.look(run, &mut row);
    }
    row
}

/// Speed at every full second of a trip.
pub fn speeds_m_s(episode: &episode::Episode) -> Vec<f64> {
    episode.trip().map_or_else(Vec::new, |(_, experiment)| experiment.cycle.speeds_m_s().to_vec())
}

/// What a trip is, by name.
pub fn facts_dict<'py>(py: Python<'py>, facts: Option<&Facts>) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    if let Some(facts) = facts {
        dict.set_item(intern!(py, "scenario"), &*facts.scenario)?;
        dict.set_item(intern!(py, "vehicle"), &facts.vehicle)?;
        dict.set_item(intern!(py, "cycle"), &facts.cycle)?;
        dict.set_item(intern!(py, "window_s"), facts.window_s)?;
        dict.set_item(intern!(py, "duration_s"), facts.duration_s)?;
        dict.set_item(intern!(py, "ambient_temperature_degc"), facts.ambient_temperature_degc)?;
    }
    Ok(dict)
}

/// Names of the parts of a reward, made once: strings that nobody keeps would be interned and forgotten at each step.
fn part_names(py: Python<'_>) -> &'static [Py<PyString>] {
    static NAMES: PyOnceLock<Vec<Py<PyString>>> = PyOnceLock::new();
    NAMES.get_or_init(py, || PART_NAMES.iter().map(|name| PyString::intern(py, name).unbind()).collect())
}

/// What is told of a step: the parts of its reward, and what else is wanted. Nothing was paid where a trip has just begun.
pub fn step_info<'py>(
    py: Python<'py>,
    told: &[Told],
    (parts, terms): (&Parts, &Terms),
    mask: impl FnOnce() -> Vec<bool>,
) -> PyResult<Bound<'py, PyDict>> {
    let info = PyDict::new(py);
    for (name, &part) in part_names(py).iter().zip(parts) {
        info.set_item(name, float64(py, part)?)?;
    }
    if told.is_empty() {
        return Ok(info);
    }
    if told.contains(&Told::Cost) {
        info.set_item(intern!(py, "cost"), float64(py, terms.cost())?)?;
    }
    if told.contains(&Told::Terms) {
        for (name, value) in TERM_NAMES.iter().zip(terms.values()) {
            info.set_item(PyString::intern(py, name), float64(py, value)?)?;
        }
    }
    if told.contains(&Told::ActionMask) {
        let mask: Vec<i8> = mask().into_iter().map(i8::from).collect();
        info.set_item(intern!(py, "action_mask"), mask.into_pyarray(py))?;
    }
    Ok(info)
}

/// Options that the plant would grant in the coming second.
pub fn mask_of(episode: &episode::Episode) -> Vec<bool> {
    let mut mask = vec![true; episode.setup().actions.mask_length()];
    episode.write_mask(&mut mask);
    mask
}

/// KPIs of a trip by name.
pub fn kpis<'py>(py: Python<'py>, terms: &Terms, weights: &RewardParameters) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in terms.kpis(weights) {
        dict.set_item(name, value)?;
    }
    Ok(dict)
}

/// Numbers by name; NaN where a quantity does not exist.
pub fn by_name<'py>(py: Python<'py>, values: Vec<(String, Option<f64>)>) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in values {
        dict.set_item(name, value.unwrap_or(f64::NAN))?;
    }
    Ok(dict)
}

/// Share of the observations of the trip in which each row was clipped, by name.
pub fn clipped_shares<'py>(py: Python<'py>, episode: &episode::Episode) -> PyResult<Bound<'py, PyDict>> {
    let rows = episode.setup().observations.rows().iter();
    let shares = rows.zip(episode.clipped_shares());
    by_name(py, shares.map(|(row, share)| (row.name.clone(), Some(share))).collect())
}

/// What a step gives: observation, reward, terminated, truncated, info.
type Step<'py> = (Bound<'py, PyArray1<f32>>, f64, bool, bool, Bound<'py, PyDict>);

/// Name, unit, low, high and meaning of a row of an observation.
pub type ObservedRow = (String, &'static str, f64, f64, String);

/// A row as Python gets it.
pub fn observed_row(row: &Observed) -> ObservedRow {
    (row.name.clone(), row.unit, row.low, row.high, row.description.clone())
}

/// Vehicle, row, its upper bound, and what the vehicle can reach.
pub type NarrowRow = (String, String, f64, f64);

/// Rows whose bounds a vehicle can leave.
pub fn narrow_rows(setup: &Setup) -> Vec<NarrowRow> {
    let rows = setup.narrow.iter();
    rows.map(|row| (row.vehicle.clone(), row.row.clone(), row.high, row.limit)).collect()
}

/// One environment.
#[pyclass(module = "hp_gym._core")]
pub struct Episode {
    settings: String,
    scenario: Option<String>,
    distribution: Option<String>,
    inner: Guarded<episode::Episode>,
    observation: Vec<f32>,
    names: SignalNames,
    closed: bool,
}

impl Episode {
    fn observed<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let observation = &mut self.observation;
        self.inner.alter(|episode| episode.observe(observation)).map_err(to_python)?;
        Ok(PyArray1::from_slice(py, &self.observation))
    }

    fn info<'py>(&self, py: Python<'py>, outcome: Option<&Outcome>) -> PyResult<Bound<'py, PyDict>> {
        let (parts, terms) = outcome.map_or_else(Default::default, |outcome| (outcome.parts, outcome.terms));
        step_info(py, &self.inner.setup().told, (&parts, &terms), || mask_of(&self.inner))
    }

    fn require_open(&self, py: Python<'_>) -> PyResult<()> {
        errors::require_open(py, self.closed)
    }

    fn require_begun(&self, py: Python<'_>) -> PyResult<()> {
        self.require_open(py)?;
        self.inner.require_sound().map_err(to_python)?;
        errors::require_begun(py, self.inner.begun())
    }
}

#[pymethods]
impl Episode {
    #[new]
    #[pyo3(signature = (settings, scenario=None, distribution=None))]
    fn new(settings: String, scenario: Option<String>, distribution: Option<String>) -> PyResult<Self> {
        let origin =
            Origin { scenario: scenario.clone(), distribution: distribution.clone(), ..Origin::default() };
        let (setup, mut sources) = setup(&settings, &[origin])?;
        let source = sources.remove(0);
        let observation = vec![0.0; setup.observations.rows().len()];
        let inner = Guarded::new(episode::Episode::new(setup, source));
        Ok(Self {
            settings,
            scenario,
            distribution,
            inner,
            observation,
            names: SignalNames::default(),
            closed: false,
        })
    }

    /// Number of options of each action; empty in continuous mode.
    fn option_counts(&self) -> Vec<usize> {
        if self.inner.setup().continuous {
            Vec::new()
        } else {
            self.inner.setup().actions.option_counts().to_vec()
        }
    }

    /// Name, unit, options (empty for levels) and description of each action.
    fn action_rows(&self) -> Vec<ActuatorTuple> {
        self.inner.setup().actions.rows().iter().map(action_tuple).collect()
    }

    fn observation_rows(&self) -> Vec<ObservedRow> {
        self.inner.setup().observations.rows().iter().map(observed_row).collect()
    }

    /// Rows whose bounds the vehicle can leave: vehicle, row, upper bound, limit of the vehicle.
    fn narrow_rows(&self) -> Vec<NarrowRow> {
        narrow_rows(self.inner.setup())
    }

    #[pyo3(signature = (scenario=None, distribution=None, seed=None))]
    fn reset<'py>(
        &mut self,
        py: Python<'py>,
        scenario: Option<String>,
        distribution: Option<String>,
        seed: Option<u64>,
    ) -> PyResult<(Bound<'py, PyArray1<f32>>, Bound<'py, PyDict>)> {
        self.require_open(py)?;
        let once = once(self.inner.setup(), Origin { scenario, distribution, ..Origin::default() })?;
        self.inner.begin(|episode| episode.restart(seed, once.as_ref())).map_err(to_python)?;
        let observation = self.observed(py)?;
        Ok((observation, self.info(py, None)?))
    }

    fn step<'py>(&mut self, py: Python<'py>, action: &Bound<'py, PyAny>) -> PyResult<Step<'py>> {
        self.require_begun(py)?;
        if let Some(end) = self.inner.end() {
            let message = format!("this trip has ended ({}); call reset()", end.name());
            return Err(gymnasium_error(py, "ResetNeeded", &message));
        }
        let setup = self.inner.setup();
        let outcome = match actions::read(action, setup, None)? {
            Checked::Values(array) => {
                let values = array.as_slice()?;
                self.inner.alter(|episode| episode.step(values))
            }
            Checked::Levels(array) => {
                let levels = array.as_slice()?;
                let (mut few, mut many) = ([0.0; ACTUATOR_PLACES], Vec::new());
                // Cars that share an environment can have more rows together than one has.
                let values = few.get_mut(..levels.len()).unwrap_or_else(|| {
                    many.resize(levels.len(), 0.0);
                    &mut many
                });
                for (column, (value, &level)) in values.iter_mut().zip(levels).enumerate() {
                    *value = setup.actions.value(column, level as usize);
                }
                self.inner.alter(|episode| episode.step(values))
            }
        };
        let outcome = outcome.map_err(to_python)?;
        let Some(outcome) = outcome else {
            return Err(gymnasium_error(py, "ResetNeeded", "call reset() first"));
        };
        let observation = self.observed(py)?;
        Ok((observation, outcome.reward, outcome.end.is_some(), false, self.info(py, Some(&outcome))?))
    }

    fn action_masks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        self.require_begun(py)?;
        let mask = done(|| mask_of(&self.inner)).map_err(to_python)?;
        Ok(mask.into_pyarray(py))
    }

    fn rule_based_action<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.require_begun(py)?;
        let width = self.inner.setup().actions.rows().len();
        if self.inner.setup().continuous {
            let mut values = vec![0.0; width];
            self.inner.alter(|episode| episode.rule_based_values(&mut values)).map_err(to_python)?;
            Ok(values.into_pyarray(py).into_any())
        } else {
            let mut levels = vec![0; width];
            self.inner.alter(|episode| episode.rule_based_levels(&mut levels)).map_err(to_python)?;
            Ok(levels.into_pyarray(py).into_any())
        }
    }

    /// Present values of all signals.
    fn look<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.require_begun(py)?;
        Ok(looked(&self.inner).into_pyarray(py))
    }

    /// Names of all signals of the vehicle of the trip.
    fn signal_names<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        self.require_begun(py)?;
        self.names.of(py, &self.inner)
    }

    /// What the vehicle of the trip is made of.
    fn layout<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.require_begun(py)?;
        layout_dict(py, self.inner.trip().map(|(_, experiment)| &experiment.plant.vehicle))
    }

    /// The command that was driven last, all actuators.
    fn asked<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        self.require_begun(py)?;
        Ok(self.inner.asked().map_or_else(Vec::new, <[f32]>::to_vec).into_pyarray(py))
    }

    /// Speed at every full second of the trip.
    fn speeds_m_s<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.require_begun(py)?;
        Ok(speeds_m_s(&self.inner).into_pyarray(py))
    }

    /// KPIs of the trip so far.
    fn kpis<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.require_begun(py)?;
        kpis(py, &self.inner.terms().copied().unwrap_or_default(), &self.inner.setup().reward)
    }

    /// Totals of the trip so far, as `simulate` gives them.
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.require_begun(py)?;
        by_name(py, self.inner.totals())
    }

    /// What the trip is.
    fn trip<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.require_begun(py)?;
        facts_dict(py, self.inner.facts().as_ref())
    }

    /// Why the trip is over; none while it is not.
    fn end_reason(&self, py: Python<'_>) -> PyResult<Option<&'static str>> {
        self.require_begun(py)?;
        Ok(self.inner.end().map(|end| end.name()))
    }

    /// Share of the observations of the trip in which each row was clipped, by name.
    fn clipped_shares<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.require_begun(py)?;
        clipped_shares(py, &self.inner)
    }

    fn get_state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        self.inner.require_sound().map_err(to_python)?;
        Ok(PyBytes::new(py, &self.inner.to_bytes(Clock::default()).map_err(to_python)?))
    }

    fn set_state(&mut self, py: Python<'_>, state: &[u8]) -> PyResult<()> {
        self.require_open(py)?;
        self.inner.begin(|episode| episode.restore(state)).map_err(to_python)
    }

    fn close(&mut self) {
        self.closed = true;
    }

    #[getter]
    fn closed(&self) -> bool {
        self.closed
    }

    #[allow(clippy::type_complexity)]
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (String, Option<String>, Option<String>), (Bound<'py, PyBytes>, bool))>
    {
        let py = slf.py();
        let this = slf.borrow();
        let arguments = (this.settings.clone(), this.scenario.clone(), this.distribution.clone());
        Ok((slf.get_type().into_any(), arguments, (this.get_state(py)?, this.closed)))
    }

    fn __setstate__(&mut self, state: (Vec<u8>, bool)) -> PyResult<()> {
        self.inner.begin(|episode| episode.restore(&state.0)).map_err(to_python)?;
        self.closed = state.1;
        Ok(())
    }
}

/// Rows of the default architecture.
fn default_rows() -> PyResult<RowSet> {
    let layout = architecture(DEFAULT_ARCHITECTURE).map_err(to_python)?;
    RowSet::of([&layout]).map_err(to_python)
}

/// Groups of actuators, and the names of those of the default architecture.
#[pyfunction]
pub fn action_groups() -> PyResult<Vec<(&'static str, Vec<String>)>> {
    let set = default_rows()?;
    let group = |name: &'static str| {
        let actions = ActionTable::new(&[name.to_owned()], &set, &BTreeMap::new()).map_err(to_python)?;
        Ok((name, actions.rows().iter().map(|row| row.name.clone()).collect()))
    };
    GROUPS.into_iter().map(group).collect()
}

/// Default settings of an environment as JSON.
#[pyfunction]
pub fn default_settings() -> PyResult<String> {
    serde_json::to_string(&Settings::default()).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// Every row that can be observed with the default actions, and whether it is by default.
#[pyfunction]
pub fn observation_table() -> PyResult<Vec<(ObservedRow, bool)>> {
    let set = default_rows()?;
    let names = [GROUPS[0].to_owned()];
    let actions = ActionTable::new(&names, &set, &BTreeMap::new()).map_err(to_python)?;
    let rows = hp_episode::observation::all(&set, &actions).into_iter();
    Ok(rows.map(|row| (observed_row(&row), row.default)).collect())
}

/// Names of the parts of a reward.
#[pyfunction]
pub fn reward_parts() -> Vec<&'static str> {
    PART_NAMES.to_vec()
}

/// Names of the terms that rewards are counted from.
#[pyfunction]
pub fn reward_terms() -> Vec<&'static str> {
    TERM_NAMES.to_vec()
}
