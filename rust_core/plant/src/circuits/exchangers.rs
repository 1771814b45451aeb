//! Exchangers of the refrigerant loop: what each meets on its other side, how those on one pressure level act together.
//!
//! With `Q_i = G_i (T - T_i)` several exchangers at one saturation temperature are one with `G = sum G_i` and `T = sum G_i T_i /
//! G`, and their heat splits again afterwards. Each keeps its own valve and pinch: superheat and subcooling fade for the
//! inlet that leaves the least room. None runs backwards: one that would, closes.

use super::branches::BranchValues;
use super::front_ends::FrontAirs;
use super::refrigeration_loop::{LoopBoundary, LoopResult, SupplyLimit};
use crate::architecture::declaration::Level;
use crate::architecture::indices::{ExchangerIndices, Indices};
use crate::architecture::layout::{
    CABIN_PLACES, EXCHANGER_PLACES, ExchangerSide, FRONT_END_PLACES, LOOP_PLACES,
};
use crate::command::Demand;
use crate::components::ambient_exchanger::AmbientExchangerParameters;
use crate::components::cabin::Ventilation;
use crate::components::heat_exchanger::inlet_conductance_w_k;
use crate::config::vehicle::VehicleParameters;
use crate::flows::{Flow, Flows};
use crate::network::shape::{Shape, each};
use crate::network::{Forecast, INLET_PLACES};
use crate::numerics::thermal_network::NodeValues;

/// Temperature limits of a supply that nothing limits [K].
const NO_HIGHEST_K: f64 = 1e4;
const NO_LOWEST_K: f64 = 0.0;

const _: () =
    assert!(INLET_PLACES == crate::architecture::layout::INLET_PLACES, "as many inlets as layouts may have");

/// What exchangers meet during a step.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings<'a> {
    /// Temperatures of the nodes [K].
    pub nodes_k: &'a NodeValues,
    /// Coolant capacity rate of each loop [W/K].
    pub rates_w_k: &'a [f64; LOOP_PLACES],
    /// Air of each cabin.
    pub ventilation: &'a [Ventilation; CABIN_PLACES],
    /// Air into the cores of each cabin [K].
    pub core_inlet_k: &'a [f64; CABIN_PLACES],
    /// Conductance of each branch, its switch applied [W/K].
    pub branches_w_k: &'a BranchValues,
    /// Air at each front-end exchanger [K].
    pub front_end_air_k: &'a [f64; FRONT_END_PLACES],
    /// Ambient [K].
    pub ambient_k: f64,
    /// Air flow and conductance of each front-end exchanger.
    pub front: &'a FrontAirs,
    /// Supplies of the loops that heat enters.
    pub forecasts: &'a [Forecast; INLET_PLACES],
    /// Positions of valves.
    pub demand: &'a Demand,
    /// Whether the compressor may run; conductances are worked out only then.
    pub may_run: bool,
}

/// An exchanger's numbers.
#[derive(Debug, Clone, Default)]
struct Exchanger {
    ua_w_k: f64,
    /// Limit of the supply, or of the air [K].
    limit_k: f64,
    front_end: Option<AmbientExchangerParameters>,
}

/// All exchangers of a vehicle.
#[derive(Debug, Clone, Default)]
pub struct ExchangerTable {
    exchangers: [Exchanger; EXCHANGER_PLACES],
}

/// One exchanger during a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SideState {
    /// Whether it takes part.
    pub open: bool,
    /// Inlet of coolant or air [K].
    pub inlet_k: f64,
    /// Capacity rate of coolant or air [W/K].
    pub capacity_rate_w_k: f64,
    /// Duty per distance between inlet and saturation [W/K].
    pub conductance_w_k: f64,
    /// Limit of its outlet.
    pub limit: SupplyLimit,
}

/// Sides of all exchangers.
pub type Sides = [SideState; EXCHANGER_PLACES];

