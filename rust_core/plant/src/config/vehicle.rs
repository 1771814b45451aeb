//! One complete vehicle.

use super::battery::BatteryParameters;
use super::cabin::CabinParameters;
use super::coolant::{
    AmbientExchangerParameters, ChillerParameters, HtcParameters, PlantControlParameters, PtcParameters,
    ThermalBatteryParameters,
};
use super::powertrain::{BodyParameters, MotorParameters, RegenerationParameters, TransmissionParameters};
use super::refrigeration::RefrigerationParameters;
use super::{Validate, Violation};
use serde::{Deserialize, Serialize};

/// All parameters of a vehicle, one field a section of its file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VehicleParameters {
    /// What this vehicle is, in a sentence.
    pub description: String,
    /// Name of the refrigerant table.
    pub refrigerant: String,
    /// Longitudinal dynamics.
    pub body: BodyParameters,
    /// Regenerative braking.
    pub regeneration: RegenerationParameters,
    /// Motor and inverter.
    pub motor: MotorParameters,
    /// Transmission.
    pub transmission: TransmissionParameters,
    /// Battery.
    pub battery: BatteryParameters,
    /// Cabin.
    pub cabin: CabinParameters,
    /// High temperature circuit.
    pub htc: HtcParameters,
    /// Chiller circuit.
    pub chiller: ChillerParameters,
    /// PTC heater.
    pub ptc: PtcParameters,
    /// Thermal battery.
    pub thermal_battery: ThermalBatteryParameters,
    /// Front-end exchanger.
    pub ambient_exchanger: AmbientExchangerParameters,
    /// Refrigerant loop.
    pub refrigeration: RefrigerationParameters,
    /// The plant's own controls.
    pub controls: PlantControlParameters,
}

impl Validate for VehicleParameters {
    fn validate(&self) -> Result<(), Violation> {
        let sections: [(&str, &dyn Validate); 13] = [
            ("body", &self.body),
            ("regeneration", &self.regeneration),
            ("motor", &self.motor),
            ("transmission", &self.transmission),
            ("battery", &self.battery),
            ("cabin", &self.cabin),
            ("htc", &self.htc),
            ("chiller", &self.chiller),
            ("ptc", &self.ptc),
            ("thermal_battery", &self.thermal_battery),
            ("ambient_exchanger", &self.ambient_exchanger),
            ("refrigeration", &self.refrigeration),
            ("controls", &self.controls),
        ];
        for (name, section) in sections {
            section.validate().map_err(|violation| violation.within(name))?;
        }
        let switch = &self.controls.thermal_switch;
        if switch.opening_difference_k > switch.closing_difference_k {
            return Err(Violation::new(
                "controls.thermal_switch.opening_difference_k",
                switch.opening_difference_k,
                format!("must not exceed closing_difference_k ({})", switch.closing_difference_k),
            ));
        }
        Ok(())
    }
}
