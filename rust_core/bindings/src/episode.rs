//! One environment.

use crate::actions::{self, Checked};
use crate::errors::{ConfigurationError, gymnasium_error, to_python};
use hp_episode::action;
use hp_episode::episode;
use hp_episode::reward::{PART_NAMES, Parts, RewardParameters, Terms};
use hp_episode::setup::{Settings, Setup, Source};
use hp_plant::command::{ACTUATOR_COUNT, ACTUATORS, Command};
use hp_plant::signals::{self, View};
use numpy::{IntoPyArray, PyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::sync::Arc;

/// Settings from JSON, made ready.
pub fn setup(settings: &str) -> PyResult<Arc<Setup>> {
    let read = &mut serde_json::Deserializer::from_str(settings);
    let settings: Settings = serde_path_to_error::deserialize(read).map_err(|error| {
        let key = error.path().to_string();
        ConfigurationError::new_err(format!("setting `{key}`: {}", error.into_inner()))
    })?;
    Ok(Arc::new(Setup::new(&settings).map_err(to_python)?))
}

/// Where trips come from: a scenario, or else a distribution.
pub fn source(setup: &Setup, scenario: Option<&str>, distribution: Option<&str>) -> PyResult<Option<Source>> {
    let source = match (scenario, distribution) {
        (Some(name), _) => Some(setup.scenario(name)),
        (None, Some(name)) => Some(setup.distribution(name)),
        (None, None) => None,
    };
    source.transpose().map_err(to_python)
}

/// Present values of all signals.
pub fn looked(episode: &episode::Episode) -> Vec<f64> {
    let (Some((_, experiment)), Some(run)) = (episode.trip(), episode.run()) else { return Vec::new() };
    let disturbance = experiment.disturbance(run.steps.saturating_sub(1));
    let view = View {
        plant: &experiment.plant,
        state: &run.state,
        record: run.record.as_ref(),
        disturbance: &disturbance,
    };
    signals::all().map(|signal| signal.read(&view)).collect()
}

/// Speed at every full second of a trip.
pub fn speeds_m_s(episode: &episode::Episode) -> Vec<f64> {
    episode.trip().map_or_else(Vec::new, |(_, experiment)| experiment.cycle.speeds_m_s().to_vec())
}

/// What is told of a trip when it begins.
pub fn trip_info<'py>(py: Python<'py>, episode: &episode::Episode) -> PyResult<Bound<'py, PyDict>> {
    let info = PyDict::new(py);
    if let Some((origin, experiment)) = episode.trip() {
        info.set_item(intern!(py, "scenario"), origin)?;
        info.set_item(intern!(py, "cycle"), experiment.cycle.name())?;
        info.set_item(intern!(py, "trip_s"), experiment.cycle.duration_s())?;
        let ambient_degc = experiment.climate.ambient_temperature_degc.0;
        info.set_item(intern!(py, "ambient_temperature_degc"), ambient_degc)?;
    }
    Ok(info)
}

/// Parts of a reward by name.
pub fn parts_info<'py>(py: Python<'py>, parts: &Parts) -> PyResult<Bound<'py, PyDict>> {
    let info = PyDict::new(py);
    info.set_item(intern!(py, "reward_energy"), parts[0])?;
    info.set_item(intern!(py, "reward_discomfort"), parts[1])?;
    info.set_item(intern!(py, "reward_heat_left"), parts[2])?;
    info.set_item(intern!(py, "reward_penalties"), parts[3])?;
    Ok(info)
}

/// KPIs of a trip by name.
pub fn kpis<'py>(py: Python<'py>, terms: &Terms, weights: &RewardParameters) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in terms.kpis(weights) {
        dict.set_item(name, value)?;
    }
    Ok(dict)
}

/// Totals of a trip by name.
pub fn summary<'py>(py: Python<'py>, episode: &episode::Episode) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    if let Some(run) = episode.run() {
        for (name, value) in run.summary.values() {
            dict.set_item(name, value)?;
        }
    }
    Ok(dict)
}

/// A command as an action of an environment: nearest options, or values.
fn as_action<'py>(py: Python<'py>, setup: &Setup, command: &Command) -> Bound<'py, PyAny> {
    let rows = setup.actions.rows();
    if setup.continuous {
        let values: Vec<f32> = rows.iter().map(|&row| command.0[row]).collect();
        values.into_pyarray(py).into_any()
    } else {
        let options: Vec<i64> =
            rows.iter().map(|&row| action::nearest_option(row, command.0[row]) as i64).collect();
        options.into_pyarray(py).into_any()
    }
}

/// What a step gives: observation, reward, terminated, truncated, info.
type Step<'py> = (Bound<'py, PyArray1<f32>>, f64, bool, bool, Bound<'py, PyDict>);

/// Name, unit, low, high and meaning of a row of an observation.
type ObservedRow = (String, &'static str, f64, f64, String);

/// One environment.
#[pyclass(module = "hp_gym._core")]
pub struct Episode {
    settings: String,
    scenario: Option<String>,
    distribution: Option<String>,
    inner: episode::Episode,
    observation: Vec<f32>,
    closed: bool,
}

impl Episode {
    fn observed<'py>(&mut self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        self.inner.observe(&mut self.observation);
        PyArray1::from_slice(py, &self.observation)
    }

    fn require_open(&self, py: Python<'_>) -> PyResult<()> {
        if self.closed {
            return Err(gymnasium_error(
                py,
                "ClosedEnvironmentError",
                "this environment was closed; make another one",
            ));
        }
        Ok(())
    }

    fn require_begun(&self, py: Python<'_>) -> PyResult<()> {
        self.require_open(py)?;
        if !self.inner.begun() {
            return Err(gymnasium_error(py, "ResetNeeded", "call reset() first"));
        }
        Ok(())
    }
}