impl ExchangerTable {
    /// Exchangers of a vehicle.
    #[must_use]
    pub fn of(vehicle: &VehicleParameters) -> Self {
        let mut exchangers = <[Exchanger; EXCHANGER_PLACES]>::default();
        let declared = vehicle.layout.exchangers.iter().zip(&vehicle.exchanger_ua_w_k);
        for (place, (declared, &ua_w_k)) in exchangers.iter_mut().zip(declared) {
            let hot = declared.level == Level::Condensing;
            let limit = match declared.side {
                ExchangerSide::Loop(circuit) if hot => vehicle.loops[circuit].maximum_supply_degc,
                ExchangerSide::Loop(circuit) => vehicle.loops[circuit].minimum_supply_degc,
                ExchangerSide::Cabin(cabin) if !hot => {
                    Some(vehicle.cabins[cabin].parameters.minimum_cooled_air_degc)
                }
                ExchangerSide::Cabin(_) | ExchangerSide::FrontEnd(_) => None,
            };
            let none_k = if hot { NO_HIGHEST_K } else { NO_LOWEST_K };
            let front_end = match declared.side {
                ExchangerSide::FrontEnd(end) => Some(vehicle.front_ends[end].clone()),
                ExchangerSide::Loop(_) | ExchangerSide::Cabin(_) => None,
            };
            let limit_k = limit.map_or(none_k, |limit| limit.kelvin());
            *place = Exchanger { ua_w_k, limit_k, front_end };
        }
        Self { exchangers }
    }

    /// All exchangers as they are at the beginning of a step.
    #[must_use]
    #[inline(always)]
    pub fn sides<S: Shape>(&self, shape: &Indices<'_>, around: &Surroundings<'_>) -> Sides {
        let mut sides = [SideState::default(); EXCHANGER_PLACES];
        each!(S::exchangers(shape) => |place, indices| {
            sides[place] = self.exchangers[place].side(shape, indices, around);
        });
        sides
    }
}

/// What the loop meets: all open exchangers of each level as one.
#[must_use]
#[inline(always)]
pub fn boundary(shape: &Indices<'_>, sides: &Sides) -> LoopBoundary {
    if shape.is_pair() {
        return pair(&sides[0], &sides[1]);
    }
    let [hot, cold] = [Level::Condensing, Level::Evaporating].map(|level| merged(shape, level, sides));
    let mut boundary = pair(&hot.0, &cold.0);
    (boundary.hottest_inlet_k, boundary.coldest_inlet_k) = (hot.1, cold.1);
    boundary
}

/// Open exchangers of a level.
fn on<'a>(shape: &'a Indices<'_>, level: Level, sides: &'a Sides) -> impl Iterator<Item = &'a SideState> {
    let own = shape.exchangers.iter().zip(sides).filter(move |(e, side)| e.level == level && side.open);
    own.map(|(_, side)| side)
}

/// All open exchangers of a level as one, with the inlet that leaves the least room [K].
fn merged(shape: &Indices<'_>, level: Level, sides: &Sides) -> (SideState, f64) {
    let mut open = on(shape, level, sides);
    match (open.next(), open.next()) {
        (Some(only), None) => return (*only, only.inlet_k),
        (None, _) => {
            // Nothing flows; the refrigerant rests at what its first exchanger meets.
            let first = shape.exchangers.iter().position(|exchanger| exchanger.level == level).unwrap_or(0);
            let closed = SideState { conductance_w_k: 0.0, capacity_rate_w_k: 0.0, ..sides[first] };
            return (closed, closed.inlet_k);
        }
        _ => {}
    }
    let hot = level == Level::Condensing;
    let most = on(shape, level, sides).fold(0.0, |sum, side| sum + side.conductance_w_k);
    if most <= 0.0 {
        // Air that stands still: nothing to weigh the inlets with, and nothing flows.
        let first = on(shape, level, sides).next().copied().unwrap_or_default();
        return (first, first.inlet_k);
    }
    let mut merged = SideState { open: true, ..SideState::default() };
    let mut tightest_k = if hot { f64::NEG_INFINITY } else { f64::INFINITY };
    for side in on(shape, level, sides) {
        merged.inlet_k += side.conductance_w_k * side.inlet_k;
        merged.capacity_rate_w_k += side.capacity_rate_w_k;
        merged.conductance_w_k += side.conductance_w_k;
        tightest_k = if hot { tightest_k.max(side.inlet_k) } else { tightest_k.min(side.inlet_k) };
    }
    merged.inlet_k /= merged.conductance_w_k;
    merged.limit = least_limit(shape, level, sides, &merged);
    (merged, tightest_k)
}

