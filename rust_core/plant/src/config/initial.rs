//! State of a vehicle at the start.

use super::{Celsius, Validate, Violation, check_range};
use serde::{Deserialize, Serialize};

/// State at the start; what is not given has the soak temperature.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InitialParameters {
    /// Temperature of everything after the soak [degC].
    pub soak_temperature_degc: Celsius,
    /// State of charge [%].
    pub state_of_charge_pct: f64,
    /// Cabin air and furnishings [degC].
    pub cabin_temperature_degc: Option<Celsius>,
    /// Battery [degC].
    pub battery_temperature_degc: Option<Celsius>,
    /// Thermal battery [degC].
    pub thermal_battery_temperature_degc: Option<Celsius>,
}

impl Validate for InitialParameters {
    fn validate(&self) -> Result<(), Violation> {
        check_range("soak_temperature_degc", self.soak_temperature_degc, -50.0, 70.0)?;
        check_range("state_of_charge_pct", self.state_of_charge_pct, 0.0, 100.0)?;
        for (key, value) in [
            ("cabin_temperature_degc", self.cabin_temperature_degc),
            ("battery_temperature_degc", self.battery_temperature_degc),
            ("thermal_battery_temperature_degc", self.thermal_battery_temperature_degc),
        ] {
            if let Some(value) = value {
                check_range(key, value, -50.0, 100.0)?;
            }
        }
        Ok(())
    }
}