#[pymethods]
impl Episode {
    #[new]
    #[pyo3(signature = (settings, scenario=None, distribution=None))]
    fn new(settings: String, scenario: Option<String>, distribution: Option<String>) -> PyResult<Self> {
        let setup = setup(&settings)?;
        let source = source(&setup, scenario.as_deref(), distribution.as_deref())?.ok_or_else(|| {
            PyValueError::new_err("scenario and distribution are None, but one must be given")
        })?;
        let observation = vec![0.0; setup.observations.rows().len()];
        let inner = episode::Episode::new(setup, source);
        Ok(Self { settings, scenario, distribution, inner, observation, closed: false })
    }

    /// Number of options of each action; empty in continuous mode.
    fn option_counts(&self) -> Vec<usize> {
        if self.inner.setup().continuous {
            Vec::new()
        } else {
            self.inner.setup().actions.option_counts().to_vec()
        }
    }

    fn observation_rows(&self) -> Vec<ObservedRow> {
        let rows = self.inner.setup().observations.rows().iter();
        rows.map(|row| (row.name.clone(), row.unit, row.low, row.high, row.description.clone())).collect()
    }

    fn seed(&mut self, seed: u64) {
        self.inner.seed(seed);
    }

    #[pyo3(signature = (scenario=None, distribution=None))]
    fn reset<'py>(
        &mut self,
        py: Python<'py>,
        scenario: Option<&str>,
        distribution: Option<&str>,
    ) -> PyResult<(Bound<'py, PyArray1<f32>>, Bound<'py, PyDict>)> {
        self.require_open(py)?;
        let once = source(self.inner.setup(), scenario, distribution)?;
        self.inner.reset(once.as_ref()).map_err(to_python)?;
        Ok((self.observed(py), trip_info(py, &self.inner)?))
    }

    fn step<'py>(&mut self, py: Python<'py>, action: &Bound<'py, PyAny>) -> PyResult<Step<'py>> {
        self.require_begun(py)?;
        if let Some(end) = self.inner.end() {
            let message = format!("this trip has ended ({}); call reset()", end.name());
            return Err(gymnasium_error(py, "ResetNeeded", &message));
        }
        let mut values = [0.0; ACTUATOR_COUNT];
        let setup = self.inner.setup();
        let rows = setup.actions.rows();
        match actions::read(action, setup, None)? {
            Checked::Values(array) => values[..rows.len()].copy_from_slice(array.as_slice()?),
            Checked::Levels(array) => {
                for (column, &level) in array.as_slice()?.iter().enumerate() {
                    values[column] = setup.actions.value(column, level as usize);
                }
            }
        }
        let width = rows.len();
        let Some(outcome) = self.inner.step(&values[..width]) else {
            return Err(gymnasium_error(py, "ResetNeeded", "call reset() first"));
        };
        let info = parts_info(py, &outcome.parts)?;
        if let Some(end) = outcome.end {
            info.set_item(intern!(py, "end_reason"), end.name())?;
            info.set_item(intern!(py, "kpis"), self.kpis(py)?)?;
        }
        Ok((self.observed(py), outcome.reward, outcome.end.is_some(), false, info))
    }

    fn action_masks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        self.require_begun(py)?;
        let mut mask = vec![true; self.inner.setup().actions.mask_length()];
        self.inner.write_mask(&mut mask);
        Ok(mask.into_pyarray(py))
    }

    fn rule_based_action<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.require_begun(py)?;
        let command = self.inner.rule_based_command();
        let command = command.ok_or_else(|| gymnasium_error(py, "ResetNeeded", "call reset() first"))?;
        Ok(as_action(py, self.inner.setup(), &command))
    }

    /// Present values of all signals.
    fn look<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.require_begun(py)?;
        Ok(looked(&self.inner).into_pyarray(py))
    }

    /// The command that was driven last, all actuators.
    fn asked<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        self.require_begun(py)?;
        Ok(self.inner.asked().map_or_else(Vec::new, |asked| asked.to_vec()).into_pyarray(py))
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
        summary(py, &self.inner)
    }

    fn get_state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.inner.to_bytes().map_err(to_python)?))
    }

    fn set_state(&mut self, py: Python<'_>, state: &[u8]) -> PyResult<()> {
        self.require_open(py)?;
        self.inner.restore(state).map_err(to_python)
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
        self.inner.restore(&state.0).map_err(to_python)?;
        self.closed = state.1;
        Ok(())
    }
}

/// Every row that can be observed with the default actions, and whether it is by default.
#[pyfunction]
pub fn observation_table() -> PyResult<Vec<(ObservedRow, bool)>> {
    let names: Vec<String> =
        ACTUATORS[..action::DEFAULT_ROWS].iter().map(|actuator| actuator.name.to_owned()).collect();
    let actions = action::ActionTable::new(&names).map_err(to_python)?;
    let rows = hp_episode::observation::all(&actions).into_iter();
    Ok(rows.map(|row| ((row.name, row.unit, row.low, row.high, row.description), row.default)).collect())
}

/// Names of the parts of a reward.
#[pyfunction]
pub fn reward_parts() -> Vec<&'static str> {
    PART_NAMES.to_vec()
}