/// The limit that allows the least heat, as one on the heat of all.
///
/// An exchanger has `Q_i = G_i / G (Q +- G (T_m - T_i))` of it, so each limit is a straight line in `Q`.
fn least_limit(shape: &Indices<'_>, level: Level, sides: &Sides, merged: &SideState) -> SupplyLimit {
    let sign = if level == Level::Condensing { 1.0 } else { -1.0 };
    let none_k = if sign > 0.0 { NO_HIGHEST_K } else { NO_LOWEST_K };
    let mut least =
        (f64::INFINITY, SupplyLimit { base_k: merged.inlet_k, sensitivity_k_w: 0.0, limit_k: none_k });
    for side in on(shape, level, sides) {
        let share = side.conductance_w_k / merged.conductance_w_k;
        let apart_w = side.conductance_w_k * sign * (merged.inlet_k - side.inlet_k);
        let SupplyLimit { base_k, sensitivity_k_w, limit_k } = side.limit;
        let base_k = base_k + sign * sensitivity_k_w * apart_w;
        let sensitivity_k_w = sensitivity_k_w * share;
        let most_w = sign * (limit_k - base_k) / sensitivity_k_w.max(f64::MIN_POSITIVE);
        if most_w < least.0 {
            least = (most_w, SupplyLimit { base_k, sensitivity_k_w, limit_k });
        }
    }
    least.1
}

/// Closes exchangers that would run backwards; whether there were any.
#[inline(always)]
pub fn close_backward(shape: &Indices<'_>, result: &LoopResult, sides: &mut Sides) -> bool {
    if shape.is_pair() || !result.running() {
        return false;
    }
    let mut closed = false;
    for (exchanger, side) in shape.exchangers.iter().zip(sides).filter(|(_, side)| side.open) {
        let room_k = match exchanger.level {
            Level::Condensing => result.condensing_temperature_k - side.inlet_k,
            Level::Evaporating => side.inlet_k - result.evaporating_temperature_k,
        };
        if room_k <= 0.0 {
            side.open = false;
            closed = true;
        }
    }
    closed
}

/// Enters the heat of each exchanger; both levels' totals are split in proportion to what each passes.
#[inline(always)]
pub fn record(shape: &Indices<'_>, result: &LoopResult, sides: &Sides, flows: &mut Flows) {
    flows[Flow::CONDENSER] = result.condenser_heat_flow_w;
    flows[Flow::EVAPORATOR] = result.evaporator_heat_flow_w;
    if shape.is_pair() {
        return;
    }
    for (level, total_w, saturation_k) in [
        (Level::Condensing, result.condenser_heat_flow_w, result.condensing_temperature_k),
        (Level::Evaporating, result.evaporator_heat_flow_w, result.evaporating_temperature_k),
    ] {
        let part_w = |side: &SideState| side.conductance_w_k * (saturation_k - side.inlet_k).abs();
        let sum_w: f64 = on(shape, level, sides).map(part_w).sum();
        for (exchanger, side) in shape.exchangers.iter().zip(sides).filter(|(e, _)| e.level == level) {
            let share = if side.open && sum_w > 0.0 { part_w(side) / sum_w } else { 0.0 };
            flows[exchanger.flow] = total_w * share;
        }
    }
}

/// Remembers the heat that each loop's exchanger brought [W], and that each front-end exchanger gave to the air [W].
#[inline(always)]
pub fn remember<S: Shape>(
    shape: &Indices<'_>,
    flows: &Flows,
    entered_w: &mut [f64; LOOP_PLACES],
    front_end_w: &mut [f64; FRONT_END_PLACES],
) {
    each!(S::exchangers(shape) => |_, exchanger| {
        let heat_w = match exchanger.level {
            Level::Condensing => flows[exchanger.flow],
            Level::Evaporating => -flows[exchanger.flow],
        };
        match exchanger.side {
            ExchangerSide::Loop(circuit) => entered_w[circuit] = heat_w,
            ExchangerSide::FrontEnd(end) => front_end_w[end] += heat_w,
            ExchangerSide::Cabin(_) => {}
        }
    });
}

