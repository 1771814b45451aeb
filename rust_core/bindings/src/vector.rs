//! Many environments that step together, the interpreter's lock released.

use crate::actions::{self, Checked};
use crate::episode::{
    NarrowRow, ObservedRow, by_name, clipped_shares, facts_dict, kpis, looked, mask_of, narrow_rows,
    observed_row, once, setup, speeds_m_s, step_info,
};
use crate::errors::{self, ConfigurationError, gymnasium_error, to_python};
use crate::vehicles::{ActuatorTuple, SignalNames, action_tuple, layout_dict};
use hp_episode::episode::Episode;
use hp_episode::guard::{Guarded, done};
use hp_episode::setup::{Origin, Setup, Source, Told};
use hp_episode::vector::{self, Actions, ActionsMut, Autoreset, Extras, PARTS, Results, TERMS};
use hp_plant::error::PlantResult;
use numpy::ndarray::Dimension;
use numpy::{Element, IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadwriteArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use std::collections::HashMap;
use std::sync::Arc;

/// A name for each environment; none stands for its own.
type Names = Vec<Option<String>>;

/// A trip that is over.
#[pyclass(frozen, get_all, module = "hp_gym._core")]
pub struct FinishedTrip {
    /// Environment that drove it.
    index: usize,
    /// Why it ended; none where the limit of steps cut it off.
    end_reason: Option<&'static str>,
    /// What it was.
    trip: Py<PyDict>,
    /// Its KPIs.
    kpis: Py<PyDict>,
    /// Its totals, as `simulate` gives them.
    summary: Py<PyDict>,
    /// Info of its last step.
    info: Py<PyDict>,
    /// Its last observation, where the environment was reset within the step.
    last_observation: Option<Py<PyArray1<f32>>>,
}

/// What a step gives, a column each with one entry an environment; then what happened to some of them.
#[pyclass(frozen, get_all, module = "hp_gym._core")]
pub struct Outcomes {
    observations: Py<PyArray2<f32>>,
    rewards: Py<PyArray1<f64>>,
    terminated: Py<PyArray1<bool>>,
    truncated: Py<PyArray1<bool>>,
    parts: Py<PyArray2<f64>>,
    costs: Option<Py<PyArray1<f64>>>,
    terms: Option<Py<PyArray2<f64>>>,
    masks: Option<Py<PyArray2<bool>>>,
    finished: Vec<Py<FinishedTrip>>,
    reset: Vec<usize>,
}

/// Many environments.
#[pyclass(module = "hp_gym._core")]
pub struct Vector {
    arguments: Arguments,
    setup: Arc<Setup>,
    autoreset: Autoreset,
    inner: Guarded<vector::Vector>,
    names: SignalNames,
    closed: bool,
}

/// Arguments that a vector was made with: settings, then scenario, distribution and vehicle of each environment, mode of
/// resets, limit of steps, threads.
type Arguments = (String, Names, Names, Names, String, Option<u64>, usize);

fn origins(scenarios: &Names, distributions: &Names, vehicles: &Names) -> Vec<Origin> {
    let names = scenarios.iter().zip(distributions).zip(vehicles);
    let origin =
        |((scenario, distribution), vehicle): ((&Option<String>, &Option<String>), &Option<String>)| Origin {
            scenario: scenario.clone(),
            distribution: distribution.clone(),
            vehicle: vehicle.clone(),
        };
    names.map(origin).collect()
}

/// Checks that there is an entry for each environment, and no thread that would have none to work on.
fn check_counts(scenarios: &Names, distributions: &Names, vehicles: &Names, threads: usize) -> PyResult<()> {
    let count = scenarios.len();
    if count == 0 || distributions.len() != count || vehicles.len() != count {
        let message = format!(
            "scenarios, distributions and vehicles are {count}, {} and {}, but must be one each for every environment",
            distributions.len(),
            vehicles.len()
        );
        return Err(ConfigurationError::new_err(message));
    }
    if !(1..=count).contains(&threads) {
        let message = format!("threads is {threads}, but must be between 1 and the {count} environments");
        return Err(ConfigurationError::new_err(message));
    }
    Ok(())
}

impl Vector {
    fn require_open(&self, py: Python<'_>) -> PyResult<()> {
        errors::require_open(py, self.closed)
    }

    fn require_ready(&self, py: Python<'_>) -> PyResult<()> {
        self.require_open(py)?;
        self.inner.require_sound().map_err(to_python)?;
        errors::require_begun(py, self.inner.all_begun())
    }

    /// Whether no trip is over that must be reset by hand.
    fn require_reset(&self, py: Python<'_>) -> PyResult<()> {
        if self.autoreset == Autoreset::Disabled && self.inner.over().contains(&true) {
            let over = self.inner.over().iter().enumerate().filter(|(_, over)| **over);
            let over: Vec<String> = over.map(|(index, _)| index.to_string()).collect();
            let message = format!(
                "the trips of environments {} have ended; call reset(options={{\"reset_mask\": ...}})",
                over.join(", ")
            );
            return Err(gymnasium_error(py, "ResetNeeded", &message));
        }
        Ok(())
    }

    fn check_index(&self, index: usize) -> PyResult<()> {
        let count = self.inner.episodes().len();
        if index >= count {
            return Err(PyValueError::new_err(format!("index is {index}, but must be below {count}")));
        }
        Ok(())
    }

    /// Begins environments anew; only all of them together are sound after a panic.
    fn begin(
        &mut self,
        indices: &[usize],
        work: impl FnOnce(&mut vector::Vector) -> PlantResult<()>,
    ) -> PyResult<()> {
        let mut named = vec![false; self.inner.episodes().len()];
        indices.iter().for_each(|&index| named[index] = true);
        let begun = if named.into_iter().all(|named| named) {
            self.inner.begin(work)
        } else {
            self.inner.change(work)
        };
        begun.map_err(to_python)
    }

    fn width(&self) -> usize {
        self.setup.observations.rows().len()
    }
}

#[pymethods]
impl Vector {
    #[new]
    fn new(
        settings: String,
        scenarios: Names,
        distributions: Names,
        vehicles: Names,
        autoreset: String,
        step_limit: Option<u64>,
        threads: usize,
    ) -> PyResult<Self> {
        check_counts(&scenarios, &distributions, &vehicles, threads)?;
        let (setup, sources) = setup(&settings, &origins(&scenarios, &distributions, &vehicles))?;
        let mode = match autoreset.as_str() {
            "NextStep" => Autoreset::NextStep,
            "SameStep" => Autoreset::SameStep,
            "Disabled" => Autoreset::Disabled,
            other => {
                let message =
                    format!("autoreset mode is {other}, but must be NextStep, SameStep or Disabled");
                return Err(PyValueError::new_err(message));
            }
        };
        let mut episodes = Vec::new();
        if episodes.try_reserve_exact(sources.len()).is_err() {
            let message = format!("there is no memory for {} environments", sources.len());
            return Err(ConfigurationError::new_err(message));
        }
        episodes.extend(sources.into_iter().map(|source| Episode::new(Arc::clone(&setup), source)));
        let inner = Guarded::new(vector::Vector::new(episodes, mode, step_limit, threads));
        let arguments = (settings, scenarios, distributions, vehicles, autoreset, step_limit, threads);
        Ok(Self { arguments, setup, autoreset: mode, inner, names: SignalNames::default(), closed: false })
    }

    /// Resets environments, each with its seed and, just this once, its scenario or distribution.
    fn reset(
        &mut self,
        py: Python<'_>,
        indices: Vec<usize>,
        seeds: Vec<Option<u64>>,
        scenarios: Names,
        distributions: Names,
    ) -> PyResult<()> {
        self.require_open(py)?;
        indices.iter().try_for_each(|&index| self.check_index(index))?;
        let vehicles: Names = indices.iter().map(|&index| self.arguments.3[index].clone()).collect();
        let mut loaded: HashMap<Origin, Option<Source>> = HashMap::new();
        let mut sources = Vec::with_capacity(indices.len());
        for origin in origins(&scenarios, &distributions, &vehicles) {
            if !loaded.contains_key(&origin) {
                loaded.insert(origin.clone(), once(&self.setup, origin.clone())?);
            }
            sources.push(loaded[&origin].clone());
        }
        let begins = |all: &mut vector::Vector| {
            let each = indices.iter().zip(seeds).zip(&sources);
            each.into_iter().try_for_each(|((&index, seed), once)| all.reset(index, seed, once.as_ref()))
        };
        self.begin(&indices, begins)
    }

    /// Observations of environments, one row each; those that were seen before are not counted again.
    #[pyo3(signature = (indices, again=false))]
    fn observe<'py>(
        &mut self,
        py: Python<'py>,
        indices: Vec<usize>,
        again: bool,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let look = if again { Episode::observe_again } else { Episode::observe };
        let width = self.width();
        let array = PyArray2::zeros(py, [indices.len(), width], false);
        {
            let mut values = array.readwrite();
            for (row, &index) in values.as_slice_mut()?.chunks_mut(width).zip(&indices) {
                self.check_index(index)?;
                self.inner.alter(|all| look(&mut all.episodes_mut()[index], row)).map_err(to_python)?;
            }
        }
        Ok(array)
    }

    fn step<'py>(&mut self, py: Python<'py>, action: &Bound<'py, PyAny>) -> PyResult<Outcomes> {
        self.require_ready(py)?;
        self.require_reset(py)?;
        let count = self.inner.episodes().len();
        let checked = actions::read(action, &self.setup, Some(count))?;
        let observations = PyArray2::zeros(py, [count, self.width()], false);
        let rewards = PyArray1::zeros(py, count, false);
        let terminated = PyArray1::zeros(py, count, false);
        let truncated = PyArray1::zeros(py, count, false);
        let parts = PyArray2::zeros(py, [PARTS, count], false);
        let wants = |told| self.setup.told.contains(&told);
        let costs = wants(Told::Cost).then(|| PyArray1::zeros(py, count, false));
        let terms = wants(Told::Terms).then(|| PyArray2::zeros(py, [TERMS, count], false));
        let mask_length = self.setup.actions.mask_length();
        let masks = wants(Told::ActionMask).then(|| PyArray2::zeros(py, [count, mask_length], false));
        let events = {
            let (mut observations, mut rewards) = (observations.readwrite(), rewards.readwrite());
            let (mut terminated, mut truncated) = (terminated.readwrite(), truncated.readwrite());
            let mut parts = parts.readwrite();
            let mut costs = costs.as_ref().map(PyArrayMethods::readwrite);
            let mut terms = terms.as_ref().map(PyArrayMethods::readwrite);
            let mut masks = masks.as_ref().map(PyArrayMethods::readwrite);
            let mut results = Results {
                observations: observations.as_slice_mut()?,
                rewards: rewards.as_slice_mut()?,
                terminated: terminated.as_slice_mut()?,
                truncated: truncated.as_slice_mut()?,
                parts: parts.as_slice_mut()?,
                extras: Extras {
                    costs: room(costs.as_mut())?,
                    terms: room(terms.as_mut())?,
                    masks: room(masks.as_mut())?,
                },
            };
            let actions = match &checked {
                Checked::Levels(array) => Actions::Levels(array.as_slice()?),
                Checked::Values(array) => Actions::Values(array.as_slice()?),
            };
            let inner = &mut self.inner;
            py.detach(|| inner.change(|all| all.step(actions, &mut results))).map_err(to_python)?
        };
        Ok(Outcomes {
            observations: observations.unbind(),
            rewards: rewards.unbind(),
            terminated: terminated.unbind(),
            truncated: truncated.unbind(),
            parts: parts.unbind(),
            costs: costs.map(Bound::unbind),
            terms: terms.map(Bound::unbind),
            masks: masks.map(Bound::unbind),
            finished: self.finished(py, events.finished)?,
            reset: events.reset,
        })
    }

    fn action_masks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        self.require_ready(py)?;
        self.masks(py)
    }

    /// The same, all options where no trip has begun.
    fn masks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        self.require_open(py)?;
        let length = self.setup.actions.mask_length();
        let array = PyArray2::zeros(py, [self.inner.episodes().len(), length], false);
        {
            let mut values = array.readwrite();
            for (mask, episode) in values.as_slice_mut()?.chunks_mut(length).zip(self.inner.episodes()) {
                done(|| episode.write_mask(mask)).map_err(to_python)?;
            }
        }
        Ok(array)
    }

    /// What the rule-based controllers would do next, one row an environment.
    fn rule_based_actions<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.require_ready(py)?;
        let shape = [self.inner.episodes().len(), self.setup.actions.rows().len()];
        let inner = &mut self.inner;
        if self.setup.continuous {
            let array = PyArray2::zeros(py, shape, false);
            let mut values = array.readwrite();
            let values = values.as_slice_mut()?;
            let work = |all: &mut vector::Vector| all.rule_based_actions(ActionsMut::Values(values));
            py.detach(|| inner.alter(work)).map_err(to_python)?;
            Ok(array.into_any())
        } else {
            let array = PyArray2::zeros(py, shape, false);
            let mut levels = array.readwrite();
            let levels = levels.as_slice_mut()?;
            let work = |all: &mut vector::Vector| all.rule_based_actions(ActionsMut::Levels(levels));
            py.detach(|| inner.alter(work)).map_err(to_python)?;
            Ok(array.into_any())
        }
    }

    /// Present values of all signals of one environment.
    fn look<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.require_ready(py)?;
        self.check_index(index)?;
        Ok(looked(&self.inner.episodes()[index]).into_pyarray(py))
    }

    /// Names of all signals of the vehicle of one environment's trip.
    fn signal_names<'py>(&mut self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyTuple>> {
        self.require_ready(py)?;
        self.check_index(index)?;
        self.names.of(py, &self.inner.episodes()[index])
    }

    /// What the vehicle of one environment's trip is made of.
    fn layout<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyAny>> {
        self.require_ready(py)?;
        self.check_index(index)?;
        layout_dict(py, self.inner.episodes()[index].trip().map(|(_, experiment)| &experiment.plant.vehicle))
    }

    /// Name, unit, options (empty for levels) and description of each action.
    fn action_rows(&self) -> Vec<ActuatorTuple> {
        self.setup.actions.rows().iter().map(action_tuple).collect()
    }

    /// Number of options of each action; empty in continuous mode.
    fn option_counts(&self) -> Vec<usize> {
        if self.setup.continuous { Vec::new() } else { self.setup.actions.option_counts().to_vec() }
    }

    /// Name, unit, low, high and meaning of every row of an observation.
    fn observation_rows(&self) -> Vec<ObservedRow> {
        self.setup.observations.rows().iter().map(observed_row).collect()
    }

    /// Rows whose bounds a vehicle can leave: vehicle, row, upper bound, limit of the vehicle.
    fn narrow_rows(&self) -> Vec<NarrowRow> {
        narrow_rows(&self.setup)
    }

    /// Speed at every full second of the trip of one environment.
    fn speeds_m_s<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.require_ready(py)?;
        self.check_index(index)?;
        Ok(speeds_m_s(&self.inner.episodes()[index]).into_pyarray(py))
    }

    /// KPIs of the present trip of one environment.
    fn kpis<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyDict>> {
        self.require_ready(py)?;
        self.check_index(index)?;
        kpis(py, &self.inner.episodes()[index].terms().copied().unwrap_or_default(), &self.setup.reward)
    }

    /// Totals of the present trip of one environment, as `simulate` gives them.
    fn summary<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyDict>> {
        self.require_ready(py)?;
        self.check_index(index)?;
        by_name(py, self.inner.episodes()[index].totals())
    }

    /// What the present trip of one environment is.
    fn trip<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyDict>> {
        self.require_ready(py)?;
        self.check_index(index)?;
        facts_dict(py, self.inner.episodes()[index].facts().as_ref())
    }

    /// Why the present trip of one environment is over; none while it is not.
    fn end_reason(&self, py: Python<'_>, index: usize) -> PyResult<Option<&'static str>> {
        self.require_ready(py)?;
        self.check_index(index)?;
        Ok(self.inner.episodes()[index].end().map(|end| end.name()))
    }

    /// Share of the observations of one environment's trip in which each row was clipped, by name.
    fn clipped_shares<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyDict>> {
        self.require_ready(py)?;
        self.check_index(index)?;
        clipped_shares(py, &self.inner.episodes()[index])
    }

    /// Lets every environment go on from where another one is now.
    fn fork(&mut self, py: Python<'_>, indices: Vec<usize>) -> PyResult<()> {
        self.require_open(py)?;
        let count = self.inner.episodes().len();
        if indices.len() != count {
            let message = format!("indices has {} entries, but must have {count}", indices.len());
            return Err(PyValueError::new_err(message));
        }
        for &index in &indices {
            self.check_index(index)?;
        }
        self.inner.alter(|all| all.fork(&indices)).map_err(to_python)
    }

    fn get_state<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyBytes>> {
        self.check_index(index)?;
        self.inner.require_sound().map_err(to_python)?;
        Ok(PyBytes::new(py, &self.inner.to_bytes(index).map_err(to_python)?))
    }

    /// Restores environments, all or none.
    fn set_states(&mut self, py: Python<'_>, indices: Vec<usize>, states: Vec<Vec<u8>>) -> PyResult<()> {
        self.require_open(py)?;
        indices.iter().try_for_each(|&index| self.check_index(index))?;
        let states: Vec<(usize, &[u8])> =
            indices.iter().copied().zip(states.iter().map(Vec::as_slice)).collect();
        self.begin(&indices, |all| all.restore(&states))
    }

    fn close(&mut self) {
        self.closed = true;
    }

    #[allow(clippy::type_complexity)]
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Arguments, (Vec<Bound<'py, PyBytes>>, bool))> {
        let this = slf.borrow();
        let count = this.inner.episodes().len();
        let states = (0..count).map(|index| this.get_state(slf.py(), index)).collect::<PyResult<Vec<_>>>()?;
        Ok((slf.get_type().into_any(), this.arguments.clone(), (states, this.closed)))
    }

    fn __setstate__(&mut self, state: (Vec<Vec<u8>>, bool)) -> PyResult<()> {
        let states: Vec<(usize, &[u8])> = state.0.iter().map(Vec::as_slice).enumerate().collect();
        self.inner.begin(|all| all.restore(&states)).map_err(to_python)?;
        self.closed = state.1;
        Ok(())
    }
}

