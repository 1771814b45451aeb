//! The refrigeration loop as the plant sees it: one quasi-steady solve a step, inside the compressor's envelope.
//!
//! The compressor gets the most power that demand, speed, pressures, discharge temperature and both coolant
//! supplies at the end of the step allow. No charge, pressure drop or refrigerant dynamics are modelled.

use std::cell::Cell;

use serde::{Deserialize, Serialize};

use super::refrigeration_cycle::RefrigerationCycle;
pub use super::refrigeration_solver::{Limit, SupplyLimit, WarmStart};
use super::refrigeration_solver::{Running, Scales, Solver, UNSOLVED};
use crate::components::compressor::CompressorState;
use crate::components::refrigerant_exchanger::{CondenserStreams, EvaporatorStreams};

/// Conductance below which a coolant counts as standing still [W/K].
const LEAST_CONDUCTANCE_W_K: f64 = 1.0;

/// Change in a step [K or rev/s] beyond which a solution jumped, so that the next will not go on the same way.
const LARGEST_TREND: f64 = 1.0;

/// Change of speed, as a share of it, from which on a demand that jumped explains it better than the trend.
const SMALLEST_JUMP: f64 = 0.03;

/// Relative change of speed per relative change of power, and of the temperature differences per that of speed: those
/// that needed the fewest iterations under random actions. (Power goes with speed to the power of 1.1 there, the
/// differences with about 0.83.) No result depends on them.
const SPEED_BY_POWER: f64 = 0.9;
const DIFFERENCE_BY_SPEED: f64 = 0.86;

/// What the coolants, or the air, offer during a step: all condensers as one, all evaporators as one.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct LoopBoundary {
    /// Coolant entering the condenser [K].
    pub hot_return_k: f64,
    /// Coolant entering the evaporator [K].
    pub cold_return_k: f64,
    /// The hottest of the inlets where there are several condensers [K].
    pub hottest_inlet_k: f64,
    /// The coldest of the inlets where there are several evaporators [K].
    pub coldest_inlet_k: f64,
    /// Capacity rate of the hot coolant [W/K].
    pub hot_capacity_rate_w_k: f64,
    /// Capacity rate of the cold coolant [W/K].
    pub cold_capacity_rate_w_k: f64,
    /// Duty per distance between hot coolant inlet and condensing temperature [W/K].
    pub hot_conductance_w_k: f64,
    /// Duty per distance between cold coolant inlet and evaporating temperature [W/K].
    pub cold_conductance_w_k: f64,
    /// Hot supply: `base + sensitivity * condenser heat flow` must stay at or below its limit.
    pub hot_supply: SupplyLimit,
    /// Cold supply: `base - sensitivity * evaporator heat flow` must stay at or above its limit.
    pub cold_supply: SupplyLimit,
}

/// What the compressor may do during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopDemand {
    /// Electrical power that is demanded or allowed [W].
    pub power_limit_w: f64,
    /// Highest speed [rev/s].
    pub speed_limit_rev_s: f64,
    /// Run at minimum speed even if that takes more than `power_limit_w`.
    pub hold_minimum_speed: bool,
}

/// What demand and battery allow the compressor during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompressorAllowance {
    /// Electrical power demanded [W].
    pub demand_w: f64,
    /// Electrical power that can be fed at all, start loss included [W].
    pub available_w: f64,
    /// A machine at rest may start; the plant allows it once a second.
    pub may_start: bool,
}

/// How a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum LoopStatus {
    /// At rest; `limited_by` tells why.
    #[default]
    Off,
    /// At rest: the pressure ratio would stay below what the machine can work with.
    NoLift,
    /// Takes the power it is given.
    Converged,
    /// At minimum speed, with more power than demanded, until the minimum time on is over.
    MinimumSpeed,
    /// At the highest speed or on the speed ramp.
    SpeedLimited,
    /// At the highest condensing pressure.
    PressureLimited,
    /// At the lowest suction pressure.
    SuctionLimited,
    /// One of the coolant supplies ends the step at its limit.
    CoolantLimited,
    /// At the highest discharge temperature.
    DischargeLimited,
    /// At rest: no state was found that satisfies all equations.
    NotConverged,
}

