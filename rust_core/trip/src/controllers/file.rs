//! Controller files: parameters of rules, and what changes with the ambient temperature (ours).

use super::{RuleParameters, Rules};
use crate::kinds::CONTROLLER;
use crate::strategy::{Strategy, StrategyChanges};
use hp_plant::architecture::layout::Layout;
use hp_plant::config::library::{self, Override};
use hp_plant::config::{Celsius, Validate, Violation, check_range};
use hp_plant::error::{PlantError, PlantResult};
use serde::Deserialize;
use toml::{Table, Value};

/// A controller file.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    /// Parameters outside any band.
    pub parameters: RuleParameters,
    bands: Vec<AmbientBand>,
}

/// What holds up to an ambient temperature.
#[derive(Debug, Clone, PartialEq)]
struct AmbientBand {
    up_to_degc: Celsius,
    parameters: RuleParameters,
    strategy: StrategyChanges,
}

/// The same as the file gives it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct AmbientBandTable {
    up_to_degc: Celsius,
    #[serde(default)]
    controller: Table,
    #[serde(default)]
    strategy: StrategyChanges,
}

impl Validate for AmbientBandTable {
    fn validate(&self) -> Result<(), Violation> {
        check_range("up_to_degc", self.up_to_degc, -100.0, 100.0)
    }
}

impl Controller {
    /// Loads a controller by name or path.
    ///
    /// # Errors
    /// Anything wrong in its file, in one of its bands or in an override.
    pub fn load(name: &str, overrides: &[Override]) -> PlantResult<Self> {
        let mut table = library::table(CONTROLLER, name, overrides)?;
        let bands = table.remove("ambient_bands").unwrap_or_else(|| Value::Array(Vec::new()));
        let Value::Array(rows) = bands else {
            return Err(not_a_list(name, "ambient_bands"));
        };
        let mut bands: Vec<AmbientBand> = Vec::with_capacity(rows.len());
        for (index, row) in rows.into_iter().enumerate() {
            let place = format!("{name}, ambient_bands[{index}]");
            let Value::Table(row) = row else { return Err(not_a_list(name, "ambient_bands")) };
            let band: AmbientBandTable = library::read(&place, row)?;
            if let Some(last) = bands.last().filter(|last| band.up_to_degc <= last.up_to_degc) {
                let allowed = format!("must be above that of the band before ({})", last.up_to_degc.0);
                return Err(Violation::new("up_to_degc", band.up_to_degc.0, allowed).in_file(&place));
            }
            let mut whole = table.clone();
            library::merge(&mut whole, band.controller);
            bands.push(AmbientBand {
                up_to_degc: band.up_to_degc,
                parameters: RuleParameters::read(&place, whole)?,
                strategy: band.strategy,
            });
        }
        Ok(Self { parameters: RuleParameters::read(name, table)?, bands })
    }

    /// The rules at an ambient temperature, for a scenario that allows `strategy` and a vehicle.
    ///
    /// The first band that reaches up to the temperature holds; above all bands, what stands outside of them.
    #[must_use]
    pub fn at(&self, ambient: Celsius, strategy: &Strategy, layout: &Layout) -> Rules {
        match self.bands.iter().find(|band| ambient <= band.up_to_degc) {
            Some(band) => band.parameters.controller(band.strategy.applied_to(strategy), layout),
            None => self.parameters.controller(strategy.clone(), layout),
        }
    }

    /// Members that its bands' changes of the strategy name.
    pub fn members(&self) -> impl Iterator<Item = &str> {
        self.bands.iter().flat_map(|band| band.strategy.members.keys().map(String::as_str))
    }
}

fn not_a_list(name: &str, key: &str) -> PlantError {
    PlantError::Syntax { file: name.to_owned(), message: format!("`{key}` must be a list of tables") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Experiment;
    use crate::strategy::BatteryTreatment;

    fn loaded(bands: &str) -> PlantResult<Controller> {
        let file = tempfile::Builder::new().suffix(".toml").tempfile().expect("a temporary file");
        let text = format!("base = \"hpcu\"\n{bands}");
        std::fs::write(file.path(), text).expect("written");
        Controller::load(file.path().to_str().expect("plain name"), &[])
    }

    #[test]
    fn first_band_that_reaches_the_ambient_temperature_holds() {
        let controller = loaded(
            "[[ambient_bands]]\nup_to_degc = -10.0\nstrategy.battery = \"isolate\"\n\
             [[ambient_bands]]\nup_to_degc = 5.0\ncontroller.battery.heat_up_to_degc = 10.0\n",
        )
        .expect("valid");
        let experiment = Experiment::load("jeffs2019/case1-1", None, &[]).expect("built in");
        let (strategy, layout) = (experiment.scenario.strategy.clone(), experiment.plant.layout());
        let at = |degc: f64| match controller.at(Celsius(degc), &strategy, layout) {
            Rules::Hpcu(hpcu) => hpcu,
            other => panic!("{other:?}"),
        };
        assert_eq!(at(-10.0).strategy.battery, BatteryTreatment::Isolate);
        assert_eq!(at(-10.0).parameters.battery.heat_up_to_degc, Celsius(20.0));
        assert_eq!(at(-9.9), at(5.0));
        assert_eq!(at(5.0).parameters.battery.heat_up_to_degc, Celsius(10.0));
        assert_eq!(at(5.0).parameters.battery.cool_above_degc, Celsius(30.0));
        assert_eq!(Rules::Hpcu(at(5.1)), controller.parameters.controller(strategy.clone(), layout));
    }

    #[test]
    fn errors_of_a_band_name_band_and_key() {
        for (bands, expected) in [
            ("[[ambient_bands]]\nup_to_degc = 500.0\n", "ambient_bands[0]"),
            ("[[ambient_bands]]\nup_to_degc = 0.0\n[[ambient_bands]]\nup_to_degc = -5.0\n", "above that of"),
            ("[[ambient_bands]]\nup_to_degc = 0.0\ncontroller.htc_set_point_degc = 500.0\n", "htc_set_point"),
            ("[[ambient_bands]]\nup_to_degc = 0.0\nstrategy.ptc = 3\n", "ptc"),
            ("ambient_bands = 3\n", "list of tables"),
            ("rules = \"hpcuu\"\n", "`rules` is \"hpcuu\", but must be one of hpcu, thermostat"),
            ("rules = 3\n", "must be one of hpcu, thermostat"),
            // Rules refuse the parameters of others.
            ("rules = \"thermostat\"\n", "unknown field"),
        ] {
            let message = loaded(bands).expect_err("refused").to_string();
            assert!(message.contains(expected), "{bands}: {message}");
        }
    }
}
