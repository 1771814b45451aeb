//! Scenarios and runs.

use crate::errors::{signals, to_python};
use crate::vehicles::{ActuatorTuple, SignalTuple, actuator_tuple, layout_dict, signal_tuple};
use hp_episode::guard::{Guarded, caught, done};
use hp_episode::timing;
use hp_plant::architecture::layout::Layout;
use hp_plant::command::Command;
use hp_plant::config::library::Override;
use hp_trip::{experiment, run, summary};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::collections::BTreeMap;

/// Totals of a run and why it ended.
type Totals<'py> = (Bound<'py, PyDict>, &'static str);

/// Rows of signals, totals and why the run ended.
type Trajectory<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyDict>, &'static str);

fn parse_overrides(overrides: &[String]) -> PyResult<Vec<Override>> {
    overrides.iter().map(|text| Override::parse(text).map_err(to_python)).collect()
}

/// Totals by name; NaN where a quantity does not exist.
pub fn to_dict<'py>(
    py: Python<'py>,
    summary: &summary::Summary,
    layout: &Layout,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (name, value) in summary.values(layout) {
        // Sums and quotients of such values are none either, which Python's `None` could not say.
        dict.set_item(name, value.unwrap_or(f64::NAN))?;
    }
    Ok(dict)
}

/// A scenario with vehicle, drive cycle and rule-based controller, ready to run.
#[pyclass(frozen, module = "hp_gym._core")]
pub struct Experiment {
    inner: experiment::Experiment,
    signal_names: Py<PyTuple>,
    actuator_names: Py<PyTuple>,
}

#[pymethods]
impl Experiment {
    #[new]
    #[pyo3(signature = (scenario, controller=None, overrides=Vec::new(), substeps=1, vehicle=None))]
    fn new(
        py: Python<'_>,
        scenario: &str,
        controller: Option<&str>,
        overrides: Vec<String>,
        substeps: u32,
        vehicle: Option<&str>,
    ) -> PyResult<Self> {
        let overrides = parse_overrides(&overrides)?;
        let loaded =
            caught(|| experiment::Experiment::with_vehicle(scenario, vehicle, controller, &overrides));
        let mut inner = loaded.map_err(to_python)?;
        if !(1..=1000).contains(&substeps) {
            return Err(PyValueError::new_err(format!(
                "substeps is {substeps}, but must be between 1 and 1000"
            )));
        }
        inner = inner.with_substeps(substeps);
        let signals = inner.plant.signals.rows().iter();
        let signal_names = PyTuple::new(py, signals.map(|signal| &signal.name))?.unbind();
        let actuators = inner.plant.ranges.rows().iter();
        let actuator_names = PyTuple::new(py, actuators.map(|row| &row.name))?.unbind();
        Ok(Self { inner, signal_names, actuator_names })
    }

    #[getter]
    fn description(&self) -> &str {
        &self.inner.scenario.description
    }

    #[getter]
    fn vehicle(&self) -> &str {
        &self.inner.scenario.vehicle
    }

    #[getter]
    fn cycle(&self) -> &str {
        &self.inner.scenario.cycle
    }

    #[getter]
    fn controller(&self) -> &str {
        &self.inner.controller
    }

    #[getter]
    fn ambient_temperature_degc(&self) -> f64 {
        self.inner.climate.ambient_temperature_degc.0
    }

    #[getter]
    fn duration_s(&self) -> usize {
        self.inner.cycle.duration_s()
    }

    #[getter]
    fn distance_m(&self) -> f64 {
        self.inner.cycle.distance_m()
    }

    /// Name or path of the vehicle's architecture.
    #[getter]
    fn architecture(&self) -> &str {
        &self.inner.plant.vehicle.architecture
    }

    /// Name, unit, options (empty for levels) and description of every actuator.
    fn actuators(&self) -> Vec<ActuatorTuple> {
        self.inner.plant.ranges.rows().iter().map(actuator_tuple).collect()
    }

    /// Name, unit and description of every signal.
    fn signals(&self) -> Vec<SignalTuple> {
        self.inner.plant.signals.rows().iter().map(signal_tuple).collect()
    }

    /// Names of all signals.
    #[getter]
    fn signal_names(&self, py: Python<'_>) -> Py<PyTuple> {
        self.signal_names.clone_ref(py)
    }

    /// Names of all actuators, in the order of a command.
    #[getter]
    fn actuator_names(&self, py: Python<'_>) -> Py<PyTuple> {
        self.actuator_names.clone_ref(py)
    }

