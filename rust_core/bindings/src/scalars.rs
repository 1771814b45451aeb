//! NumPy's own numbers.

use numpy::npyffi::PY_ARRAY_API;
use numpy::{PyArrayDescrMethods, dtype};
use pyo3::prelude::*;
use std::ptr::{from_ref, null_mut};

/// A number as `numpy.float64`, which readers of infos ask for its `dtype`. Calling the type takes several times as long.
///
/// # Errors
/// There is no memory for it.
#[allow(unsafe_code, reason = "NumPy's interface in C has no other way to make one")]
pub fn float64(py: Python<'_>, value: f64) -> PyResult<Bound<'_, PyAny>> {
    let kind = dtype::<f64>(py);
    // SAFETY: NumPy copies a number of the given type from a place that holds one, and gives a new reference or none with an
    // error set; the type outlives the call, and no owner is named.
    unsafe {
        let place = from_ref(&value).cast_mut().cast();
        let made = PY_ARRAY_API.PyArray_Scalar(py, place, kind.as_dtype_ptr(), null_mut());
        Bound::from_owned_ptr_or_err(py, made)
    }
}
