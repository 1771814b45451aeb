//! Python bindings: conversions only, no logic.

mod actions;
mod embedded;
mod episode;
mod errors;
mod experiment;
mod kinds;
mod scalars;
mod sweep;
mod traces;
mod vector;
mod vehicles;

use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::{PyImportError, PyKeyboardInterrupt};
use pyo3::prelude::*;

/// Read from the file by `hp_gym/processor.py`, before any of this runs.
const BUILT_FOR: &str = if cfg!(all(target_feature = "avx2", target_feature = "fma")) {
    "hp_gym built for AVX2 and FMA"
} else {
    "hp_gym built for every processor of its kind"
};

/// Loads NumPy's interface now: `numpy` looks for it the first time that it makes or takes an array, where an interrupt
/// would be a panic.
fn load_numpy(py: Python<'_>) -> PyResult<()> {
    py.import("numpy")?;
    let loaded = hp_episode::guard::caught(|| {
        let array = PyArray1::<f64>::zeros(py, 1, false);
        drop(array.readwrite());
        Ok(())
    });
    // Nothing but a signal comes in between.
    loaded.map_err(|error| match error.to_string() {
        message if message.contains("KeyboardInterrupt") => PyKeyboardInterrupt::new_err(()),
        message => PyImportError::new_err(message),
    })
}

/// Compiled core of `hp_gym`.
#[pymodule]
mod _core {
    #[pymodule_export]
    use super::embedded::{reference_policy, reference_policy_names};
    #[pymodule_export]
    use super::episode::{
        Episode, action_groups, default_settings, observation_table, reward_parts, reward_terms,
    };
    use super::errors::to_python;
    #[pymodule_export]
    use super::errors::{ConfigurationError, InternalError, StateError};
    #[pymodule_export]
    use super::experiment::{Experiment, Run, plant_step_seconds, totals};
    use super::kinds::{BENCHMARK, CALIBRATION, TRAINING, VALIDATION};
    #[pymodule_export]
    use super::sweep::summaries_of;
    #[pymodule_export]
    use super::traces::{trace, trace_columns};
    #[pymodule_export]
    use super::vector::{FinishedTrip, Outcomes, Vector};
    #[pymodule_export]
    use super::vehicles::{actuators, architecture_layout, signal_table, vehicle_layout};
    use hp_episode::kinds::{EPISODES, REWARD};
    use hp_plant::config::kinds::{ARCHITECTURE, REFRIGERANT, VEHICLE};
    use hp_plant::config::library::{self, Kind};
    use hp_plant::error::PlantError;
    use hp_trip::kinds::{CONTROLLER, CYCLE, SCENARIO};
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        hp_episode::guard::note_panics();
        super::load_numpy(module.py())?;
        module.add("LEVELS", hp_episode::action::LEVELS)?;
        module.add("__built_for__", super::BUILT_FOR)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }

    /// Every kind of configuration.
    const KINDS: [Kind; 12] = [
        VEHICLE,
        ARCHITECTURE,
        CONTROLLER,
        SCENARIO,
        CYCLE,
        REFRIGERANT,
        CALIBRATION,
        EPISODES,
        REWARD,
        BENCHMARK,
        TRAINING,
        VALIDATION,
    ];

    fn kind(word: &str) -> PyResult<Kind> {
        KINDS.into_iter().find(|kind| kind.word == word).ok_or_else(|| {
            let available = KINDS.map(|kind| kind.word).join(", ");
            to_python(PlantError::Unknown { kind: "kind of configuration", name: word.to_owned(), available })
        })
    }

    /// Names of the configuration files of a kind that are compiled in.
    #[pyfunction]
    fn names(kind_word: &str) -> PyResult<Vec<&'static str>> {
        Ok(library::names(kind(kind_word)?))
    }

    /// Whether a TOML text goes deeper than any file may, found without parsing it.
    #[pyfunction]
    fn looks_deep(text: &str) -> bool {
        hp_plant::config::bounded::looks_deep(text)
    }

    /// Text of a configuration file by name or path.
    #[pyfunction]
    fn config_text(kind_word: &str, name: &str) -> PyResult<String> {
        library::text(kind(kind_word)?, name).map_err(to_python)
    }
}
