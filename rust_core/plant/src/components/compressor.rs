//! Electrically driven scroll compressor: efficiencies and operating envelope.
//!
//! The shape of the efficiencies follows published scroll data for R134a (Cuevas et al., Applied Thermal
//! Engineering 30 (2010) 605: isentropic peak 0.72 near pressure ratio 2.5, volumetric efficiency falling by
//! 0.02 per unit of pressure ratio). Leakage with a constant gap is ours: it makes low speeds unattractive.

use crate::numerics::dual::Real;
use crate::numerics::elementary;
use crate::parameters;
use serde::{Deserialize, Serialize};

parameters! {
    /// Electrically driven scroll compressor.
    pub struct CompressorParameters {
        /// Displacement [cm3/rev].
        displacement_cm3: f64 = 5.0 .. 200.0,
        /// Lowest continuous speed [rev/s].
        minimum_speed_rev_s: f64 = 1.0 .. 100.0,
        /// Highest speed [rev/s].
        maximum_speed_rev_s: f64 = 20.0 .. 400.0,
        /// Largest change of speed [rev/s per s].
        speed_ramp_rev_s2: f64 = 0.1 .. 1000.0,
        /// Largest electrical power [W].
        maximum_power_w: f64 = 100.0 .. 20000.0,
        /// Smallest power demand that counts as "on" [W]; the lower end of the demand scale.
        minimum_power_w: f64 = 10.0 .. 2000.0,
        /// Shortest time on [s].
        minimum_on_time_s: f64 = 0.0 .. 600.0,
        /// Shortest time off [s].
        minimum_off_time_s: f64 = 0.0 .. 600.0,
        /// Electrical energy lost at each start (pressure equalisation, spin-up) [J].
        start_loss_j: f64 = 0.0 .. 100000.0,
        /// Discharge gas temperature that must not be exceeded [degC].
        maximum_discharge_temperature_degc: f64 = 60.0 .. 150.0,
        /// Volumetric efficiency extrapolated to pressure ratio 1, without leakage [-].
        volumetric_efficiency_at_unity: f64 = 0.5 .. 1.1,
        /// Relative loss of volumetric efficiency per unit of pressure ratio [-].
        volumetric_efficiency_slope: f64 = 0.0 .. 0.2,
        /// Gas that leaks back per delivered gas at the lowest speed and pressure ratio 2 [-].
        leakage_share: f64 = 0.0 .. 0.5,
        /// Peak isentropic efficiency, without leakage [-].
        isentropic_efficiency_peak: f64 = 0.2 .. 0.95,
        /// Pressure ratio of the peak [-].
        isentropic_peak_pressure_ratio: f64 = 1.2 .. 8.0,
        /// Extra work with the squared logarithm of the pressure ratio over the peak's [-].
        isentropic_pressure_ratio_loss: f64 = 0.0 .. 2.0,
        /// Extra work with the squared distance of relative speed from half of maximum speed [-].
        isentropic_speed_loss: f64 = 0.0 .. 4.0,
        /// Efficiency of compressor motor and inverter [-].
        electrical_efficiency: f64 = 0.3 .. 1.0,
        /// Share of the loss of motor and inverter that heats the gas; the rest leaves to ambient [-].
        loss_to_gas_share: f64 = 0.0 .. 1.0,
        /// Time constant with which the power comes in after a start, while refrigerant and oil find their places [s]; 0: at once.
        settling_time_s: f64 = 0.0 .. 300.0,
        /// Time constant with which that is lost again at rest [s].
        migration_time_s: f64 = 1.0 .. 3600.0,
        /// Lowest pressure ratio at which the machine compresses [-].
        minimum_pressure_ratio: f64 = 1.05 .. 2.0,
    }
}

/// Pressure ratio minus one below which the efficiencies flatten; outside what the machine may do.
const PRESSURE_RATIO_KNEE: f64 = 0.02;

/// Share from which on a machine counts as settled, after seven time constants.
const SETTLED_SHARE: f64 = 0.999;

/// Time over which the loss of a start is drawn [s]; a step shorter than this takes its share.
const START_DURATION_S: f64 = 1.0;

/// Smooth positive continuation: `x` above `knee`, an exponential with the same value and slope below.
#[inline]
pub fn soft_floor<T: Real>(x: T, knee: f64) -> T {
    if x.value() >= knee {
        return x;
    }
    let tail = knee * elementary::exp(x.value() / knee - 1.0);
    x.chain(tail, tail / knee)
}

/// What the machine makes of a pressure ratio and a speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompressorEfficiency<T> {
    /// Delivered volume at suction density per displaced volume [-].
    pub volumetric: T,
    /// Isentropic work per work done on the delivered gas [-].
    pub isentropic: T,
}

impl CompressorParameters {
    /// Displacement [m3/rev].
    #[must_use]
    pub fn displacement_m3(&self) -> f64 {
        self.displacement_cm3 * 1e-6
    }