/// The loop during one step.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct LoopResult {
    /// How the solve ended.
    pub status: LoopStatus,
    /// What holds the compressor back, or keeps it off.
    pub limited_by: Limit,
    /// Evaporating temperature; at rest that of the coolant [K].
    pub evaporating_temperature_k: f64,
    /// Condensing temperature; at rest that of the coolant [K].
    pub condensing_temperature_k: f64,
    /// Evaporating pressure [Pa].
    pub evaporating_pressure_pa: f64,
    /// Condensing pressure [Pa].
    pub condensing_pressure_pa: f64,
    /// Compressor speed [rev/s].
    pub speed_rev_s: f64,
    /// Refrigerant mass flow at suction [kg/s].
    pub mass_flow_kg_s: f64,
    /// Flow that is injected besides [kg/s]; 0 without vapour injection.
    pub injected_mass_flow_kg_s: f64,
    /// Electrical power of the compressor, with the start loss [W].
    pub electric_power_w: f64,
    /// Heat to the hot coolant [W].
    pub condenser_heat_flow_w: f64,
    /// Heat from the cold coolant [W].
    pub evaporator_heat_flow_w: f64,
    /// Gas temperature at the compressor outlet [K].
    pub discharge_temperature_k: f64,
    /// What leaves to ambient: start loss, and the loss of motor and inverter less what heats the gas [W].
    pub loss_to_ambient_w: f64,
    /// Share of the start loss in power and loss [W].
    pub start_loss_w: f64,
    /// Superheat at the compressor inlet [K].
    pub superheat_k: f64,
    /// Subcooling at the condenser outlet [K].
    pub subcooling_k: f64,
    /// Newton iterations of all attempts: limits, discharge temperature, single speeds.
    pub iterations: u32,
    /// Newton gave up and bracketing over speed solved.
    pub bracketed: bool,
    /// Largest error of the equations as they were left: both balances [K], and the margin of the limit in its scaled unit; 0
    /// where nothing was solved.
    pub residual: f64,
}

/// A solution with the machine running, as what changes least from one second to the next.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LastSolution {
    /// Coolant entering the evaporator less evaporating temperature, condensing temperature less coolant entering the
    /// condenser [K], speed [rev/s].
    distances: [f64; 3],
    /// How much these changed in the last step; 0 where they jumped or the machine had stood still.
    trend: [f64; 3],
    /// Electrical power without start loss [W].
    electric_power_w: f64,
    /// Power or speed held the machine back, nothing else.
    by_power_or_speed: bool,
}

/// Memory of the loop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RefrigerationState {
    /// Memory of the envelope.
    pub compressor: CompressorState,
    /// Last solution with the machine running.
    pub last: Option<LastSolution>,
}

impl RefrigerationState {
    /// A vehicle that was parked for long.
    #[must_use]
    pub fn parked() -> Self {
        Self { compressor: CompressorState::parked(), last: None }
    }

    /// How far the refrigerant evaporated below what entered its evaporator in the last step [K]; none at rest.
    #[must_use]
    #[inline]
    pub fn evaporator_distance_k(&self) -> Option<f64> {
        self.last.filter(|_| self.compressor.running).map(|last| last.distances[0])
    }

    /// Keeps a solution, if the machine ran, and how it changed from that of the step before.
    fn remember(&mut self, boundary: &LoopBoundary, result: &LoopResult) {
        if !result.running() {
            return;
        }
        let before = self.last.filter(|_| self.compressor.running);
        let distances = [
            boundary.cold_return_k - result.evaporating_temperature_k,
            result.condensing_temperature_k - boundary.hot_return_k,
            result.speed_rev_s,
        ];
        let change = before
            .map_or([f64::INFINITY; 3], |last| std::array::from_fn(|k| distances[k] - last.distances[k]));
        let steady = change.iter().all(|part| part.abs() < LARGEST_TREND);
        self.last = Some(LastSolution {
            distances,
            trend: if steady { change } else { [0.0; 3] },
            electric_power_w: result.electric_power_w,
            by_power_or_speed: matches!(result.limited_by, Limit::Power | Limit::Speed | Limit::MinimumSpeed),
        });
    }
}

