//! The one way in: what any controller, rule-based, scheduled or learned, tells the plant.
//!
//! A command is a row of single-precision numbers in `[-1, 1]`, one for each actuator of the architecture's layout. The
//! HPCU, schedules and agents all write this form, so none of them has a path of its own and runs with any of
//! them can be repeated bit for bit.

pub use crate::architecture::layout::ACTUATOR_PLACES;
use crate::architecture::layout::Layout;
pub use crate::architecture::rows::{ActuatorRow, Purpose, Scale};
use crate::config::vehicle::VehicleParameters;
use crate::error::{PlantError, PlantResult};
use crate::numerics::elementary;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::ops::{Index, IndexMut};
use std::sync::Arc;

/// Largest heat flow that can be requested of a connection [W].
pub const MAXIMUM_REQUEST_W: f64 = 20_000.0;

/// Normalised compressor demand below which the compressor is off.
const COMPRESSOR_OFF_BELOW: f64 = -0.9;

/// Lowest and highest cabin set point that can be commanded [K].
const CABIN_SET_POINT_RANGE_K: (f64, f64) = (283.15, 303.15);

/// Option of a connection that leaves a member to itself.
pub const ISOLATED: f64 = 0.0;

/// A command as it crosses every interface: normalised, single precision; places without an actuator are 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command(pub [f32; ACTUATOR_PLACES]);

impl Default for Command {
    fn default() -> Self {
        Self([0.0; ACTUATOR_PLACES])
    }
}

/// Without the zeros at the end.
impl Serialize for Command {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let used = self.0.iter().rposition(|&value| value != 0.0).map_or(0, |last| last + 1);
        self.0[..used].serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Command {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let values = Vec::<f32>::deserialize(deserializer)?;
        let mut command = Self::default();
        let Some(used) = command.0.get_mut(..values.len()) else {
            return Err(D::Error::custom(format!(
                "{} actuators, but there are {ACTUATOR_PLACES}",
                values.len()
            )));
        };
        used.copy_from_slice(&values);
        Ok(command)
    }
}

/// A command in physical units, a value a row; an option is its number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Demand(pub [f64; ACTUATOR_PLACES]);

impl Index<usize> for Demand {
    type Output = f64;
    #[inline(always)]
    fn index(&self, row: usize) -> &f64 {
        &self.0[row]
    }
}

impl IndexMut<usize> for Demand {
    #[inline(always)]
    fn index_mut(&mut self, row: usize) -> &mut f64 {
        &mut self.0[row]
    }
}

/// The actuators of one vehicle with their physical ranges.
#[derive(Debug, Clone, PartialEq)]
pub struct ActuatorRanges {
    layout: Arc<Layout>,
    low: [f64; ACTUATOR_PLACES],
    high: [f64; ACTUATOR_PLACES],
    /// Physical values at -1 and between -1 and 1. An option lies in the middle of its part of the range: it is half a
    /// part away from its ends.
    origin: [f64; ACTUATOR_PLACES],
    width: [f64; ACTUATOR_PLACES],
    /// Whether a value is the number of an option.
    chosen: [bool; ACTUATOR_PLACES],
    /// The same as what is taken of a value's fraction, what is added then, and what it does not exceed: no branches.
    whole: [f64; ACTUATOR_PLACES],
    start: [f64; ACTUATOR_PLACES],
    last: [f64; ACTUATOR_PLACES],
    /// Natural logarithm of the compressor's highest over its lowest power.
    compressor_logarithm: f64,
}

/// Lowest and highest physical value of an actuator of a vehicle.
fn range(vehicle: &VehicleParameters, row: &ActuatorRow) -> (f64, f64) {
    match row.purpose {
        Purpose::Connection(_) | Purpose::Heater(_) | Purpose::ExchangerValve(_) => {
            (0.0, (row.options().len() - 1) as f64)
        }
        Purpose::Compressor => vehicle.refrigeration.as_ref().map_or((1.0, 1.0), |refrigeration| {
            (refrigeration.compressor.minimum_power_w, refrigeration.compressor.maximum_power_w)
        }),
        Purpose::Recirculation(cabin) => (0.0, vehicle.cabins[cabin].parameters.maximum_recirculation),
        Purpose::Blower(_) | Purpose::Windscreen(_) | Purpose::Valve(_) => (0.0, 1.0),
        Purpose::LoopFlow(circuit) => {
            let pump = &vehicle.loops[circuit].circuit.pump;
            (pump.minimum_flow_kg_s, pump.maximum_flow_kg_s)
        }
        Purpose::Request(_) => (0.0, MAXIMUM_REQUEST_W),
        Purpose::CabinSetPoint => CABIN_SET_POINT_RANGE_K,
    }
}

