//! Actions from NumPy arrays, checked: type, shape, range.

use hp_episode::action;
use hp_episode::rows::ActionRow;
use hp_episode::setup::Setup;
use hp_plant::command::Scale;
use numpy::{PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;

/// Actions of one or many environments.
pub enum Checked<'py> {
    /// Options.
    Levels(PyReadonlyArrayDyn<'py, i64>),
    /// Normalised values.
    Values(PyReadonlyArrayDyn<'py, f32>),
}

/// Reads an action; `count` is the number of environments of a batch.
pub fn read<'py>(action: &Bound<'py, PyAny>, setup: &Setup, count: Option<usize>) -> PyResult<Checked<'py>> {
    if setup.continuous {
        let array = typed::<f32>(action, "f", "float32", "floating point")?;
        let allowed = |_: usize, value: f32| value.is_finite();
        checked(&array, setup, count, allowed, |row, value| {
            (f64::from(value), format!("a finite number, held between -1 and 1 ({})", row.description))
        })?;
        held(array).map(Checked::Values)
    } else {
        let array = typed::<i64>(action, "iu", "int64", "integer")?;
        let options = setup.actions.option_counts();
        let allowed = |column: usize, level: i64| (level as u64) < options[column] as u64;
        let levels = checked(&array, setup, count, allowed, |row, level| {
            let options = action::options(&row.scale);
            let names = match &row.scale {
                Scale::Choice(names) => format!(" ({})", names.join(", ")),
                Scale::Linear | Scale::OffThenLogarithmic => String::new(),
            };
            (level as f64, format!("between 0 and {}{names}", options - 1))
        });
        levels.map(|()| Checked::Levels(array))
    }
}

/// Values held in [-1, 1], as agents expect whose Gaussian actions know no bounds.
fn held(array: PyReadonlyArrayDyn<'_, f32>) -> PyResult<PyReadonlyArrayDyn<'_, f32>> {
    let within = array.as_slice()?.iter().fold(true, |within, value| within & (value.abs() <= 1.0));
    if within {
        return Ok(array);
    }
    let py = array.py();
    let clipped = array.call_method1(intern!(py, "clip"), (-1.0, 1.0))?;
    Ok(clipped.cast_into::<PyArrayDyn<f32>>()?.readonly())
}

/// The action as a contiguous array of one type; other types of the same kind are converted.
fn typed<'py, T: numpy::Element>(
    action: &Bound<'py, PyAny>,
    kinds: &str,
    name: &str,
    kind_words: &str,
) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    if let Ok(array) = action.cast::<PyArrayDyn<T>>()
        && array.is_c_contiguous()
    {
        return Ok(array.readonly());
    }
    let py = action.py();
    let numpy = py.import(intern!(py, "numpy"))?;
    let given = numpy.call_method1(intern!(py, "asarray"), (action,))?;
    let dtype = given.getattr(intern!(py, "dtype"))?;
    let kind: String = dtype.getattr(intern!(py, "kind"))?.extract()?;
    if !kinds.contains(&kind) {
        return Err(PyTypeError::new_err(format!("action is of type {dtype}, but must be {kind_words}")));
    }
    let array = numpy.call_method1(intern!(py, "ascontiguousarray"), (given, name))?;
    Ok(array.cast_into::<PyArrayDyn<T>>()?.readonly())
}

/// Shape, then every value.
fn checked<T: numpy::Element + Copy>(
    array: &PyReadonlyArrayDyn<'_, T>,
    setup: &Setup,
    count: Option<usize>,
    allowed: impl Fn(usize, T) -> bool,
    refuse: impl Fn(&ActionRow, T) -> (f64, String),
) -> PyResult<()> {
    let rows = setup.actions.rows();
    let shape = array.shape();
    let fits = match count {
        None => shape == [rows.len()],
        Some(count) => shape == [count, rows.len()],
    };
    if !fits {
        let allowed = match count {
            None => format!("({},)", rows.len()),
            Some(count) => format!("({count}, {})", rows.len()),
        };
        let names: Vec<&str> = rows.iter().map(|row| row.name.as_str()).collect();
        let message =
            format!("action has the shape {shape:?}, but must have {allowed}: {}", names.join(", "));
        return Err(PyValueError::new_err(message));
    }
    let width = rows.len();
    let values = array.as_slice()?;
    let fits = |row: &[T]| (0..width).fold(true, |fits, column| fits & allowed(column, row[column]));
    let Some(index) = values.chunks_exact(width).position(|row| !fits(row)) else { return Ok(()) };
    for (column, row) in rows.iter().enumerate() {
        let value = values[index * width + column];
        if !allowed(column, value) {
            let (value, allowed) = refuse(row, value);
            let position = if count.is_some() { format!("{index}, {column}") } else { column.to_string() };
            let name = &row.name;
            let message = format!("action[{position}] ({name}) is {value}, but must be {allowed}");
            return Err(PyValueError::new_err(message));
        }
    }
    Ok(())
}
