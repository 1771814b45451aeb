//! The one way in: what any controller, rule-based, scheduled or learned, tells the plant.
//!
//! A command is a row of single-precision numbers in `[-1, 1]`, one for each actuator of [`ACTUATORS`]. The
//! HPCU, schedules and agents all write this form, so none of them has a path of its own and runs with any of
//! them can be repeated bit for bit.

use crate::config::vehicle::VehicleParameters;
use crate::error::{PlantError, PlantResult};
use crate::numerics::elementary;
use serde::{Deserialize, Serialize};

/// Number of actuators.
pub const ACTUATOR_COUNT: usize = 25;

/// Largest heat flow that can be requested of a connection [W].
pub const MAXIMUM_REQUEST_W: f64 = 20_000.0;

/// Normalised compressor demand below which the compressor is off.
const COMPRESSOR_OFF_BELOW: f64 = -0.9;

/// Lowest and highest cabin set point that can be commanded [K].
const CABIN_SET_POINT_RANGE_K: (f64, f64) = (283.15, 303.15);

/// A component that can be connected to the coolant loops.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Member {
    /// Battery.
    Battery,
    /// Motor and inverter.
    Motor,
    /// Transmission and driveline.
    Transmission,
    /// Front-end exchanger.
    Ambient,
    /// Thermal battery.
    ThermalBattery,
    /// Cabin.
    Cabin,
}

impl Member {
    /// All members, in actuator order.
    pub const ALL: [Self; 6] =
        [Self::Battery, Self::Motor, Self::Transmission, Self::Ambient, Self::ThermalBattery, Self::Cabin];

    /// Connections that this member has, in the order of its actuator's options.
    #[must_use]
    pub fn options(self) -> &'static [Connection] {
        use Connection::{Chiller, Htc, Isolated};
        match self {
            Self::Battery | Self::ThermalBattery | Self::Cabin => &[Isolated, Htc, Chiller],
            Self::Motor | Self::Transmission => &[Isolated, Chiller],
            Self::Ambient => &[Isolated, Chiller, Htc],
        }
    }
}

/// Which loop a member is connected to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Connection {
    /// To none.
    #[default]
    Isolated,
    /// To the high temperature circuit.
    Htc,
    /// To the chiller circuit.
    Chiller,
}

/// How an actuator reads its normalised value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// One of several options, equal parts of `[-1, 1]`.
    Choice(&'static [&'static str]),
    /// Linear between the ends of its range.
    Linear,
    /// Off below -0.9, then from lowest to highest value evenly in the logarithm.
    OffThenLogarithmic,
}

/// One actuator: a row of the command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Actuator {
    /// Name used in files, tables and action spaces.
    pub name: &'static str,
    /// Unit of the physical value.
    pub unit: &'static str,
    /// How the normalised value is read.
    pub scale: Scale,
    /// What it does.
    pub description: &'static str,
}