impl LastSolution {
    /// Where the solution of a demand is expected: straight lines through the last one. Where speed hardly changes,
    /// everything goes on as before.
    fn expected(&self, boundary: &LoopBoundary, demand: &LoopDemand, minimum_speed_rev_s: f64) -> WarmStart {
        let power_ratio = demand.power_limit_w.max(0.0) / self.electric_power_w;
        let by_power = 1.0 + SPEED_BY_POWER * (power_ratio - 1.0);
        let by_power = if self.by_power_or_speed { by_power } else { by_power.min(1.0) };
        let [cold_k, hot_k, last_rev_s] = self.distances;
        let speed_rev_s = (last_rev_s * by_power).min(demand.speed_limit_rev_s).max(minimum_speed_rev_s);
        let speed_change = speed_rev_s / last_rev_s - 1.0;
        let [cold_k, hot_k, speed_rev_s] = if speed_change.abs() < SMALLEST_JUMP {
            std::array::from_fn(|k| self.distances[k] + self.trend[k])
        } else {
            let difference_ratio = 1.0 + DIFFERENCE_BY_SPEED * speed_change;
            [cold_k * difference_ratio, hot_k * difference_ratio, speed_rev_s]
        };
        WarmStart {
            evaporating_k: boundary.cold_return_k - cold_k,
            condensing_k: boundary.hot_return_k + hot_k,
            speed_rev_s,
        }
    }
}

impl LoopResult {
    /// The compressor turns.
    #[must_use]
    pub fn running(&self) -> bool {
        !matches!(self.status, LoopStatus::Off | LoopStatus::NoLift | LoopStatus::NotConverged)
    }
}

impl RefrigerationCycle {
    /// One step inside the compressor's envelope: starts, stops, holds, ramps and solves.
    ///
    /// A stopped machine starts only where it may. It runs while the
    /// demand covers minimum speed or its minimum time on lasts, and stops at once where a limit leaves no room.
    pub fn step(
        &self,
        state: &mut RefrigerationState,
        boundary: &LoopBoundary,
        allowed: &CompressorAllowance,
        step_s: f64,
    ) -> LoopResult {
        let parameters = &self.parameters.compressor;
        let demand_w =
            allowed.demand_w.min(allowed.available_w - state.compressor.start_loss_w(parameters, step_s));
        let wanted = demand_w >= parameters.minimum_power_w;
        let held_on = state.compressor.held_on(parameters);
        let power_share = state.compressor.power_share(parameters, step_s);
        let startable = allowed.may_start && wanted && state.compressor.rested(parameters);
        let mut result = if (state.compressor.running && (wanted || held_on)) || startable {
            let demand = LoopDemand {
                power_limit_w: if wanted { demand_w * power_share } else { 0.0 },
                speed_limit_rev_s: state.compressor.speed_limit_rev_s(parameters, step_s),
                // Not yet settled, it may need more at its lowest speed than its share.
                hold_minimum_speed: held_on || (wanted && power_share < 1.0),
            };
            let expected =
                state.last.map(|last| last.expected(boundary, &demand, parameters.minimum_speed_rev_s));
            self.solve(boundary, &demand, expected.as_ref())
        } else {
            self.at_rest(boundary, LoopStatus::Off, Limit::Power)
        };
        // At its lowest speed only: elsewhere the solution is at the demand, and round-off is no reason to stop.
        let lowest = result.status == LoopStatus::MinimumSpeed;
        let beyond_demand = !held_on && lowest && result.electric_power_w > demand_w;
        if result.electric_power_w > allowed.available_w || beyond_demand {
            // Not even minimum speed can be fed, or it was not asked for: the minimum time on ends here.
            result = self.at_rest(boundary, LoopStatus::Off, Limit::Power);
        }
        let forced = result.limited_by != Limit::Power;
        if startable && forced && !result.running() {
            // A start that a limit refuses is tried again only after another minimum time off.
            state.compressor.time_in_state_s = 0.0;
        }
        state.remember(boundary, &result);
        let speed_rev_s = result.running().then_some(result.speed_rev_s);
        result.start_loss_w = state.compressor.advance(parameters, speed_rev_s, forced, step_s);
        result.electric_power_w += result.start_loss_w;
        result.loss_to_ambient_w += result.start_loss_w;
        result
    }