/// One condenser and one evaporator.
#[inline(always)]
fn pair(hot: &SideState, cold: &SideState) -> LoopBoundary {
    LoopBoundary {
        hot_return_k: hot.inlet_k,
        cold_return_k: cold.inlet_k,
        hottest_inlet_k: hot.inlet_k,
        coldest_inlet_k: cold.inlet_k,
        hot_capacity_rate_w_k: hot.capacity_rate_w_k,
        cold_capacity_rate_w_k: cold.capacity_rate_w_k,
        hot_conductance_w_k: hot.conductance_w_k,
        cold_conductance_w_k: cold.conductance_w_k,
        hot_supply: hot.limit,
        cold_supply: cold.limit,
    }
}

/// Whether a valve lets refrigerant through an exchanger.
#[inline(always)]
pub(super) fn is_open(indices: &ExchangerIndices, demand: &Demand) -> bool {
    indices.valve_row.is_none_or(|row| demand.0[usize::from(row)] > 0.5)
}

impl Exchanger {
    #[inline(always)]
    fn side(&self, shape: &Indices<'_>, indices: &ExchangerIndices, around: &Surroundings<'_>) -> SideState {
        let open = is_open(indices, around.demand);
        match indices.side {
            ExchangerSide::Loop(circuit) => {
                let rate_w_k = around.rates_w_k[circuit];
                let own = &shape.loops[circuit];
                let forecast = own.inlet.map(|inlet| around.forecasts[usize::from(inlet)]);
                let Forecast { base_k, sensitivity_k_w } = forecast.unwrap_or_default();
                SideState {
                    open,
                    inlet_k: around.nodes_k[own.back.index()],
                    capacity_rate_w_k: rate_w_k,
                    conductance_w_k: around.conductance_w_k(shape, rate_w_k, self.ua_w_k),
                    limit: SupplyLimit { base_k, sensitivity_k_w, limit_k: self.limit_k },
                }
            }
            ExchangerSide::Cabin(cabin) => {
                let rate_w_k = around.ventilation[cabin].supply_rate_w_k;
                let inlet_k = around.behind_core_k(shape, cabin);
                let limit =
                    SupplyLimit { base_k: inlet_k, sensitivity_k_w: rate_w_k.recip(), limit_k: self.limit_k };
                let conductance_w_k = around.conductance_w_k(shape, rate_w_k, self.ua_w_k);
                SideState { open, inlet_k, capacity_rate_w_k: rate_w_k, conductance_w_k, limit }
            }
            ExchangerSide::FrontEnd(end) => self.front_end_side(indices.level, open, end, around),
        }
    }

    /// A front-end exchanger: its air as for coolant; as a heat source it has the frost interlock.
    fn front_end_side(&self, level: Level, open: bool, end: usize, around: &Surroundings<'_>) -> SideState {
        let Some(front_end) = &self.front_end else { return SideState::default() };
        let inlet_k = around.front_end_air_k[end];
        let frosts = level == Level::Evaporating && front_end.is_locked(around.ambient_k);
        let air = &around.front.airs[end];
        let share = if level == Level::Evaporating { air.source_share } else { 1.0 };
        SideState {
            open: open && !frosts,
            inlet_k,
            capacity_rate_w_k: air.rate_w_k,
            conductance_w_k: share * air.to_refrigerant_w_k(),
            limit: SupplyLimit { base_k: inlet_k, sensitivity_k_w: 0.0, limit_k: self.limit_k },
        }
    }
}

impl Surroundings<'_> {
    /// Supply air of a cabin behind its coolant core, where refrigerant meets it [K]: were both to meet the same air, it
    /// could leave warmer than either.
    #[inline]
    fn behind_core_k(&self, shape: &Indices<'_>, cabin: usize) -> f64 {
        let (own, inlet_k) = (&shape.cabins[cabin], self.core_inlet_k[cabin]);
        let rate_w_k = self.ventilation[cabin].supply_rate_w_k;
        [own.heater, own.cooler].into_iter().flatten().fold(inlet_k, |air_k, core| {
            let supply = shape.loops[usize::from(shape.branches[core].circuit)].supply;
            air_k + self.branches_w_k[core] / rate_w_k * (self.nodes_k[supply.index()] - inlet_k)
        })
    }

    /// Conductance of an exchanger, where the compressor may run or several on a level are weighed by it [W/K].
    #[inline(always)]
    fn conductance_w_k(&self, shape: &Indices<'_>, rate_w_k: f64, ua_w_k: f64) -> f64 {
        if self.may_run || !shape.is_pair() { inlet_conductance_w_k(rate_w_k, ua_w_k) } else { 0.0 }
    }
}
