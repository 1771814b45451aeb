//! Totals of many runs at once.

use crate::errors::{signals, to_python};
use hp_episode::guard::done;
use hp_episode::summaries::{self, PlannedRun};
use hp_plant::config::library::Override;
use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Scenario, controller, vehicle and overrides of a run.
type Planned = (String, Option<String>, Option<String>, Vec<String>);

/// Names of all totals, a row of them for each run, why each ended, and why each was refused.
type Summaries<'py> =
    (Vec<String>, Bound<'py, PyArray2<f64>>, Vec<Option<&'static str>>, Vec<Option<String>>);

fn planned((scenario, controller, vehicle, overrides): Planned, substeps: u32) -> PyResult<PlannedRun> {
    let overrides = overrides.iter().map(|text| Override::parse(text).map_err(to_python));
    Ok(PlannedRun { scenario, controller, vehicle, overrides: overrides.collect::<PyResult<_>>()?, substeps })
}

/// Place of a name among others, at the end if it is new. Runs of one layout have their names at the same places.
fn place_of(names: &mut Vec<String>, hint: usize, name: String) -> usize {
    if names.get(hint) == Some(&name) {
        return hint;
    }
    names.iter().position(|known| *known == name).unwrap_or_else(|| {
        names.push(name);
        names.len() - 1
    })
}

/// Totals of many runs, side by side; NaN where a total does not exist for a run.
#[pyfunction]
#[pyo3(name = "summaries", signature = (runs, threads, substeps=1))]
pub fn summaries_of<'py>(
    py: Python<'py>,
    runs: Vec<Planned>,
    threads: usize,
    substeps: u32,
) -> PyResult<Summaries<'py>> {
    if !(1..=1000).contains(&substeps) {
        let message = format!("substeps is {substeps}, but must be between 1 and 1000");
        return Err(PyValueError::new_err(message));
    }
    let runs = runs.into_iter().map(|run| planned(run, substeps)).collect::<PyResult<Vec<_>>>()?;
    let driven = py.detach(|| done(|| summaries::summaries(&runs, threads, signals)));
    let driven = driven.map_err(to_python)??;
    let mut names = Vec::new();
    let (mut cells, mut ends, mut refusals) = (Vec::new(), Vec::new(), Vec::new());
    for (row, result) in driven.into_iter().enumerate() {
        match result {
            Ok((values, end)) => {
                for (hint, (name, value)) in values.into_iter().enumerate() {
                    let column = place_of(&mut names, hint, name);
                    cells.push((row, column, value.unwrap_or(f64::NAN)));
                }
                ends.push(Some(end.name()));
                refusals.push(None);
            }
            Err(error) => {
                ends.push(None);
                refusals.push(Some(error.in_one_line()));
            }
        }
    }
    let mut table = vec![f64::NAN; ends.len() * names.len()];
    for (row, column, value) in cells {
        table[row * names.len() + column] = value;
    }
    let table = table.into_pyarray(py).reshape([ends.len(), names.len()])?;
    Ok((names, table, ends, refusals))
}
