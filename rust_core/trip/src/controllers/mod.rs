//! Rule-based controllers, one a file.
//!
//! A controller is a type that implements [`RuleBased`] in a file of its own, declared in the list below. Files in
//! `configs/controllers` select it by `rules = "..."` (`hpcu` where absent) and give its parameters.

pub mod file;
pub mod hpcu;
pub mod options;
pub mod rule_based;
pub mod thermostat;

use crate::roles::Roles;
use crate::settings::DriverSettings;
use crate::strategy::Strategy;
use hp_plant::architecture::layout::Layout;
use hp_plant::command::Demand;
use hp_plant::config::Violation;
use hp_plant::config::library;
use hp_plant::error::PlantResult;
use hp_plant::plant::Plant;
use hp_plant::state::State;
use rule_based::{ConstantSettings, RuleBased, rule_based_controllers};
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

rule_based_controllers! {
    /// Heat pump control unit of the paper.
    hpcu: Hpcu,
    /// On below a cabin temperature, off above it.
    thermostat: Thermostat,
}

/// Rules of a file that names none.
const DEFAULT_RULES: &str = "hpcu";

impl RuleParameters {
    /// Reads and checks a controller's table; `place` is the file that an error names.
    ///
    /// # Errors
    /// There are no such rules, or their parameters are not accepted.
    pub fn read(place: &str, mut table: Table) -> PlantResult<Self> {
        match table.remove("rules") {
            None => Self::of_rules(DEFAULT_RULES, place, table),
            Some(Value::String(rules)) => Self::of_rules(&rules, place, table),
            Some(other) => {
                let allowed = format!("must be one of {}", RULES.join(", "));
                Err(Violation::new("rules", other, allowed).in_file(place))
            }
        }
    }
}
