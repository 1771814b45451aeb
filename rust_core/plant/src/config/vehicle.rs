//! One complete vehicle.

use super::{Validate, Violation};
use crate::circuits::refrigeration_cycle::RefrigerationParameters;
use crate::components::ambient_exchanger::AmbientExchangerParameters;
use crate::components::battery::BatteryParameters;
use crate::components::body::BodyParameters;
use crate::components::cabin::CabinParameters;
use crate::components::coolant_loop::{ChillerParameters, HtcParameters};
use crate::components::motor::MotorParameters;
use crate::components::pid::PidParameters;
use crate::components::powertrain::RegenerationParameters;
use crate::components::ptc::PtcParameters;
use crate::components::thermal_battery::ThermalBatteryParameters;
use crate::components::thermal_switch::SwitchParameters;
use crate::components::transmission::TransmissionParameters;
use crate::parameters;
use serde::{Deserialize, Serialize};

/// All parameters of a vehicle, one field a section of its file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VehicleParameters {
    /// What this vehicle is, in a sentence.
    pub description: String,
    /// Name or path of the refrigerant's table.
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

parameters! {
    /// Controls that belong to the plant itself.
    pub struct PlantControlParameters {
        /// Constant 12 V load without pumps, blower and fan [W].
        auxiliary_power_w: f64 = 0.0 .. 5000.0,
        ;
        /// Thermal switches.
        thermal_switch: SwitchParameters,
        /// Compressor power against condensing pressure (`PID_pressureControl`), W per bar.
        pressure_pid: PidParameters,
    }
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