impl ActuatorRanges {
    /// Actuators of a vehicle.
    #[must_use]
    pub fn of(vehicle: &VehicleParameters) -> Self {
        let layout = Arc::clone(&vehicle.layout);
        let mut ranges = Self {
            low: [0.0; ACTUATOR_PLACES],
            high: [0.0; ACTUATOR_PLACES],
            // Where there is no actuator, 0 stands for 0.
            origin: [-0.5; ACTUATOR_PLACES],
            width: [1.0; ACTUATOR_PLACES],
            chosen: [false; ACTUATOR_PLACES],
            whole: [0.0; ACTUATOR_PLACES],
            start: [-0.5; ACTUATOR_PLACES],
            last: [f64::INFINITY; ACTUATOR_PLACES],
            compressor_logarithm: 0.0,
            layout: Arc::clone(&layout),
        };
        for (row, actuator) in layout.actuators.iter().enumerate() {
            let (low, high) = range(vehicle, actuator);
            ranges.chosen[row] = matches!(actuator.scale, Scale::Choice(_));
            let half = if ranges.chosen[row] { 0.5 } else { 0.0 };
            (ranges.low[row], ranges.high[row]) = (low, high);
            (ranges.whole[row], ranges.start[row], ranges.last[row]) =
                if ranges.chosen[row] { (1.0, 0.0, high) } else { (0.0, low, f64::INFINITY) };
            ranges.origin[row] = low - half;
            // A range of one value has a width too, or nothing could be divided by it.
            ranges.width[row] = (high - low + 2.0 * half).max(f64::MIN_POSITIVE);
            if actuator.scale == Scale::OffThenLogarithmic {
                ranges.compressor_logarithm = (high / low).ln();
            }
        }
        ranges
    }

    /// The actuators, a row each.
    #[must_use]
    pub fn rows(&self) -> &[ActuatorRow] {
        &self.layout.actuators
    }

    /// Number of actuators.
    #[must_use]
    pub fn count(&self) -> usize {
        self.layout.actuators.len()
    }

    /// Row of an actuator.
    ///
    /// # Errors
    /// There is none of that name.
    pub fn row(&self, name: &str) -> PlantResult<usize> {
        self.layout.actuator(name).ok_or_else(|| PlantError::Unknown {
            kind: "actuator",
            name: name.to_owned(),
            available: self.rows().iter().map(|row| row.name.as_str()).collect::<Vec<_>>().join(", "),
        })
    }

    /// Lowest and highest physical value of an actuator.
    #[must_use]
    pub fn range(&self, actuator: usize) -> (f64, f64) {
        (self.low[actuator], self.high[actuator])
    }

    fn is_compressor(&self, actuator: usize) -> bool {
        self.layout.compressor_row == Some(actuator)
    }

    /// Normalised value of a physical one; values outside the range are held at its ends.
    #[must_use]
    pub fn normalise(&self, actuator: usize, value: f64) -> f32 {
        if self.is_compressor(actuator) {
            self.normalised_compressor(actuator, value)
        } else {
            normalised(value, self.origin[actuator], self.width[actuator])
        }
    }

    /// Physical value of a normalised one; an option is its number.
    #[must_use]
    pub fn physical(&self, actuator: usize, normalised: f32) -> f64 {
        if self.is_compressor(actuator) {
            return self.compressor(actuator, normalised);
        }
        let value = share(normalised) * self.width[actuator];
        if self.chosen[actuator] { option(value, self.high[actuator]) } else { self.origin[actuator] + value }
    }

    fn normalised_compressor(&self, row: usize, value: f64) -> f32 {
        let low = self.low[row];
        if value < low {
            return -1.0;
        }
        let share = elementary::ln(value / low) / self.compressor_logarithm;
        (COMPRESSOR_OFF_BELOW + (1.0 - COMPRESSOR_OFF_BELOW) * share).clamp(-1.0, 1.0) as f32
    }

