//! Python bindings: conversions only, no logic.

mod actions;
mod embedded;
mod episode;
mod errors;
mod experiment;
mod vector;

use pyo3::prelude::*;

/// Read from the file by `hp_gym/processor.py`, before any of this runs.
const BUILT_FOR: &str = if cfg!(all(target_feature = "avx2", target_feature = "fma")) {
    "hp_gym built for AVX2 and FMA"
} else {
    "hp_gym built for every processor of its kind"
};

/// Compiled core of `hp_gym`.
#[pymodule]
mod _core {
    #[pymodule_export]
    use super::embedded::{reference_policy, reference_policy_names};
    #[pymodule_export]
    use super::episode::{Episode, observation_table, reward_parts};
    #[pymodule_export]
    use super::errors::ConfigurationError;
    use super::errors::to_python;
    #[pymodule_export]
    use super::experiment::{Experiment, Run, plant_step_seconds, signal_table, totals};
    #[pymodule_export]
    use super::vector::Vector;
    use hp_plant::command::{ACTUATORS, Scale};
    use hp_plant::config::library::{self, Kind};
    use hp_plant::error::PlantError;
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__built_for__", super::BUILT_FOR)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }

    fn kind(word: &str) -> PyResult<Kind> {
        let kinds = [
            Kind::Vehicle,
            Kind::Controller,
            Kind::Scenario,
            Kind::Cycle,
            Kind::Refrigerant,
            Kind::Calibration,
            Kind::Episodes,
            Kind::Reward,
            Kind::Benchmark,
            Kind::Training,
        ];
        kinds.into_iter().find(|kind| kind.word() == word).ok_or_else(|| {
            let available = kinds.map(Kind::word).join(", ");
            to_python(PlantError::Unknown { kind: "kind of configuration", name: word.to_owned(), available })
        })
    }

    /// Names of the configuration files of a kind that are compiled in.
    #[pyfunction]
    fn names(kind_word: &str) -> PyResult<Vec<&'static str>> {
        Ok(library::names(kind(kind_word)?))
    }

    /// Text of a configuration file by name or path.
    #[pyfunction]
    fn config_text(kind_word: &str, name: &str) -> PyResult<String> {
        library::text(kind(kind_word)?, name).map_err(to_python)
    }

    /// Name, unit, options (empty for levels) and description of every actuator.
    #[pyfunction]
    fn actuators() -> Vec<(&'static str, &'static str, Vec<&'static str>, &'static str)> {
        ACTUATORS
            .iter()
            .map(|actuator| {
                let options = match actuator.scale {
                    Scale::Choice(options) => options.to_vec(),
                    Scale::Linear | Scale::OffThenLogarithmic => Vec::new(),
                };
                (actuator.name, actuator.unit, options, actuator.description)
            })
            .collect()
    }
}