    /// The quasi-steady loop at the highest speed that demand and limits allow.
    #[must_use]
    pub fn solve(
        &self,
        boundary: &LoopBoundary,
        demand: &LoopDemand,
        warm_start: Option<&WarmStart>,
    ) -> LoopResult {
        let parameters = &self.parameters.compressor;
        let power_limit_w = demand.power_limit_w.min(parameters.maximum_power_w);
        if !demand.hold_minimum_speed && (power_limit_w <= 0.0 || power_limit_w < parameters.minimum_power_w)
        {
            return self.at_rest(boundary, LoopStatus::Off, Limit::Power);
        }
        let sides = Self::coolant_sides(boundary);
        let flowing = sides.hot_conductance_w_k.min(sides.cold_conductance_w_k) >= LEAST_CONDUCTANCE_W_K;
        let finite = (boundary.hot_return_k + boundary.cold_return_k + power_limit_w).is_finite();
        if !(flowing && finite) {
            return self.at_rest(boundary, LoopStatus::Off, Limit::CoolantFlow);
        }
        let speed_limit_rev_s = demand.speed_limit_rev_s.min(parameters.maximum_speed_rev_s);
        let mut solver = Solver {
            cycle: self,
            sides,
            hot_supply: boundary.hot_supply,
            cold_supply: boundary.cold_supply,
            power_limit_w,
            speed_limit_rev_s,
            scales: Scales::of(
                self,
                &sides,
                (&boundary.hot_supply, &boundary.cold_supply),
                (power_limit_w, speed_limit_rev_s),
            ),
            hold: demand.hold_minimum_speed,
            iterations: Cell::new(0),
            bracketed: false,
        };
        let mut result = match solver.solve(warm_start) {
            Err(limit) => self.at_rest(boundary, LoopStatus::Off, limit),
            Ok(running) if running.residual.is_nan() || running.residual > UNSOLVED => LoopResult {
                residual: running.residual,
                ..self.at_rest(boundary, LoopStatus::NotConverged, running.limit)
            },
            Ok(running) if running.point.pressure_ratio() < parameters.minimum_pressure_ratio => {
                self.at_rest(boundary, LoopStatus::NoLift, running.limit)
            }
            Ok(running) => self.running_result(&running),
        };
        (result.iterations, result.bracketed) = (solver.iterations.get(), solver.bracketed);
        result
    }

