//! Finds the highest compressor speed that respects every limit, with both exchangers in balance.
//!
//! Newton on evaporating temperature, condensing temperature and speed. The third equation is the least of the margins
//! that all limits leave, so the limit that holds the compressor back is found together with the solution. The
//! discharge temperature comes after that: its margin does not fall with speed everywhere. What Newton does not
//! solve is bracketed over speed, see [`Solver::bracketed`].

use std::cell::Cell;

use serde::{Deserialize, Serialize};

use super::refrigeration_cycle::{CoolantSides, CyclePoint, RefrigerationCycle};
use crate::numerics::dual::{Real, variables};
use crate::numerics::root::{bracketed_root, expand, maximum};
use crate::numerics::three_equations::{Inverse, largest};

/// Largest balance error [K] or scaled limit error of a solution.
const RESIDUAL_TOLERANCE: f64 = 1e-8;
/// Error below which further steps use the derivatives at hand, as long as each leaves at most a share of the error.
const CHORD_ERROR: f64 = 0.3;
const CHORD_SHARE: f64 = 0.03;
/// How far a limit may be missed, in its scaled unit (see [`Scales`]; 1 K of discharge temperature).
const LIMIT_TOLERANCE: f64 = 1e-6;
/// Residual above which a problem counts as not solved; bracketing reaches what round-off lets it.
pub(super) const UNSOLVED: f64 = 1e-5;
const MAX_NEWTON_ITERATIONS: u32 = 25;
/// Longest Newton step of a temperature [K].
const MAX_TEMPERATURE_STEP_K: f64 = 10.0;
/// Largest factor by which one Newton step changes speed.
const MAX_SPEED_FACTOR: f64 = 3.0;
/// Errors of limits are scaled with this share of what lies between standstill and the limit.
const SCALE_SHARE: f64 = 0.01;
/// Smallest room that counts for the scale [W or K].
const SMALLEST_ROOM: f64 = 1.0;

/// What holds the compressor back.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Limit {
    /// The power that is demanded or allowed.
    #[default]
    Power,
    /// The highest speed, or what the ramp lets it be.
    Speed,
    /// The lowest speed, during the minimum time on.
    MinimumSpeed,
    /// Highest condensing pressure.
    Pressure,
    /// Lowest suction pressure.
    Suction,
    /// Hot coolant supply at its highest temperature.
    HotCoolant,
    /// Cold coolant supply at its lowest temperature.
    ColdCoolant,
    /// Highest discharge gas temperature.
    Discharge,
    /// A coolant stands still (or an input is not a finite number).
    CoolantFlow,
}

/// Limits that stop the machine if they are exceeded at minimum speed. Less speed always relieves them.
const PROTECTIONS: [Limit; 4] = [Limit::Pressure, Limit::Suction, Limit::HotCoolant, Limit::ColdCoolant];

/// All limits whose margin falls with speed.
const CAPS: [Limit; 6] =
    [Limit::Power, Limit::Speed, Limit::Pressure, Limit::Suction, Limit::HotCoolant, Limit::ColdCoolant];

/// Coolant supply temperature at the end of the step as a function of the exchanger's heat flow.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct SupplyLimit {
    /// Supply temperature at the end of the step without any heat flow [K].
    pub base_k: f64,
    /// Change per heat flow, positive on both sides [K/W].
    pub sensitivity_k_w: f64,
    /// Temperature that must not be passed [K].
    pub limit_k: f64,
}

/// Start values for Newton: where the solution is expected.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WarmStart {
    /// Evaporating temperature [K].
    pub evaporating_k: f64,
    /// Condensing temperature [K].
    pub condensing_k: f64,
    /// Speed [rev/s].
    pub speed_rev_s: f64,
}

/// What makes margins comparable: reciprocals of [`SCALE_SHARE`] of what lies between standstill and each limit.
///
/// Power, heat flows and temperature differences all rise about with speed, so a margin is about the change of speed, in
/// per cent, that is left. In other units, kelvin beside watt, the least margin could belong to a limit that is far
/// away, and Newton would jump to and fro between two limits.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scales {
    per_power_w: f64,
    per_speed_rev_s: f64,
    per_minimum_speed_rev_s: f64,
    per_pressure_k: f64,
    per_suction_k: f64,
    per_hot_supply_k: f64,
    per_cold_supply_k: f64,
}

