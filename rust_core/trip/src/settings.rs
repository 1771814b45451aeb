//! What a driver has set: numbers that a controller would choose for itself, once for a trip or over time.

use crate::kinds::SERIES;
use crate::roles::Roles;
use crate::trace::Trace;
use crate::trace::columns::Quantity;
use hp_plant::command::Demand;
use hp_plant::config::{Celsius, Validate, Violation, check_range};
use hp_plant::error::PlantResult;
use serde::Deserialize;
use std::sync::Arc;

/// Quantities that a series of settings is read for.
const QUANTITIES: &[Quantity] = &[Quantity::CabinSetPoint, Quantity::Blower, Quantity::Recirculation];

/// Table `[settings]` of a scenario; what it does not give, nor its series, the controller chooses.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SettingsParameters {
    /// Path of a trace with settings over time; what it has counts before the constants.
    series: Option<String>,
    /// Cabin temperature [degC].
    cabin_set_point_degc: Option<Celsius>,
    /// Blower level [-].
    blower_level: Option<f64>,
    /// Recirculated share of the supply air [-]; a vehicle recirculates at most what it can.
    recirculation: Option<f64>,
    /// What the series holds.
    #[serde(skip)]
    trace: Option<Arc<Trace>>,
}

impl Validate for SettingsParameters {
    fn validate(&self) -> Result<(), Violation> {
        let range = |key, value: Option<f64>, low, high| match value {
            Some(value) => check_range(key, value, low, high),
            None => Ok(()),
        };
        range("cabin_set_point_degc", self.cabin_set_point_degc.map(|degc| degc.0), 10.0, 30.0)?;
        range("blower_level", self.blower_level, 0.0, 1.0)?;
        range("recirculation", self.recirculation, 0.0, 1.0)
    }
}

impl SettingsParameters {
    /// The same with its series read.
    ///
    /// # Errors
    /// It is no trace, or has none of the settings.
    pub(crate) fn loaded(&self) -> PlantResult<Self> {
        let Some(path) = &self.series else { return Ok(self.clone()) };
        let trace = Trace::load(SERIES, path)?;
        trace.check_has_any(QUANTITIES)?;
        Ok(Self { trace: Some(Arc::new(trace)), ..self.clone() })
    }

    /// What its series holds, where it has one.
    #[must_use]
    pub fn trace(&self) -> Option<&Trace> {
        self.trace.as_deref()
    }

    /// The key of something that is set, if anything is.
    #[must_use]
    pub fn first_key(&self) -> Option<&'static str> {
        [
            ("series", self.series.is_some()),
            ("cabin_set_point_degc", self.cabin_set_point_degc.is_some()),
            ("blower_level", self.blower_level.is_some()),
            ("recirculation", self.recirculation.is_some()),
        ]
        .into_iter()
        .find_map(|(key, given)| given.then_some(key))
    }

    /// What is set in the second after so many; after the end of a series, what it ends with.
    #[must_use]
    #[inline]
    pub fn at(&self, second: usize) -> DriverSettings {
        let constants = DriverSettings {
            cabin_set_point: self.cabin_set_point_degc,
            blower_level: self.blower_level,
            recirculation: self.recirculation,
        };
        match &self.trace {
            Some(trace) => over(trace, second, constants),
            None => constants,
        }
    }
}

/// Settings of a trace at a second over constants.
fn over(trace: &Trace, second: usize, constants: DriverSettings) -> DriverSettings {
    let second = second.min(trace.duration_s());
    let at = |quantity: Quantity| trace.values(quantity).map(|values| values[second]);
    DriverSettings {
        cabin_set_point: at(Quantity::CabinSetPoint).map(Celsius).or(constants.cabin_set_point),
        blower_level: at(Quantity::Blower).or(constants.blower_level),
        recirculation: at(Quantity::Recirculation).or(constants.recirculation),
    }
}

/// What a driver has set; rules choose what is not given.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DriverSettings {
    /// Cabin temperature.
    pub cabin_set_point: Option<Celsius>,
    /// Blower level [-].
    pub blower_level: Option<f64>,
    /// Recirculated share [-].
    pub recirculation: Option<f64>,
}

impl DriverSettings {
    /// Temperature that rules with a target of their own aim at [K].
    #[must_use]
    #[inline]
    pub fn target_k(&self, own: Celsius) -> f64 {
        self.cabin_set_point.unwrap_or(own).kelvin()
    }

    /// Enters what is set into a demand in place of what rules have entered; the PTC's controller aims so far below the cabin
    /// temperature [K].
    #[inline]
    pub fn enter(&self, heater_offset_k: f64, roles: &Roles, demand: &mut Demand) {
        if let (Some(set_point), Some(row)) = (self.cabin_set_point, roles.set_point_row) {
            demand[row] = Celsius(set_point.0 - heater_offset_k).kelvin();
        }
        if let Some(level) = self.blower_level {
            roles.blow(level, demand);
        }
        if let Some(share) = self.recirculation {
            for &row in &roles.recirculation_rows {
                demand[row] = share;
            }
        }
    }
}