    /// Temperature differences between refrigerant and coolant at both ends of every zone [K]: condenser gas
    /// inlet, dew point, bubble point, liquid outlet; evaporator gas outlet, dew point, inlet. None is negative.
    #[must_use]
    pub fn stream_margins_k(&self, boundary: &LoopBoundary, result: &LoopResult) -> [f64; 7] {
        let sides = Self::coolant_sides(boundary);
        let unknowns =
            [result.evaporating_temperature_k, result.condensing_temperature_k, result.speed_rev_s];
        let point = self.point(&sides, unknowns);
        let suction_flow = point.mass_flow_kg_s;
        let flow = suction_flow * (1.0 + point.injected_share);
        let (dew, bubble) = (point.isobar.dew_enthalpy_j_kg, point.isobar.liquid_enthalpy_j_kg(0.0));
        let suction_dew = self.table.suction_state(point.evaporating_k, 0.0).enthalpy_j_kg;
        let condenser = CondenserStreams {
            coolant_inlet_k: boundary.hot_return_k,
            capacity_rate_w_k: boundary.hot_capacity_rate_w_k,
            discharge_k: self.discharge_k(&point),
            condensing_k: point.condensing_k,
            subcooling_k: point.subcooling_k,
            desuperheating_w: suction_flow * (point.discharge_enthalpy_j_kg - dew).max(0.0),
            condensation_w: flow * (point.discharge_enthalpy_j_kg.min(dew) - bubble),
            subcooling_w: flow * (bubble - point.liquid_enthalpy_j_kg),
        };
        let evaporator = EvaporatorStreams {
            coolant_inlet_k: boundary.cold_return_k,
            capacity_rate_w_k: boundary.cold_capacity_rate_w_k,
            evaporating_k: point.evaporating_k,
            superheat_k: point.superheat_k,
            evaporation_w: suction_flow * (suction_dew - point.evaporator_inlet_j_kg),
            superheating_w: suction_flow * (point.suction_enthalpy_j_kg - suction_dew),
        };
        let ([a, b, c, d], [e, f, g]) = (condenser.margins_k(), evaporator.margins_k());
        [a, b, c, d, e, f, g]
    }

    fn running_result(&self, running: &Running) -> LoopResult {
        let Running { point, limit, discharge_k, residual } = *running;
        LoopResult {
            status: match limit {
                Limit::Power | Limit::CoolantFlow => LoopStatus::Converged,
                Limit::Speed => LoopStatus::SpeedLimited,
                Limit::MinimumSpeed => LoopStatus::MinimumSpeed,
                Limit::Pressure => LoopStatus::PressureLimited,
                Limit::Suction => LoopStatus::SuctionLimited,
                Limit::HotCoolant | Limit::ColdCoolant => LoopStatus::CoolantLimited,
                Limit::Discharge => LoopStatus::DischargeLimited,
            },
            limited_by: limit,
            evaporating_temperature_k: point.evaporating_k,
            condensing_temperature_k: point.condensing_k,
            evaporating_pressure_pa: point.evaporating_pressure_pa,
            condensing_pressure_pa: point.isobar.pressure_pa,
            speed_rev_s: point.speed_rev_s,
            mass_flow_kg_s: point.mass_flow_kg_s,
            injected_mass_flow_kg_s: point.mass_flow_kg_s * point.injected_share,
            electric_power_w: point.electric_w,
            condenser_heat_flow_w: point.condenser_w,
            evaporator_heat_flow_w: point.evaporator_w,
            discharge_temperature_k: discharge_k,
            loss_to_ambient_w: (1.0 - self.parameters.compressor.loss_to_gas_share)
                * (1.0 - self.parameters.compressor.electrical_efficiency)
                * point.electric_w,
            start_loss_w: 0.0,
            superheat_k: point.superheat_k,
            subcooling_k: point.subcooling_k,
            iterations: 0,
            bracketed: false,
            residual,
        }
    }

    /// No flow; each side has taken the temperature of its coolant.
    fn at_rest(&self, boundary: &LoopBoundary, status: LoopStatus, limit: Limit) -> LoopResult {
        let (evaporating_k, condensing_k) = (boundary.cold_return_k, boundary.hot_return_k);
        LoopResult {
            status,
            limited_by: limit,
            evaporating_temperature_k: evaporating_k,
            condensing_temperature_k: condensing_k,
            evaporating_pressure_pa: self.table.saturation_pressure_pa(evaporating_k),
            condensing_pressure_pa: self.table.saturation_pressure_pa(condensing_k),
            speed_rev_s: 0.0,
            mass_flow_kg_s: 0.0,
            injected_mass_flow_kg_s: 0.0,
            electric_power_w: 0.0,
            condenser_heat_flow_w: 0.0,
            evaporator_heat_flow_w: 0.0,
            discharge_temperature_k: condensing_k,
            loss_to_ambient_w: 0.0,
            start_loss_w: 0.0,
            superheat_k: 0.0,
            subcooling_k: 0.0,
            iterations: 0,
            bracketed: false,
            residual: 0.0,
        }
    }
}