impl Scales {
    pub fn of(
        cycle: &RefrigerationCycle,
        sides: &CoolantSides,
        (hot_supply, cold_supply): (&SupplyLimit, &SupplyLimit),
        (power_limit_w, speed_limit_rev_s): (f64, f64),
    ) -> Self {
        let per = |limit: f64| (SCALE_SHARE * limit).recip();
        let per_room = |room: f64| per(room.max(SMALLEST_ROOM));
        Self {
            per_power_w: per_room(power_limit_w),
            per_speed_rev_s: per(speed_limit_rev_s),
            per_minimum_speed_rev_s: per(cycle.parameters.compressor.minimum_speed_rev_s),
            per_pressure_k: per_room(cycle.highest_condensing_k - sides.hot_inlet_k),
            per_suction_k: per_room(sides.cold_inlet_k - cycle.lowest_evaporating_k),
            per_hot_supply_k: per_room(hot_supply.limit_k - hot_supply.base_k),
            per_cold_supply_k: per_room(cold_supply.base_k - cold_supply.limit_k),
        }
    }
}

/// One problem.
pub(super) struct Solver<'a> {
    pub cycle: &'a RefrigerationCycle,
    pub sides: CoolantSides,
    pub hot_supply: SupplyLimit,
    pub cold_supply: SupplyLimit,
    pub power_limit_w: f64,
    pub speed_limit_rev_s: f64,
    /// What makes margins comparable.
    pub scales: Scales,
    /// Run at minimum speed although power allows less.
    pub hold: bool,
    pub iterations: Cell<u32>,
    pub bracketed: bool,
}

/// The cycle in balance, with what holds the compressor back.
#[derive(Debug, Clone, Copy)]
pub(super) struct Running {
    pub point: CyclePoint<f64>,
    pub limit: Limit,
    /// Gas temperature at the compressor outlet [K].
    pub discharge_k: f64,
    /// Largest error of all equations: both balances [K], and the margin of the limit in its scaled unit.
    pub residual: f64,
}

/// A solution, or the limit that keeps the machine off.
pub(super) type Solution = Result<Running, Limit>;

/// What closes the equations besides the two balances.
#[derive(Clone, Copy)]
enum Closure {
    /// The first of all caps is met or, where one of them is exceeded at minimum speed, that speed.
    Caps,
    /// The discharge limit is met.
    Discharge,
    /// The speed is given [rev/s].
    AtSpeed(f64),
}