    fn compressor(&self, row: usize, normalised: f32) -> f64 {
        let x = f64::from(normalised).clamp(-1.0, 1.0);
        // Half a single-precision step below the threshold still counts as the lowest power.
        if x < COMPRESSOR_OFF_BELOW - 1e-6 {
            return 0.0;
        }
        let share = ((x - COMPRESSOR_OFF_BELOW) / (1.0 - COMPRESSOR_OFF_BELOW)).max(0.0);
        self.low[row] * elementary::exp(share * self.compressor_logarithm)
    }

    /// Everything isolated, closed and off, valves of branches open, requests unlimited, 22 degC.
    #[must_use]
    pub fn idle(&self) -> Demand {
        let mut demand = Demand([0.0; ACTUATOR_PLACES]);
        for (row, actuator) in self.rows().iter().enumerate() {
            demand[row] = match actuator.purpose {
                Purpose::Blower(_) | Purpose::Valve(_) => 1.0,
                Purpose::LoopFlow(_) => 0.25,
                Purpose::Request(_) => MAXIMUM_REQUEST_W,
                Purpose::CabinSetPoint => 295.15,
                _ => 0.0,
            };
        }
        demand
    }

    /// The command for a demand.
    #[must_use]
    #[inline]
    pub fn encode(&self, demand: &Demand) -> Command {
        // All rows alike, so that several are worked out at once; the compressor's is replaced.
        let mut command = Command::default();
        for row in 0..self.count() {
            command.0[row] = normalised(demand.0[row], self.origin[row], self.width[row]);
        }
        if let Some(row) = self.layout.compressor_row {
            command.0[row] = self.normalised_compressor(row, demand[row]);
        }
        command
    }

    /// The demand that a command stands for.
    #[must_use]
    pub fn decode(&self, command: &Command) -> Demand {
        self.decoded(command, self.count(), self.layout.compressor_row)
    }

    /// [`Self::decode`] for so many actuators, perhaps known while compiling.
    #[inline(always)]
    pub(crate) fn decoded(&self, command: &Command, count: usize, compressor_row: Option<usize>) -> Demand {
        let mut demand = Demand([0.0; ACTUATOR_PLACES]);
        for row in 0..count.next_multiple_of(4).min(ACTUATOR_PLACES) {
            let value = share(command.0[row]) * self.width[row];
            let value = value - self.whole[row] * (value - value.floor());
            demand.0[row] = self.start[row] + value.min(self.last[row]);
        }
        if let Some(row) = compressor_row {
            demand.0[row] = self.compressor(row, command.0[row]);
        }
        demand
    }

    /// Sets one actuator of a command to a physical value.
    ///
    /// # Errors
    /// No such actuator, or a value outside its range.
    pub fn set(&self, command: &mut Command, name: &str, value: f64) -> PlantResult<()> {
        let row = self.row(name)?;
        let (low, high) = self.range(row);
        let off = self.is_compressor(row) && value == 0.0;
        if !(off || (low..=high).contains(&value)) {
            let zero = if self.is_compressor(row) { "0 (off) or " } else { "" };
            return Err(PlantError::InvalidArgument {
                what: name.to_owned(),
                value: value.to_string(),
                allowed: format!("must be {zero}between {low} and {high} {}", self.rows()[row].unit),
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
        let row = self.row(name)?;
        let options = self.rows()[row].options();
        let chosen =
            options.iter().position(|known| known == option).ok_or_else(|| PlantError::InvalidArgument {
                what: name.to_owned(),
                value: format!("`{option}`"),
                allowed: if options.is_empty() {
                    format!("must be a number of {}", self.rows()[row].unit)
                } else {
                    format!("must be one of {}", options.join(", "))
                },
            })?;
        command.0[row] = self.normalise(row, chosen as f64);
        Ok(())
    }
}

/// Normalised value of a physical one that is `origin` at -1 and `width` more at 1.
#[inline(always)]
fn normalised(value: f64, origin: f64, width: f64) -> f32 {
    (2.0 * (value - origin) / width - 1.0).clamp(-1.0, 1.0) as f32
}

/// Position of a normalised value between -1 and 1.
#[inline(always)]
fn share(normalised: f32) -> f64 {
    0.5 * (f64::from(normalised).clamp(-1.0, 1.0) + 1.0)
}

/// Number of the option that a value lies in.
#[inline(always)]
fn option(value: f64, last: f64) -> f64 {
    value.floor().min(last)
}
