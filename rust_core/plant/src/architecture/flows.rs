//! Every power and heat flow of a step: those of every vehicle by name, those of its architecture by position.

/// A power or heat flow, positive in the direction that its name and description give.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Flow(pub u8);

macro_rules! flows {
    ($( $(#[doc = $doc:literal])* $name:ident, $column:literal, $crossing:ident; )*) => {
        #[allow(non_camel_case_types, clippy::upper_case_acronyms, reason = "numbers the flows in their order")]
        #[derive(Clone, Copy)]
        enum Place { $( $name, )* COUNT }

        impl Flow {
            $( $(#[doc = $doc])* pub const $name: Self = Self(Place::$name as u8); )*
        }

        /// Flows that every vehicle has.
        pub const OF_EVERY_VEHICLE: &[FixedFlow] = &[
            $( FixedFlow {
                flow: Flow::$name,
                column: $column,
                description: concat!($( $doc, )*).trim_ascii_start(),
                crossing: Crossing::$crossing,
            }, )*
        ];

        /// Number of flows that every vehicle has.
        pub const FIXED_COUNT: usize = Place::COUNT as usize;
    };
}

/// Whether a flow crosses the boundary of the vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Crossing {
    /// It enters.
    Enters,
    /// It leaves.
    Leaves,
    /// It stays inside.
    Inside,
}

/// A flow that every vehicle has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FixedFlow {
    /// Place.
    pub flow: Flow,
    /// Name of the trajectory column.
    pub column: &'static str,
    /// What flows from where to where.
    pub description: &'static str,
    /// Whether it crosses the boundary.
    pub crossing: Crossing,
}

flows! {
    /// Drag power of the body.
    DRAG, "drag_power_w", Leaves;
    /// Rolling resistance power.
    ROLLING, "rolling_resistance_power_w", Leaves;
    /// Rise of kinetic energy.
    KINETIC, "kinetic_power_w", Inside;
    /// Rise of potential energy, negative downhill.
    CLIMB, "climb_power_w", Inside;
    /// Power at the wheels, negative while braking.
    WHEEL, "wheel_power_w", Inside;
    /// Braking power of the friction brakes.
    FRICTION_BRAKE, "friction_brake_power_w", Leaves;
    /// Electrical power of motor and inverter, negative while recuperating.
    TRACTION, "traction_power_w", Inside;
    /// Power that the battery could not deliver.
    UNSERVED, "unserved_power_w", Enters;
    /// Heat produced in motor and inverter.
    MOTOR_LOSS, "motor_loss_w", Inside;
    /// Heat produced in the transmission.
    TRANSMISSION_LOSS, "transmission_loss_w", Inside;
    /// Constant 12 V load; leaves to ambient.
    AUXILIARY, "low_voltage_power_w", Leaves;
    /// Fan; leaves to ambient.
    FAN, "fan_power_w", Leaves;
    /// Compressor with its motor and inverter.
    COMPRESSOR, "compressor_power_w", Inside;
    /// Part of the compressor power that leaves to ambient.
    COMPRESSOR_LOSS, "compressor_loss_w", Leaves;
    /// Heat from the condensing refrigerant.
    CONDENSER, "condenser_heat_flow_w", Inside;
    /// Heat into the evaporating refrigerant.
    EVAPORATOR, "evaporator_heat_flow_w", Inside;
    /// Terminal power of the battery, positive while discharging.
    BATTERY, "battery_power_w", Inside;
    /// Chemical power of the battery: open-circuit voltage times current.
    CHEMICAL, "battery_chemical_power_w", Inside;
    /// Heat produced in the battery.
    BATTERY_LOSS, "battery_loss_w", Inside;
}

impl Flow {
    /// Position in arrays of flows.
    #[must_use]
    #[inline]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// A flow of an architecture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FlowRow {
    /// Place.
    pub flow: Flow,
    /// Name of the trajectory column.
    pub column: String,
    /// What flows from where to where.
    pub description: String,
    /// Whether it crosses the boundary.
    pub crossing: Crossing,
}

impl FlowRow {
    /// Name of its energy over a run [kWh].
    #[must_use]
    pub fn energy_column(&self) -> String {
        let stem =
            self.column.trim_end_matches("_w").trim_end_matches("_power").trim_end_matches("_heat_flow");
        format!("{stem}_energy_kwh")
    }
}
