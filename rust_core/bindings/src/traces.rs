//! Traces: measured trips, climates and settings over time.

use crate::errors::to_python;
use hp_trip::kinds::SERIES;
use hp_trip::trace::{Trace, columns};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Columns of a trace file at full seconds, under their names in the file; `time_s` counts from 0.
#[pyfunction]
pub fn trace<'py>(py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyDict>> {
    let trace = Trace::load(SERIES, path).map_err(to_python)?;
    let found = PyDict::new(py);
    let seconds: Vec<f64> = (0..=trace.duration_s()).map(|second| second as f64).collect();
    found.set_item("time_s", seconds.into_pyarray(py))?;
    for (column, values) in trace.columns() {
        found.set_item(column.name, values.to_vec().into_pyarray(py))?;
    }
    Ok(found)
}

/// Name, lowest and highest value of every column that a trace may have.
#[pyfunction]
pub fn trace_columns() -> Vec<(&'static str, f64, f64)> {
    columns::COLUMNS.iter().map(|column| (column.name, column.low, column.high)).collect()
}