    /// What the vehicle is made of.
    fn layout<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        layout_dict(py, Some(&self.inner.plant.vehicle))
    }

    /// Lowest and highest physical value of every actuator.
    fn actuator_ranges(&self) -> Vec<(f64, f64)> {
        (0..self.inner.plant.ranges.count()).map(|row| self.inner.plant.ranges.range(row)).collect()
    }

    /// Limits that a run is judged by.
    fn limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let limits = PyDict::new(py);
        for (name, value) in summary::limits(&self.inner.plant.vehicle) {
            limits.set_item(name, value)?;
        }
        Ok(limits)
    }

    /// Command of named actuators in physical units; the others have their defaults.
    fn encode<'py>(
        &self,
        py: Python<'py>,
        settings: BTreeMap<String, Setting>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let ranges = &self.inner.plant.ranges;
        let mut command = ranges.encode(&ranges.idle());
        for (name, setting) in settings {
            match setting {
                Setting::Option(option) => ranges.choose(&mut command, &name, &option),
                Setting::Value(value) => ranges.set(&mut command, &name, value),
            }
            .map_err(to_python)?;
        }
        Ok(command.0[..ranges.count()].to_vec().into_pyarray(py))
    }

    /// Drives to the end with the rule-based controller; `check` is called every now and then, and what it raises ends it.
    #[pyo3(signature = (check=None))]
    fn simulate<'py>(&self, py: Python<'py>, check: Option<Py<PyAny>>) -> PyResult<Trajectory<'py>> {
        let go_on = || {
            signals()?;
            check.as_ref().map_or(Ok(()), |check| Python::attach(|py| check.call0(py).map(drop)))
        };
        let driven = py.detach(|| done(|| self.inner.simulate_while(go_on)));
        let trajectory = driven.map_err(to_python)??;
        let rows = trajectory.values.len() / trajectory.columns;
        let values = trajectory.values.into_pyarray(py).reshape([rows, trajectory.columns])?;
        Ok((values, to_dict(py, &trajectory.summary, self.inner.plant.layout())?, trajectory.end.name()))
    }

    fn totals<'py>(&self, py: Python<'py>) -> PyResult<Totals<'py>> {
        let driven = py.detach(|| done(|| self.inner.totals_while(signals)));
        let (summary, end) = driven.map_err(to_python)??;
        Ok((to_dict(py, &summary, self.inner.plant.layout())?, end.name()))
    }

    fn start(slf: Py<Self>, py: Python<'_>) -> PyResult<Run> {
        let run = done(|| slf.borrow(py).inner.start()).map_err(to_python)?;
        Ok(Run { experiment: slf, inner: Guarded::new(run), ended: None })
    }
}

/// Physical value or option of an actuator.
#[derive(FromPyObject)]
enum Setting {
    Option(String),
    Value(f64),
}

/// A run in progress.
#[pyclass(module = "hp_gym._core")]
pub struct Run {
    experiment: Py<Experiment>,
    inner: Guarded<run::Run>,
    ended: Option<&'static str>,
}

#[pymethods]
impl Run {
    #[getter]
    fn experiment(&self, py: Python<'_>) -> Py<Experiment> {
        self.experiment.clone_ref(py)
    }

    fn rule_based_command<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let experiment = &self.experiment.borrow(py).inner;
        let command = self.inner.alter(|run| experiment.rule_based_command(run)).map_err(to_python)?;
        Ok(command.0[..experiment.plant.ranges.count()].to_vec().into_pyarray(py))
    }

    fn step(&mut self, py: Python<'_>, command: PyReadonlyArray1<'_, f32>) -> PyResult<Option<&'static str>> {
        if let Some(reason) = self.ended {
            return Err(PyRuntimeError::new_err(format!("this run has ended ({reason}); start another one")));
        }
        let experiment = self.experiment.borrow(py);
        let rows = experiment.inner.plant.ranges.rows();
        let values = command.as_slice()?;
        if values.len() != rows.len() {
            let message = format!("command has {} values, but must have {}", values.len(), rows.len());
            return Err(PyValueError::new_err(message));
        }
        if let Some(row) = values.iter().position(|value| !(-1.0..=1.0).contains(value)) {
            return Err(PyValueError::new_err(format!(
                "command[{row}] ({}) is {}, but must be between -1 and 1",
                rows[row].name, values[row]
            )));
        }
        let mut command = Command::default();
        command.0[..values.len()].copy_from_slice(values);
        let stepped = self.inner.alter(|run| experiment.inner.step(run, &command));
        self.ended = stepped.map_err(to_python)?.map(run::EndReason::name);
        Ok(self.ended)
    }

    fn look<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.inner.require_sound().map_err(to_python)?;
        let mut row = Vec::new();
        self.experiment.borrow(py).inner.look(&self.inner, &mut row);
        Ok(row.into_pyarray(py))
    }

    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.inner.require_sound().map_err(to_python)?;
        to_dict(py, &self.inner.summary, self.experiment.borrow(py).inner.plant.layout())
    }
}

/// Totals of several scenarios with the same overrides, run side by side.
#[pyfunction]
#[pyo3(signature = (scenarios, overrides=Vec::new(), vehicle=None))]
pub fn totals<'py>(
    py: Python<'py>,
    scenarios: Vec<String>,
    overrides: Vec<String>,
    vehicle: Option<String>,
) -> PyResult<Vec<Totals<'py>>> {
    let overrides = parse_overrides(&overrides)?;
    let driven = py
        .detach(|| done(|| hp_episode::totals::totals(&scenarios, vehicle.as_deref(), &overrides, signals)));
    let results = driven.map_err(to_python)??;
    results
        .into_iter()
        .map(|result| {
            let (summary, end, plant) = result.map_err(to_python)?;
            Ok((to_dict(py, &summary, plant.layout())?, end.name()))
        })
        .collect()
}

/// Seconds that all steps with the compressor on took on a trip, and their number; random actions with a seed.
#[pyfunction]
#[pyo3(signature = (scenario, seed=None, vehicle=None))]
pub fn plant_step_seconds(
    py: Python<'_>,
    scenario: &str,
    seed: Option<u64>,
    vehicle: Option<&str>,
) -> PyResult<(f64, usize)> {
    let timed = py.detach(|| {
        caught(|| {
            let experiment = experiment::Experiment::with_vehicle(scenario, vehicle, None, &[])?;
            timing::compressor_on_steps(&experiment, seed)
        })
    });
    let (spent, steps) = timed.map_err(to_python)?;
    Ok((spent.as_secs_f64(), steps))
}