const fn choice(name: &'static str, options: &'static [&'static str], description: &'static str) -> Actuator {
    Actuator { name, unit: "-", scale: Scale::Choice(options), description }
}

const fn level(name: &'static str, unit: &'static str, description: &'static str) -> Actuator {
    Actuator { name, unit, scale: Scale::Linear, description }
}

/// The actuator table; a command holds one value for each row.
pub const ACTUATORS: [Actuator; ACTUATOR_COUNT] = [
    choice("battery", &["isolated", "htc", "chiller"], "connection of the battery"),
    choice("motor", &["isolated", "chiller"], "connection of motor and inverter"),
    choice("transmission", &["isolated", "chiller"], "connection of the transmission"),
    choice("ambient", &["isolated", "chiller", "htc"], "connection of the front-end exchanger"),
    choice("thermal_battery", &["isolated", "htc", "chiller"], "connection of the thermal battery"),
    choice("cabin", &["isolated", "htc", "chiller"], "connection of the cabin"),
    choice("ptc", &["off", "allowed"], "PTC heater under its own PID on the cabin temperature"),
    Actuator {
        name: "compressor_power",
        unit: "W",
        scale: Scale::OffThenLogarithmic,
        description: "electrical power demand of the compressor",
    },
    level("recirculation", "-", "recirculated share of the supply air"),
    level("blower_level", "-", "blower level between smallest and largest air flow"),
    level("htc_flow", "kg/s", "coolant flow demand of the high temperature circuit"),
    level("chiller_flow", "kg/s", "coolant flow demand of the chiller circuit"),
    level("battery_request", "W", "heat flow requested between battery and its loop"),
    level("motor_request", "W", "heat flow requested from motor and inverter"),
    level("transmission_request", "W", "heat flow requested from the transmission"),
    level("ambient_request", "W", "heat flow requested between ambient and its loop"),
    level("thermal_battery_request", "W", "heat flow requested from the thermal battery"),
    level("cabin_request", "W", "heat flow requested between cabin and its loop"),
    level("battery_valve", "-", "valve of the battery's branch: share of its open position"),
    level("motor_valve", "-", "valve of the motor's branch: share of its open position"),
    level("transmission_valve", "-", "valve of the transmission's branch: share of its open position"),
    level("ambient_valve", "-", "valve of the front-end exchanger's branch: share of its open position"),
    level("thermal_battery_valve", "-", "valve of the thermal battery's branch: share of its open position"),
    level("cabin_valve", "-", "valve of the cabin's branch: share of its open position"),
    level("cabin_set_point", "K", "cabin temperature that the PTC's PID aims at"),
];

const PTC: usize = 6;
/// Row of the compressor demand.
pub const COMPRESSOR: usize = 7;
/// Row of the recirculated share.
pub const RECIRCULATION: usize = 8;
/// Row of the blower level.
pub const BLOWER: usize = 9;
const HTC_FLOW: usize = 10;
const CHILLER_FLOW: usize = 11;
/// First of the six rows of requested heat flows, by member.
pub const REQUESTS: usize = 12;
const VALVES: usize = 18;
const CABIN_SET_POINT: usize = 24;

/// A command as it crosses every interface: normalised, single precision.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Command(pub [f32; ACTUATOR_COUNT]);

/// A command in physical units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Demand {
    /// Connection asked for, by member.
    pub connections: [Connection; 6],
    /// Whether the PTC may heat.
    pub ptc_allowed: bool,
    /// Electrical power of the compressor; 0 is off [W].
    pub compressor_power_w: f64,
    /// Recirculated share of the supply air [-].
    pub recirculation: f64,
    /// Blower level [-].
    pub blower_level: f64,
    /// Coolant flow of the HTC [kg/s].
    pub htc_flow_kg_s: f64,
    /// Coolant flow of the chiller circuit [kg/s].
    pub chiller_flow_kg_s: f64,
    /// Heat flow requested, by member [W].
    pub requests_w: [f64; 6],
    /// Valve position as a share of "open", by member [-].
    pub valves: [f64; 6],
    /// Cabin temperature for the PTC's PID [K].
    pub cabin_set_point_k: f64,
}

impl Default for Demand {
    /// Everything isolated and off, valves open, requests unlimited, 22 degC.
    fn default() -> Self {
        Self {
            connections: [Connection::Isolated; 6],
            ptc_allowed: false,
            compressor_power_w: 0.0,
            recirculation: 0.0,
            blower_level: 1.0,
            htc_flow_kg_s: 0.25,
            chiller_flow_kg_s: 0.25,
            requests_w: [MAXIMUM_REQUEST_W; 6],
            valves: [1.0; 6],
            cabin_set_point_k: 295.15,
        }
    }
}

/// Row of an actuator.
///
/// # Errors
/// There is none of that name.
pub fn actuator(name: &str) -> PlantResult<usize> {
    ACTUATORS.iter().position(|actuator| actuator.name == name).ok_or_else(|| PlantError::Unknown {
        kind: "actuator",
        name: name.to_owned(),
        available: ACTUATORS.map(|actuator| actuator.name).join(", "),
    })
}

/// Physical ranges of the actuators of one vehicle.
#[derive(Debug, Clone, PartialEq)]
pub struct ActuatorRanges {
    low: [f64; ACTUATOR_COUNT],
    high: [f64; ACTUATOR_COUNT],
    /// Physical values at -1 and between -1 and 1. An option lies in the middle of its part of the range: it is half a
    /// part away from its ends.
    origin: [f64; ACTUATOR_COUNT],
    width: [f64; ACTUATOR_COUNT],
    /// Natural logarithm of the compressor's highest over its lowest power.
    compressor_logarithm: f64,
}

