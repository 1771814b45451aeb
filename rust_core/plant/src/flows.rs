//! Every power and heat flow of a step, in one table.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::ops::{Index, IndexMut};

macro_rules! flows {
    ($( $(#[doc = $doc:literal])* $name:ident, $text:literal; )*) => {
        /// A power or heat flow, positive in the direction that its name and description give.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Flow {
            $( $(#[doc = $doc])* $name, )*
        }

        impl Flow {
            /// All flows.
            pub const ALL: &'static [Self] = &[$( Self::$name, )*];

            /// Name of the trajectory column.
            #[must_use]
            pub const fn column(self) -> &'static str {
                match self { $( Self::$name => $text, )* }
            }

            /// What flows from where to where.
            #[must_use]
            pub const fn description(self) -> &'static str {
                match self { $( Self::$name => concat!($( $doc, )*).trim_ascii_start(), )* }
            }
        }
    };
}

flows! {
    /// Drag power of the body.
    Drag, "drag_power_w";
    /// Rolling resistance power.
    Rolling, "rolling_resistance_power_w";
    /// Rise of kinetic energy.
    Kinetic, "kinetic_power_w";
    /// Power at the wheels, negative while braking.
    Wheel, "wheel_power_w";
    /// Braking power of the friction brakes.
    FrictionBrake, "friction_brake_power_w";
    /// Electrical power of motor and inverter, negative while recuperating.
    Traction, "traction_power_w";
    /// Power that the battery could not deliver.
    Unserved, "unserved_power_w";
    /// Heat produced in motor and inverter.
    MotorLoss, "motor_loss_w";
    /// Heat produced in the transmission.
    TransmissionLoss, "transmission_loss_w";
    /// Constant 12 V load; leaves to ambient.
    Auxiliary, "low_voltage_power_w";
    /// HTC pump; warms its coolant.
    HtcPump, "htc_pump_power_w";
    /// Chiller pump; warms its coolant.
    ChillerPump, "chiller_pump_power_w";
    /// Blower; warms the cabin air.
    Blower, "blower_power_w";
    /// Fan; leaves to ambient.
    Fan, "fan_power_w";
    /// PTC heater; warms the HTC.
    Ptc, "ptc_power_w";
    /// Compressor with its motor and inverter.
    Compressor, "compressor_power_w";
    /// Part of the compressor power that leaves to ambient.
    CompressorLoss, "compressor_loss_w";
    /// Heat from refrigerant to HTC.
    Condenser, "condenser_heat_flow_w";
    /// Heat from chiller loop to refrigerant.
    Evaporator, "evaporator_heat_flow_w";
    /// Terminal power of the battery, positive while discharging.
    Battery, "battery_power_w";
    /// Chemical power of the battery: open-circuit voltage times current.
    Chemical, "battery_chemical_power_w";
    /// Heat produced in the battery.
    BatteryLoss, "battery_loss_w";
    /// Solar heat into the cabin.
    Solar, "solar_heat_flow_w";
    /// Heat of the occupants into the cabin.
    Occupants, "occupant_heat_flow_w";
    /// HTC coolant flow, supply to return side; internal.
    HtcAdvection, "htc_advection_w";
    /// Chiller coolant flow, supply to return side; internal.
    ChillerAdvection, "chiller_advection_w";
    /// Hoses of the HTC supply to ambient.
    HtcSupplyHose, "htc_supply_hose_heat_flow_w";
    /// Hoses of the HTC return to ambient.
    HtcReturnHose, "htc_return_hose_heat_flow_w";
    /// Hoses of the chiller supply to ambient.
    ChillerSupplyHose, "chiller_supply_hose_heat_flow_w";
    /// Hoses of the chiller return to ambient.
    ChillerReturnHose, "chiller_return_hose_heat_flow_w";
    /// HTC to cabin.
    CabinHtc, "cabin_htc_heat_flow_w";
    /// HTC to battery.
    BatteryHtc, "battery_htc_heat_flow_w";
    /// HTC to ambient.
    AmbientHtc, "ambient_htc_heat_flow_w";
    /// Motor and inverter to chiller loop.
    MotorChiller, "motor_chiller_heat_flow_w";
    /// Transmission to chiller loop.
    TransmissionChiller, "transmission_chiller_heat_flow_w";
    /// Battery to chiller loop.
    BatteryChiller, "battery_chiller_heat_flow_w";
    /// Ambient to chiller loop.
    AmbientChiller, "ambient_chiller_heat_flow_w";
    /// Cabin to chiller loop.
    CabinChiller, "cabin_chiller_heat_flow_w";
    /// Thermal battery to HTC.
    ThermalBatteryHtc, "thermal_battery_htc_heat_flow_w";
    /// Thermal battery to chiller loop.
    ThermalBatteryChiller, "thermal_battery_chiller_heat_flow_w";
    /// Exhaust air to chiller loop.
    ExhaustRecovery, "exhaust_recovery_heat_flow_w";
    /// Battery through its plate to ambient.
    BatteryAmbient, "battery_ambient_heat_flow_w";
    /// Motor and inverter to ambient.
    MotorAmbient, "motor_ambient_heat_flow_w";
    /// Transmission to ambient.
    TransmissionAmbient, "transmission_ambient_heat_flow_w";
    /// Thermal battery to ambient.
    ThermalBatteryAmbient, "thermal_battery_ambient_heat_flow_w";
    /// Cabin through its panels to ambient.
    PanelAmbient, "cabin_panel_heat_flow_w";
    /// Cabin air to soft furnishings.
    Soft, "soft_furnishings_heat_flow_w";
    /// Cabin air to hard furnishings.
    Hard, "hard_furnishings_heat_flow_w";
    /// Cabin air into the small exhaust volume, relative to ambient.
    CabinExhaust, "cabin_exhaust_heat_flow_w";
    /// Exhaust air leaving the vehicle, relative to ambient.
    ExhaustAmbient, "exhaust_ambient_heat_flow_w";
}

/// Number of flows.
pub const FLOW_COUNT: usize = Flow::ExhaustAmbient as usize + 1;

/// One value for each flow [W].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flows([f64; FLOW_COUNT]);

impl Default for Flows {
    fn default() -> Self {
        Self([0.0; FLOW_COUNT])
    }
}

impl Serialize for Flows {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.as_slice().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Flows {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let values = Vec::<f64>::deserialize(deserializer)?;
        let count = values.len();
        let values = values.try_into();
        values.map(Self).map_err(|_| D::Error::custom(format!("{count} flows, but there are {FLOW_COUNT}")))
    }
}

impl Index<Flow> for Flows {
    type Output = f64;
    fn index(&self, flow: Flow) -> &f64 {
        &self.0[flow as usize]
    }
}

impl IndexMut<Flow> for Flows {
    fn index_mut(&mut self, flow: Flow) -> &mut f64 {
        &mut self.0[flow as usize]
    }
}

impl Flows {
    /// Adds another set of flows with a weight.
    pub fn accumulate(&mut self, other: &Self, weight: f64) {
        for (mine, theirs) in self.0.iter_mut().zip(&other.0) {
            *mine += weight * theirs;
        }
    }

    /// Values in the order of [`Flow::ALL`].
    #[must_use]
    pub fn values(&self) -> &[f64; FLOW_COUNT] {
        &self.0
    }

    /// Electrical power besides traction, compressor and PTC [W].
    #[must_use]
    pub fn base_load_w(&self) -> f64 {
        self[Flow::Auxiliary]
            + self[Flow::HtcPump]
            + self[Flow::ChillerPump]
            + self[Flow::Blower]
            + self[Flow::Fan]
    }
}