    /// Efficiencies at a pressure ratio and a speed in rev/s.
    ///
    /// Leaked gas returns to the suction side and is compressed again: it divides both efficiencies alike.
    /// Its volume flow is that of a fixed gap, `sqrt(2 dp / rho)`, written so that it is smooth at ratio 1.
    #[inline]
    pub fn efficiency<T: Real>(&self, pressure_ratio: T, speed_rev_s: T) -> CompressorEfficiency<T> {
        let excess = soft_floor(pressure_ratio - 1.0, PRESSURE_RATIO_KNEE);
        let ratio = excess + 1.0;
        let gap_flow = excess / (ratio * 0.5).sqrt();
        let leakage = gap_flow * (self.leakage_share * self.minimum_speed_rev_s) / speed_rev_s + 1.0;
        let from_peak = (ratio / self.isentropic_peak_pressure_ratio).ln();
        let from_middle = speed_rev_s / self.maximum_speed_rev_s - 0.5;
        let extra_work = from_peak * from_peak * self.isentropic_pressure_ratio_loss
            + from_middle * from_middle * self.isentropic_speed_loss
            + 1.0;
        let filling =
            (excess * -self.volumetric_efficiency_slope).exp() * self.volumetric_efficiency_at_unity;
        CompressorEfficiency {
            volumetric: filling / leakage,
            isentropic: (extra_work * leakage).recip() * self.isentropic_efficiency_peak,
        }
    }
}

/// Memory of the operating envelope.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CompressorState {
    /// Turning.
    pub running: bool,
    /// Time since the last start or stop [s].
    pub time_in_state_s: f64,
    /// Speed at the end of the last step [rev/s].
    pub speed_rev_s: f64,
    /// How far refrigerant and oil have found their places since the start [-].
    pub settled_share: f64,
    /// Part of the start loss that is still to be drawn [J].
    pub start_loss_remaining_j: f64,
    /// Starts so far.
    pub starts: u32,
    /// Stops so far that a limit forced, not the demand.
    pub protection_trips: u32,
}

impl CompressorState {
    /// Parked for long: a start is not delayed.
    #[must_use]
    pub fn parked() -> Self {
        Self {
            running: false,
            time_in_state_s: 86_400.0,
            speed_rev_s: 0.0,
            settled_share: 0.0,
            start_loss_remaining_j: 0.0,
            starts: 0,
            protection_trips: 0,
        }
    }

    /// Power that the start loss takes in the next step, were the machine started now [W].
    #[must_use]
    pub fn start_loss_w(&self, parameters: &CompressorParameters, step_s: f64) -> f64 {
        let pending_j = if self.running { self.start_loss_remaining_j } else { parameters.start_loss_j };
        (parameters.start_loss_j / START_DURATION_S).min(pending_j / step_s)
    }

    /// Off for long enough to start again.
    #[must_use]
    pub fn rested(&self, parameters: &CompressorParameters) -> bool {
        !self.running && self.time_in_state_s >= parameters.minimum_off_time_s - TIME_TOLERANCE_S
    }

    /// Running, and not yet for long enough to stop because of a low demand.
    #[must_use]
    pub fn held_on(&self, parameters: &CompressorParameters) -> bool {
        self.running && self.time_in_state_s < parameters.minimum_on_time_s - TIME_TOLERANCE_S
    }

    /// Share of the demanded power that a machine that turns may take at the end of a step [-].
    #[must_use]
    #[inline]
    pub fn power_share(&self, parameters: &CompressorParameters, step_s: f64) -> f64 {
        let share = approached(self.settled_share, 1.0, step_s, parameters.settling_time_s);
        if share < SETTLED_SHARE { share } else { 1.0 }
    }

    /// Highest speed at the end of a step of `step_s` [rev/s].
    ///
    /// A start reaches minimum speed at once. Slowing down is not limited: the demand is a cap.
    #[must_use]
    pub fn speed_limit_rev_s(&self, parameters: &CompressorParameters, step_s: f64) -> f64 {
        let from = self.speed_rev_s.max(parameters.minimum_speed_rev_s);
        (from + parameters.speed_ramp_rev_s2 * step_s).min(parameters.maximum_speed_rev_s)
    }

    /// Enters the outcome of a step; returns the mean power that the start loss takes in it [W].
    ///
    /// `speed_rev_s` is `None` for a machine at rest; `forced` tells that a limit, not the demand, stopped it.
    pub fn advance(
        &mut self,
        parameters: &CompressorParameters,
        speed_rev_s: Option<f64>,
        forced: bool,
        step_s: f64,
    ) -> f64 {
        let running = speed_rev_s.is_some();
        self.settled_share = if running {
            self.power_share(parameters, step_s)
        } else {
            approached(self.settled_share, 0.0, step_s, parameters.migration_time_s)
        };
        if running != self.running {
            self.time_in_state_s = 0.0;
            if running {
                self.starts += 1;
                self.start_loss_remaining_j += parameters.start_loss_j;
            } else {
                self.protection_trips += u32::from(forced);
            }
        }
        self.running = running;
        self.speed_rev_s = speed_rev_s.unwrap_or(0.0);
        self.time_in_state_s += step_s;
        let drawn_j = (parameters.start_loss_j * step_s / START_DURATION_S).min(self.start_loss_remaining_j);
        // What round-off leaves over is drawn with the last share.
        let rest_j = self.start_loss_remaining_j - drawn_j;
        let drawn_j =
            if rest_j < 1e-9 * parameters.start_loss_j { self.start_loss_remaining_j } else { drawn_j };
        self.start_loss_remaining_j -= drawn_j;
        drawn_j / step_s
    }
}

/// What is left of the way from one value to another after a time; a time constant of 0 leaves nothing.
#[inline]
fn approached(from: f64, to: f64, time_s: f64, time_constant_s: f64) -> f64 {
    if time_constant_s <= 0.0 { to } else { to + (from - to) * elementary::exp(-time_s / time_constant_s) }
}

/// Sums of step lengths meet the minimum times within this [s].
const TIME_TOLERANCE_S: f64 = 1e-6;