impl ActuatorRanges {
    /// Ranges of a vehicle.
    #[must_use]
    pub fn of(vehicle: &VehicleParameters) -> Self {
        let compressor = &vehicle.refrigeration.compressor;
        let mut ranges = [(0.0, 1.0); ACTUATOR_COUNT];
        for (range, actuator) in ranges.iter_mut().zip(&ACTUATORS) {
            if let Scale::Choice(options) = actuator.scale {
                *range = (0.0, (options.len() - 1) as f64);
            }
        }
        ranges[COMPRESSOR] = (compressor.minimum_power_w, compressor.maximum_power_w);
        for (row, pump) in
            [(HTC_FLOW, &vehicle.htc.circuit.pump), (CHILLER_FLOW, &vehicle.chiller.circuit.pump)]
        {
            ranges[row] = (pump.minimum_flow_kg_s, pump.maximum_flow_kg_s);
        }
        for range in &mut ranges[REQUESTS..REQUESTS + 6] {
            *range = (0.0, MAXIMUM_REQUEST_W);
        }
        ranges[RECIRCULATION] = (0.0, vehicle.cabin.maximum_recirculation);
        ranges[CABIN_SET_POINT] = CABIN_SET_POINT_RANGE_K;
        let margin = |row: usize| if matches!(ACTUATORS[row].scale, Scale::Choice(_)) { 0.5 } else { 0.0 };
        Self {
            low: ranges.map(|(low, _)| low),
            high: ranges.map(|(_, high)| high),
            origin: std::array::from_fn(|row| ranges[row].0 - margin(row)),
            width: std::array::from_fn(|row| ranges[row].1 - ranges[row].0 + 2.0 * margin(row)),
            compressor_logarithm: (ranges[COMPRESSOR].1 / ranges[COMPRESSOR].0).ln(),
        }
    }

    /// Lowest and highest physical value of an actuator.
    #[must_use]
    pub fn range(&self, actuator: usize) -> (f64, f64) {
        (self.low[actuator], self.high[actuator])
    }

    /// Normalised value of a physical one; values outside the range are held at its ends.
    #[must_use]
    pub fn normalise(&self, actuator: usize, value: f64) -> f32 {
        match ACTUATORS[actuator].scale {
            Scale::OffThenLogarithmic => self.normalised_compressor(value),
            Scale::Choice(_) | Scale::Linear => {
                normalised(value, self.origin[actuator], self.width[actuator])
            }
        }
    }

    /// Physical value of a normalised one.
    #[must_use]
    pub fn physical(&self, actuator: usize, normalised: f32) -> f64 {
        let share = share(normalised);
        match ACTUATORS[actuator].scale {
            Scale::Choice(options) => chosen(share, options.len()) as f64,
            Scale::Linear => self.origin[actuator] + share * self.width[actuator],
            Scale::OffThenLogarithmic => self.compressor(normalised),
        }
    }

    fn normalised_compressor(&self, value: f64) -> f32 {
        let low = self.low[COMPRESSOR];
        if value < low {
            return -1.0;
        }
        let share = elementary::ln(value / low) / self.compressor_logarithm;
        (COMPRESSOR_OFF_BELOW + (1.0 - COMPRESSOR_OFF_BELOW) * share).clamp(-1.0, 1.0) as f32
    }

    fn compressor(&self, normalised: f32) -> f64 {
        let x = f64::from(normalised).clamp(-1.0, 1.0);
        // Half a single-precision step below the threshold still counts as the lowest power.
        if x < COMPRESSOR_OFF_BELOW - 1e-6 {
            return 0.0;
        }
        let share = ((x - COMPRESSOR_OFF_BELOW) / (1.0 - COMPRESSOR_OFF_BELOW)).max(0.0);
        self.low[COMPRESSOR] * elementary::exp(share * self.compressor_logarithm)
    }

