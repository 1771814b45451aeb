//! The plant's errors as Python exceptions, mapped once.

use hp_plant::error::PlantError;
use pyo3::create_exception;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

create_exception!(
    hp_gym,
    ConfigurationError,
    PyValueError,
    "A file, name or value that the plant does not accept."
);

create_exception!(
    hp_gym,
    StateError,
    ConfigurationError,
    "A saved state that is damaged, or of something else."
);

create_exception!(
    hp_gym,
    InternalError,
    PyRuntimeError,
    "A mistake of this package; what was worked on is refused until it is reset or restored."
);

/// Python exception for an error of the plant.
pub fn to_python(error: PlantError) -> PyErr {
    match error {
        PlantError::Internal { .. } => InternalError::new_err(error.in_one_line()),
        PlantError::State { .. } => StateError::new_err(error.in_one_line()),
        _ => ConfigurationError::new_err(error.in_one_line()),
    }
}

/// What Python's own handlers say of the signals that came.
pub fn signals() -> PyResult<()> {
    Python::attach(|py| py.check_signals())
}

/// An exception of `gymnasium.error` by name.
pub fn gymnasium_error(py: Python<'_>, name: &str, message: &str) -> PyErr {
    let raised = py.import("gymnasium.error").and_then(|module| module.getattr(name)?.call1((message,)));
    raised.map_or_else(|error| error, PyErr::from_value)
}

/// Refuses an environment that was closed.
pub fn require_open(py: Python<'_>, closed: bool) -> PyResult<()> {
    if closed {
        let message = "this environment was closed; make another one";
        return Err(gymnasium_error(py, "ClosedEnvironmentError", message));
    }
    Ok(())
}

/// Refuses an environment without a trip.
pub fn require_begun(py: Python<'_>, begun: bool) -> PyResult<()> {
    if begun { Ok(()) } else { Err(gymnasium_error(py, "ResetNeeded", "call reset() first")) }
}
