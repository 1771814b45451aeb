//! Files that are compiled in for Python alone (`build.rs`).

use hp_plant::error::PlantError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors::to_python;

include!(concat!(env!("OUT_DIR"), "/policies.rs"));

const POLICY_ENDING: &str = ".safetensors";

/// Names of the reference policies that are compiled in: their files in `agents/reference_policies` without ending.
#[pyfunction]
pub fn reference_policy_names() -> Vec<&'static str> {
    REFERENCE_POLICIES.iter().filter_map(|(file, _)| file.strip_suffix(POLICY_ENDING)).collect()
}

/// Bytes of the file of a reference policy.
#[pyfunction]
pub fn reference_policy<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyBytes>> {
    let found = REFERENCE_POLICIES.iter().find(|(file, _)| file.strip_suffix(POLICY_ENDING) == Some(name));
    let (_, bytes) = found.ok_or_else(|| {
        let available = reference_policy_names().join(", ");
        to_python(PlantError::Unknown { kind: "reference policy", name: name.to_owned(), available })
    })?;
    Ok(PyBytes::new(py, bytes))
}