impl Vector {
    fn finished(&self, py: Python<'_>, trips: Vec<vector::Finished>) -> PyResult<Vec<Py<FinishedTrip>>> {
        let mut finished = Vec::with_capacity(trips.len());
        for trip in trips {
            let index = trip.index;
            let (last_observation, mask) = trip.last_seen.map_or_else(
                || (None, None),
                |seen| (Some(seen.observation.into_pyarray(py).unbind()), Some(seen.mask)),
            );
            let mask = || mask.unwrap_or_else(|| mask_of(&self.inner.episodes()[index]));
            let info = step_info(py, &self.setup.told, (&trip.parts, &trip.last_terms), mask)?;
            let trip = FinishedTrip {
                index,
                end_reason: trip.end.map(|end| end.name()),
                trip: facts_dict(py, Some(&trip.facts))?.unbind(),
                kpis: kpis(py, &trip.terms, &self.setup.reward)?.unbind(),
                summary: by_name(py, trip.totals)?.unbind(),
                info: info.unbind(),
                last_observation,
            };
            finished.push(Py::new(py, trip)?);
        }
        Ok(finished)
    }
}

/// The entries of an array that is there; none of one that is not.
fn room<'a, T: Element, D: Dimension>(
    array: Option<&'a mut PyReadwriteArray<'_, T, D>>,
) -> PyResult<&'a mut [T]> {
    match array {
        Some(array) => Ok(array.as_slice_mut()?),
        None => Ok(&mut []),
    }
}