impl Solver<'_> {
    fn minimum_speed(&self) -> f64 {
        self.cycle.parameters.compressor.minimum_speed_rev_s
    }

    /// Room left below a limit in its scaled unit; negative where it is exceeded.
    fn margin<T: Real>(&self, limit: Limit, point: &CyclePoint<T>) -> T {
        match limit {
            Limit::Power => (-point.electric_w + self.power_limit_w) * self.scales.per_power_w,
            Limit::Speed | Limit::CoolantFlow => {
                (-point.speed_rev_s + self.speed_limit_rev_s) * self.scales.per_speed_rev_s
            }
            Limit::MinimumSpeed => {
                (-point.speed_rev_s + self.minimum_speed()) * self.scales.per_minimum_speed_rev_s
            }
            Limit::Pressure => {
                (-point.condensing_k + self.cycle.highest_condensing_k) * self.scales.per_pressure_k
            }
            Limit::Suction => {
                (point.evaporating_k - self.cycle.lowest_evaporating_k) * self.scales.per_suction_k
            }
            Limit::HotCoolant => {
                let SupplyLimit { base_k, sensitivity_k_w, limit_k } = self.hot_supply;
                (-(point.condenser_w * sensitivity_k_w) + (limit_k - base_k)) * self.scales.per_hot_supply_k
            }
            Limit::ColdCoolant => {
                let SupplyLimit { base_k, sensitivity_k_w, limit_k } = self.cold_supply;
                (-(point.evaporator_w * sensitivity_k_w) + (base_k - limit_k)) * self.scales.per_cold_supply_k
            }
            Limit::Discharge => -self.cycle.discharge_k(point) + self.cycle.highest_discharge_k,
        }
    }

    /// Errors of both balances and of the equation that closes them; 0 at the solution.
    #[inline]
    fn errors<T: Real>(&self, closure: Closure, point: &CyclePoint<T>) -> [T; 3] {
        let third = match closure {
            Closure::Caps => {
                let [first, others @ ..] = CAPS.map(|limit| self.margin(limit, point));
                let least = others.into_iter().fold(first, Real::min);
                // Less than no margin at minimum speed stays there.
                least.max(self.margin(Limit::MinimumSpeed, point))
            }
            Closure::Discharge => self.margin(Limit::Discharge, point),
            Closure::AtSpeed(speed) => (-point.speed_rev_s + speed) / (SCALE_SHARE * speed),
        };
        [point.cold_residual_k, point.hot_residual_k, third]
    }

    fn running(&self, point: CyclePoint<f64>, limit: Limit) -> Running {
        let margin = self.margin(limit, &point);
        let residual = largest([point.cold_residual_k, point.hot_residual_k, margin]);
        Running { discharge_k: self.cycle.discharge_k(&point), point, limit, residual }
    }

    /// The most exceeded of the limits, with its margin.
    fn tightest(&self, limits: &[Limit], point: &CyclePoint<f64>) -> (Limit, f64) {
        let mut tightest = (limits[0], f64::INFINITY);
        for &limit in limits {
            let margin = self.margin(limit, point);
            if margin < tightest.1 {
                tightest = (limit, margin);
            }
        }
        tightest
    }

    /// The solution with the highest speed that respects all limits.
    pub fn solve(&mut self, warm: Option<&WarmStart>) -> Solution {
        let protected = [
            (Limit::Pressure, self.cycle.highest_condensing_k - self.sides.hot_inlet_k),
            (Limit::Suction, self.sides.cold_inlet_k - self.cycle.lowest_evaporating_k),
            (Limit::HotCoolant, self.hot_supply.limit_k - self.hot_supply.base_k),
            (Limit::ColdCoolant, self.cold_supply.base_k - self.cold_supply.limit_k),
        ];
        if let Some((limit, _)) = protected.into_iter().find(|(_, room)| *room <= 0.0) {
            return Err(limit);
        }
        if self.speed_limit_rev_s < self.minimum_speed() * (1.0 - LIMIT_TOLERANCE) {
            return Err(Limit::Speed);
        }
        let start = self.start(warm);
        match self.direct(start) {
            Some(solution) => solution,
            None => self.bracketed(start),
        }
    }

    /// By Newton; `None` where bracketing has to decide.
    fn direct(&self, start: [f64; 3]) -> Option<Solution> {
        let point = self.newton(Closure::Caps, start)?;
        if point.speed_rev_s <= self.minimum_speed() * (1.0 + LIMIT_TOLERANCE)
            && let Some(verdict) = self.at_minimum_speed(&point)
        {
            return Some(verdict);
        }
        let running = self.running(point, self.tightest(&CAPS, &point).0);
        if running.discharge_k <= self.cycle.highest_discharge_k + LIMIT_TOLERANCE {
            return Some(Ok(running));
        }
        let point = self.newton(Closure::Discharge, point.unknowns())?;
        let allowed = point.speed_rev_s >= self.minimum_speed() * (1.0 - LIMIT_TOLERANCE)
            && self.tightest(&CAPS, &point).1 >= -LIMIT_TOLERANCE
            && self.relieved_by_less_speed(point.unknowns());
        allowed.then(|| Ok(self.running(point, Limit::Discharge)))
    }

    /// What minimum speed means for the machine; `None` where more speed is possible or discharge decides.
    fn at_minimum_speed(&self, point: &CyclePoint<f64>) -> Option<Solution> {
        let exceeds_power = self.margin(Limit::Power, point) < -LIMIT_TOLERANCE;
        let (protection, margin) = self.tightest(&PROTECTIONS, point);
        if exceeds_power && !self.hold {
            Some(Err(Limit::Power))
        } else if margin < -LIMIT_TOLERANCE {
            Some(Err(protection))
        } else if !exceeds_power {
            None
        } else if self.margin(Limit::Discharge, point) < -LIMIT_TOLERANCE {
            Some(Err(Limit::Discharge))
        } else {
            Some(Ok(self.running(*point, Limit::MinimumSpeed)))
        }
    }

    /// Leakage makes the gas hot at low speed too, so the discharge limit can be met at two speeds; the higher
    /// is wanted, where the margin falls with speed.
    fn relieved_by_less_speed(&self, unknowns: [f64; 3]) -> bool {
        let (_, rows) = self.linearised(Closure::Discharge, unknowns);
        Inverse::of(rows).is_some_and(|inverse| inverse.step([0.0, 0.0, -1.0])[2] < 0.0)
    }

    /// Start values inside the physical range: warm, or from a guess of the lift.
    fn start(&self, warm: Option<&WarmStart>) -> [f64; 3] {
        let finite = |w: &&WarmStart| (w.evaporating_k + w.condensing_k + w.speed_rev_s).is_finite();
        if let Some(warm) = warm.filter(finite) {
            return self.confine([warm.evaporating_k, warm.condensing_k, warm.speed_rev_s]);
        }
        let evaporating = self.sides.cold_inlet_k - 5.0;
        let condensing = (self.sides.hot_inlet_k + 8.0).max(evaporating + 10.0);
        let reference = 2.0 * self.minimum_speed();
        let point = self.cycle.point(&self.sides, [evaporating, condensing, reference]);
        let speed = reference * self.power_limit_w / point.electric_w;
        self.confine([evaporating, condensing, speed.min(self.speed_limit_rev_s)])
    }

    fn confine(&self, [evaporating, condensing, speed]: [f64; 3]) -> [f64; 3] {
        let (lowest, highest) =
            (self.cycle.table.lowest_saturation_k() - 20.0, self.cycle.table.highest_saturation_k() + 20.0);
        [
            evaporating.max(lowest).min(self.sides.cold_inlet_k),
            condensing.min(highest).max(self.sides.hot_inlet_k),
            speed.max(0.5 * self.minimum_speed()).min(1.5 * self.speed_limit_rev_s),
        ]
    }

    /// Both balances together with a third equation; `None` without a solution.
    ///
    /// Close to the solution the derivatives hardly change: steps with those of an earlier point (chord steps) need
    /// the equations only, a third of the work.
    fn newton(&self, closure: Closure, start: [f64; 3]) -> Option<CyclePoint<f64>> {
        let mut unknowns = self.confine(start);
        for _ in 0..MAX_NEWTON_ITERATIONS {
            self.iterations.set(self.iterations.get() + 1);
            let (errors, rows) = self.linearised(closure, unknowns);
            let inverse = Inverse::of(rows)?;
            let step = inverse.step(errors);
            if !step.iter().all(|change| change.is_finite()) {
                return None;
            }
            let speed = unknowns[2];
            let fastest = if step[2] > 0.0 { MAX_SPEED_FACTOR - 1.0 } else { 1.0 - 1.0 / MAX_SPEED_FACTOR };
            let longest = largest([
                step[0] / MAX_TEMPERATURE_STEP_K,
                step[1] / MAX_TEMPERATURE_STEP_K,
                step[2] / (fastest * speed),
            ]);
            let scale = if longest > 1.0 { longest.recip() } else { 1.0 };
            let slowest = 0.5 * self.minimum_speed();
            let next = self.confine(std::array::from_fn(|k| unknowns[k] + scale * step[k]));
            if matches!(closure, Closure::Discharge) && unknowns[2] == slowest && next[2] == slowest {
                // Pushed against the end of the range twice: the root lies outside.
                return None;
            }
            unknowns = next;
            let mut error = largest(errors);
            while error < CHORD_ERROR {
                let point = self.cycle.point(&self.sides, unknowns);
                let errors = self.errors(closure, &point);
                let left = largest(errors);
                if left < RESIDUAL_TOLERANCE {
                    return Some(point);
                }
                if left > CHORD_SHARE * error || left.is_nan() {
                    break;
                }
                let step = inverse.step(errors);
                unknowns = self.confine(std::array::from_fn(|k| unknowns[k] + step[k]));
                error = left;
            }
        }
        None
    }

    /// Errors of all equations and their derivatives.
    fn linearised(&self, closure: Closure, unknowns: [f64; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
        let errors = self.errors(closure, &self.cycle.evaluate(&self.sides, variables(unknowns)));
        (errors.map(|error| error.value), errors.map(|error| error.gradient.array()))
    }

    /// Brackets the least margin of all limits over speed.
    fn bracketed(&mut self, start: [f64; 3]) -> Solution {
        self.bracketed = true;
        let nearby = Cell::new(start);
        let at_speed = |speed: f64| {
            let point = self.at_speed(speed, nearby.get());
            nearby.set([point.evaporating_k, point.condensing_k, speed]);
            point
        };
        let (low, high) = (self.minimum_speed(), self.speed_limit_rev_s);
        let slowest = at_speed(low);
        if let Some(verdict) = self.at_minimum_speed(&slowest) {
            return verdict;
        }
        let caps = |speed: f64| self.tightest(&CAPS, &at_speed(speed)).1;
        // The speed limit is one of the caps, so the far end never has room left.
        let fastest = bracketed_root(caps, (low, caps(low)), (high, caps(high)), RESIDUAL_TOLERANCE);
        let point = at_speed(fastest);
        let discharge = |speed: f64| self.margin(Limit::Discharge, &at_speed(speed));
        let room = discharge(fastest);
        if room >= -LIMIT_TOLERANCE {
            return Ok(self.running(point, self.tightest(&CAPS, &point).0));
        }
        let coolest = maximum(discharge, low, fastest);
        let most_room = discharge(coolest);
        if most_room < 0.0 {
            return Err(Limit::Discharge);
        }
        let speed = bracketed_root(discharge, (coolest, most_room), (fastest, room), RESIDUAL_TOLERANCE);
        Ok(self.running(at_speed(speed), Limit::Discharge))
    }

    /// Both balances at a fixed speed: Newton or, where it fails, nested bracketing, which cannot miss.
    ///
    /// The condenser balance rises with condensing temperature and the evaporator balance falls with evaporating
    /// temperature; both brackets exist because properties are held beyond the table.
    fn at_speed(&self, speed_rev_s: f64, start: [f64; 3]) -> CyclePoint<f64> {
        let start = [start[0], start[1], speed_rev_s];
        if let Some(point) = self.newton(Closure::AtSpeed(speed_rev_s), start) {
            return point;
        }
        let at = |evaporating: f64, condensing: f64| {
            self.cycle.point(&self.sides, [evaporating, condensing, speed_rev_s])
        };
        let condensing_at = |evaporating: f64| {
            let residual = |condensing: f64| at(evaporating, condensing).hot_residual_k;
            let low = self.sides.hot_inlet_k;
            let (high, f_high) = expand(low, 50.0, |x| (residual(x), residual(x) >= 0.0));
            bracketed_root(residual, (low, residual(low)), (high, f_high), 1e-3 * RESIDUAL_TOLERANCE)
        };
        let residual = |evaporating: f64| at(evaporating, condensing_at(evaporating)).cold_residual_k;
        let high = self.sides.cold_inlet_k;
        let (low, f_low) = expand(high, -50.0, |x| (residual(x), residual(x) >= 0.0));
        let evaporating =
            bracketed_root(residual, (low, f_low), (high, residual(high)), 1e-1 * RESIDUAL_TOLERANCE);
        at(evaporating, condensing_at(evaporating))
    }
}