    /// The command for a demand.
    #[must_use]
    pub fn encode(&self, demand: &Demand) -> Command {
        let mut values = [0.0; ACTUATOR_COUNT];
        for (i, member) in Member::ALL.into_iter().enumerate() {
            let asked = demand.connections[i];
            values[i] = member.options().iter().position(|&option| option == asked).unwrap_or(0) as f64;
        }
        values[PTC] = f64::from(u8::from(demand.ptc_allowed));
        values[RECIRCULATION] = demand.recirculation;
        values[BLOWER] = demand.blower_level;
        values[HTC_FLOW] = demand.htc_flow_kg_s;
        values[CHILLER_FLOW] = demand.chiller_flow_kg_s;
        values[REQUESTS..REQUESTS + 6].copy_from_slice(&demand.requests_w);
        values[VALVES..VALVES + 6].copy_from_slice(&demand.valves);
        values[CABIN_SET_POINT] = demand.cabin_set_point_k;
        // All rows alike, so that several are worked out at once; the compressor's is replaced.
        let mut command =
            std::array::from_fn(|row| normalised(values[row], self.origin[row], self.width[row]));
        command[COMPRESSOR] = self.normalised_compressor(demand.compressor_power_w);
        Command(command)
    }

    /// Sets one actuator of a command to a physical value.
    ///
    /// # Errors
    /// No such actuator, or a value outside its range.
    pub fn set(&self, command: &mut Command, name: &str, value: f64) -> PlantResult<()> {
        let row = actuator(name)?;
        let (low, high) = self.range(row);
        let off = ACTUATORS[row].scale == Scale::OffThenLogarithmic && value == 0.0;
        if !(off || (low..=high).contains(&value)) {
            let zero = if ACTUATORS[row].scale == Scale::OffThenLogarithmic { "0 (off) or " } else { "" };
            return Err(PlantError::InvalidArgument {
                what: name.to_owned(),
                value: value.to_string(),
                allowed: format!("must be {zero}between {low} and {high} {}", ACTUATORS[row].unit),
            });
        }
        command.0[row] = self.normalise(row, value);
        Ok(())
    }

    /// Sets one actuator of a command to an option.
    ///
    /// # Errors
    /// No such actuator or option, or the actuator has no options.
    pub fn choose(&self, command: &mut Command, name: &str, option: &str) -> PlantResult<()> {
        let row = actuator(name)?;
        let options = match ACTUATORS[row].scale {
            Scale::Choice(options) => options,
            Scale::Linear | Scale::OffThenLogarithmic => &[],
        };
        let chosen =
            options.iter().position(|known| *known == option).ok_or_else(|| PlantError::InvalidArgument {
                what: name.to_owned(),
                value: format!("`{option}`"),
                allowed: if options.is_empty() {
                    format!("must be a number of {}", ACTUATORS[row].unit)
                } else {
                    format!("must be one of {}", options.join(", "))
                },
            })?;
        command.0[row] = self.normalise(row, chosen as f64);
        Ok(())
    }

    /// The demand that a command stands for.
    #[must_use]
    pub fn decode(&self, command: &Command) -> Demand {
        let shares = command.0.map(share);
        let values: [f64; ACTUATOR_COUNT] =
            std::array::from_fn(|row| self.origin[row] + shares[row] * self.width[row]);
        Demand {
            connections: std::array::from_fn(|i| {
                let options = Member::ALL[i].options();
                options[chosen(shares[i], options.len())]
            }),
            ptc_allowed: chosen(shares[PTC], 2) == 1,
            compressor_power_w: self.compressor(command.0[COMPRESSOR]),
            recirculation: values[RECIRCULATION],
            blower_level: values[BLOWER],
            htc_flow_kg_s: values[HTC_FLOW],
            chiller_flow_kg_s: values[CHILLER_FLOW],
            requests_w: std::array::from_fn(|i| values[REQUESTS + i]),
            valves: std::array::from_fn(|i| values[VALVES + i]),
            cabin_set_point_k: values[CABIN_SET_POINT],
        }
    }
}

/// Normalised value of a physical one that is `origin` at -1 and `width` more at 1.
#[inline]
fn normalised(value: f64, origin: f64, width: f64) -> f32 {
    (2.0 * (value - origin) / width - 1.0).clamp(-1.0, 1.0) as f32
}

/// Position of a normalised value between -1 and 1.
#[inline]
fn share(normalised: f32) -> f64 {
    0.5 * (f64::from(normalised).clamp(-1.0, 1.0) + 1.0)
}

/// Option that a position between 0 and 1 lies in.
#[inline]
fn chosen(share: f64, options: usize) -> usize {
    ((share * options as f64) as usize).min(options - 1)
}
