//! Coolant branches: what may be connected, and how much heat could pass.
//!
//! Branches are worked out side by side, in whole vector registers and without asking each whether it is connected, which
//! nobody could predict. So many places are worked on as the vehicle's branches need, in groups of four.

use super::front_ends::FrontAirs;
use crate::architecture::declaration::MemberKind;
use crate::architecture::indices::{BranchIndices, Indices};
use crate::architecture::layout::{
    BRANCH_PLACES, BranchSide, CABIN_PLACES, FRONT_END_PLACES, LOOP_PLACES, MassLayout,
};
use crate::command::Demand;
use crate::components::cabin::Ventilation;
use crate::components::coolant_loop::ClosedBranches;
use crate::components::heat_exchanger::{counterflow_conductance_w_k, inlet_conductance_w_k};
use crate::components::thermal_switch::SwitchParameters;
use crate::config::vehicle::VehicleParameters;
use crate::network::shape::{Shape, each};
use crate::numerics::elementary::fused;
use crate::numerics::thermal_network::NodeValues;

/// One value for each branch; what stands behind them means nothing.
pub type BranchValues = [f64; BRANCH_PLACES];

/// Which branches are connected.
pub type Connected = [bool; BRANCH_PLACES];

/// Temperatures that decide about connections [K].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BranchTemperatures {
    /// Nodes.
    pub nodes_k: NodeValues,
    /// Air at each front-end exchanger.
    pub front_end_air_k: [f64; FRONT_END_PLACES],
    /// Air into the cores of each cabin.
    pub core_inlet_k: [f64; CABIN_PLACES],
    /// Coolant behind the exchanger of each loop, where branches in series begin.
    pub behind_exchanger_k: [f64; LOOP_PLACES],
}

/// Coolant capacity rates of the loops and the air flows that the branches exchange heat with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BranchFlows {
    /// Coolant of each loop [W/K].
    pub rates_w_k: [f64; LOOP_PLACES],
    /// Air of each cabin.
    pub ventilation: [Ventilation; CABIN_PLACES],
}

/// What branches do follows from these, a vehicle's parameters branch by branch.
#[derive(Debug, Clone)]
pub struct BranchTable {
    /// Ambient temperature at or below which it stays open: the frost interlock of heat sources [K].
    frost_k: BranchValues,
    /// Share of the loop's flow; the whole in series.
    flow_share: BranchValues,
    /// Share of that which a closed valve lets through, and what an open one adds.
    valve_closed: BranchValues,
    valve_span: BranchValues,
    /// Coolant side of the exchanger of a mass [W/K].
    coolant_ua_w_k: BranchValues,
    /// Cores of each cabin [W/K].
    heater_ua_w_k: [f64; CABIN_PLACES],
    cooler_ua_w_k: [f64; CABIN_PLACES],
    /// Plates between loops, by branch [W/K].
    plate_ua_w_k: BranchValues,
    /// What becomes of the flow of closed branches, by loop.
    closed_branches: [ClosedBranches; LOOP_PLACES],
    closing_difference_k: f64,
    opening_difference_k: f64,
}

impl BranchTable {
    /// Branches of a vehicle.
    #[must_use]
    pub fn of(vehicle: &VehicleParameters) -> Self {
        let layout = &*vehicle.layout;
        let SwitchParameters { closing_difference_k, opening_difference_k, .. } =
            vehicle.controls.thermal_switch;
        let mut table = Self {
            frost_k: [f64::NEG_INFINITY; BRANCH_PLACES],
            flow_share: [0.0; BRANCH_PLACES],
            valve_closed: [0.0; BRANCH_PLACES],
            valve_span: [0.0; BRANCH_PLACES],
            coolant_ua_w_k: [0.0; BRANCH_PLACES],
            heater_ua_w_k: [0.0; CABIN_PLACES],
            cooler_ua_w_k: [0.0; CABIN_PLACES],
            plate_ua_w_k: [0.0; BRANCH_PLACES],
            closed_branches: [ClosedBranches::Bypass; LOOP_PLACES],
            closing_difference_k,
            opening_difference_k,
        };
        for (place, share) in vehicle.cabins.iter().enumerate() {
            table.heater_ua_w_k[place] = share.parameters.heater_core_ua_w_k;
            table.cooler_ua_w_k[place] = share.parameters.cooling_core_ua_w_k;
        }
        for (circuit, parameters) in vehicle.loops.iter().enumerate() {
            table.closed_branches[circuit] = parameters.circuit.branch_shares.closed_branches;
        }
        for branch in 0..layout.branches.len() {
            table.add(vehicle, branch);
        }
        table
    }

    fn add(&mut self, vehicle: &VehicleParameters, place: usize) {
        let branch = vehicle.layout.branches[place];
        let member = &vehicle.layout.members[branch.member];
        let parameters = &vehicle.loops[branch.circuit].circuit;
        self.flow_share[place] = if branch.series { 1.0 } else { parameters.branch_shares.of(&member.name) };
        self.valve_closed[place] = parameters.valve_closed;
        self.valve_span[place] = parameters.valve_open - parameters.valve_closed;
        self.coolant_ua_w_k[place] = exchanger(vehicle, place);
        if let (BranchSide::Ambient(end), false) = (branch.side, branch.out_of_loop) {
            self.frost_k[place] = vehicle.front_ends[end].frost_interlock_degc.kelvin();
        }
        if let Some(plate) = &vehicle.plates[branch.member] {
            self.plate_ua_w_k[place] = plate.ua_w_k;
        }
    }

    /// Whether the plant allows a branch to be connected: enough temperature difference, with hysteresis, and the frost
    /// interlock of the front-end exchanger (paper sections 2.3 and 2.4).
    #[must_use]
    #[inline(always)]
    pub fn allows(&self, branch: usize, difference_k: f64, ambient_k: f64, connected: bool) -> bool {
        let needed_k = if connected { self.opening_difference_k } else { self.closing_difference_k };
        (difference_k > needed_k) & (ambient_k > self.frost_k[branch])
    }

    /// Which branches are connected, given what is asked and what was connected.
    #[inline(always)]
    pub fn grant<S: Shape>(
        &self,
        shape: &Indices<'_>,
        demand: &Demand,
        differences_k: &BranchValues,
        ambient_k: f64,
        connected: &mut Connected,
    ) {
        each!(S::branches(shape) => |i, branch| {
            let asked = demand.0[usize::from(branch.connection_row)] == f64::from(branch.option);
            connected[i] = asked & self.allows(i, differences_k[i], ambient_k, connected[i]);
        });
    }

    /// Share of a loop's flow that its open branches have together, 1 where closed branches keep theirs.
    #[inline(always)]
    fn open_share<S: Shape>(&self, shape: &Indices<'_>, circuit: usize, connected: &Connected) -> f64 {
        let (mut cooling, mut open) = (false, 0.0);
        each!(S::branches(shape) => |i, branch| {
            if usize::from(branch.circuit) == circuit {
                cooling |= branch.cools & connected[i];
                if !branch.series {
                    open = fused(f64::from(u8::from(connected[i])), self.flow_share[i], open);
                }
            }
        });
        let redistributes = match self.closed_branches[circuit] {
            ClosedBranches::Bypass => false,
            ClosedBranches::Redistribute => true,
            ClosedBranches::RedistributeInCooling => cooling,
        };
        if redistributes & (open > 0.0) { open } else { 1.0 }
    }

    /// Capacity rate of the coolant that passes each branch's component [W/K].
    #[inline(always)]
    pub fn coolant_rates_w_k<S: Shape>(
        &self,
        shape: &Indices<'_>,
        demand: &Demand,
        flows: &BranchFlows,
        connected: &Connected,
    ) -> BranchValues {
        let mut open_shares = [1.0; LOOP_PLACES];
        each!(S::loops(shape) => |circuit, _| { open_shares[circuit] = self.open_share::<S>(shape, circuit, connected); });
        let (mut rate_w_k, mut open, mut valve) =
            ([0.0; BRANCH_PLACES], [1.0; BRANCH_PLACES], [0.0; BRANCH_PLACES]);
        each!(S::branches(shape) => |i, branch| {
            let circuit = usize::from(branch.circuit);
            rate_w_k[i] = flows.rates_w_k[circuit];
            open[i] = if branch.series { 1.0 } else { open_shares[circuit] };
            valve[i] = demand.0[usize::from(branch.valve_row)];
        });
        let places = shape.branch_places().min(BRANCH_PLACES);
        let mut coolant_w_k = [0.0; BRANCH_PLACES];
        for i in 0..places {
            let flow_share = self.flow_share[i] / open[i];
            coolant_w_k[i] =
                rate_w_k[i] * flow_share * (self.valve_closed[i] + valve[i] * self.valve_span[i]);
        }
        coolant_w_k
    }

    /// Largest conductance of each branch between its two inlet temperatures [W/K] (effectiveness-NTU); 0 where it is
    /// not connected.
    #[inline(always)]
    pub fn largest_conductances_w_k<S: Shape>(
        &self,
        shape: &Indices<'_>,
        flows: &BranchFlows,
        front: &FrontAirs,
        connected: &Connected,
        coolant_w_k: &BranchValues,
    ) -> BranchValues {
        let places = shape.branch_places().min(BRANCH_PLACES);
        let mut largest_w_k = [0.0; BRANCH_PLACES];
        for i in 0..places {
            largest_w_k[i] = inlet_conductance_w_k(coolant_w_k[i], self.coolant_ua_w_k[i]);
        }
        self.enter_cores::<S>(shape, flows, connected, coolant_w_k, &mut largest_w_k);
        each!(S::branches(shape) => |i, branch| {
            if let BranchSide::Plate(from) = branch.side {
                let from_w_k = flows.rates_w_k[from];
                largest_w_k[i] = counterflow_conductance_w_k(coolant_w_k[i], from_w_k, self.plate_ua_w_k[i]);
            }
            if let BranchSide::Ambient(end) = branch.side
                && connected[i]
            {
                let air = &front.airs[end];
                let share = if branch.out_of_loop { 1.0 } else { air.source_share };
                largest_w_k[i] = share * air.to_coolant_w_k(coolant_w_k[i]);
            }
        });
        for i in 0..places {
            largest_w_k[i] = if connected[i] { largest_w_k[i] } else { 0.0 };
        }
        largest_w_k
    }

    #[inline(always)]
    fn enter_cores<S: Shape>(
        &self,
        shape: &Indices<'_>,
        flows: &BranchFlows,
        connected: &Connected,
        coolant_w_k: &BranchValues,
        largest_w_k: &mut BranchValues,
    ) {
        each!(S::cabins(shape) => |place, cabin| {
            // A cabin is connected to one loop at most.
            let cooler = cabin.cooler.filter(|&cooler| connected[cooler]);
            let core = cooler.map(|cooler| (cooler, self.cooler_ua_w_k[place]));
            let core = core.or(cabin.heater.map(|heater| (heater, self.heater_ua_w_k[place])));
            if let Some((core, core_ua_w_k)) = core {
                let air_w_k = flows.ventilation[place].supply_rate_w_k;
                largest_w_k[core] = counterflow_conductance_w_k(coolant_w_k[core], air_w_k, core_ua_w_k);
            }
        });
    }
}

/// Temperature differences that drive the branches in their right direction [K].
#[must_use]
#[inline(always)]
pub fn differences_k<S: Shape>(shape: &Indices<'_>, temperatures: &BranchTemperatures) -> BranchValues {
    let mut differences_k = [0.0; BRANCH_PLACES];
    each!(S::branches(shape) => |i, branch| { differences_k[i] = difference_of(shape, branch, temperatures); });
    differences_k
}

/// Temperature difference that drives a branch in its right direction [K].
#[must_use]
#[inline(always)]
pub fn difference_of(shape: &Indices<'_>, branch: &BranchIndices, temperatures: &BranchTemperatures) -> f64 {
    let circuit = usize::from(branch.circuit);
    let loop_k = if branch.series {
        temperatures.behind_exchanger_k[circuit]
    } else {
        temperatures.nodes_k[shape.loops[circuit].supply.index()]
    };
    let own_k = match branch.side {
        BranchSide::Mass(node) => temperatures.nodes_k[node.index()],
        BranchSide::Ambient(end) => temperatures.front_end_air_k[end],
        BranchSide::Core(cabin) => temperatures.core_inlet_k[cabin],
        BranchSide::Plate(from) => temperatures.nodes_k[shape.loops[from].back.index()],
    };
    if branch.out_of_loop { loop_k - own_k } else { own_k - loop_k }
}

/// Coolant side of a branch's exchanger [W/K]; none where air or another coolant is on the other side.
fn exchanger(vehicle: &VehicleParameters, place: usize) -> f64 {
    let layout = &*vehicle.layout;
    let branch = layout.branches[place];
    match branch.side {
        BranchSide::Core(_) | BranchSide::Plate(_) | BranchSide::Ambient(_) => 0.0,
        BranchSide::Mass(_) => {
            let passive = |mass: &&MassLayout| layout.members[mass.member].kind.data().read.is_some();
            let store = layout.masses.iter().filter(passive).position(|mass| mass.member == branch.member);
            match layout.members[branch.member].kind {
                MemberKind::Battery => vehicle.battery.coolant_ua_w_k,
                MemberKind::Motor => vehicle.motor.coolant_ua_w_k,
                MemberKind::Transmission => vehicle.transmission.coolant_ua_w_k,
                _ => store.map_or(0.0, |store| vehicle.stores[store].coolant_ua_w_k),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::architecture::indices::OwnedIndices;
    use crate::network::planned::Planned;
    use std::array::from_fn;

    #[test]
    fn every_branch_is_driven_by_its_member_and_its_loop() {
        let vehicle = VehicleParameters::load("jeffs2019", &[]).expect("built in");
        let layout = &vehicle.layout;
        let nodes_k = from_fn(|node| 2.0_f64.powi(node as i32));
        let (ambient_k, core_k, behind_exchanger_k) = (1e12, 1e13, [1e14, 1e15, 1e16, 1e17]);
        let temperatures = BranchTemperatures {
            nodes_k,
            front_end_air_k: [ambient_k; FRONT_END_PLACES],
            core_inlet_k: [core_k; CABIN_PLACES],
            behind_exchanger_k,
        };
        let own = OwnedIndices::of(layout);
        let differences_k = differences_k::<Planned>(&own.view(), &temperatures);
        for (place, branch) in layout.branches.iter().enumerate() {
            let member_k = match layout.members[branch.member].name.as_str() {
                "ambient" => ambient_k,
                "cabin" => core_k,
                _ => nodes_k[layout.members[branch.member].node.expect("a mass").index()],
            };
            let expected = match layout.loops[branch.circuit].name.as_str() {
                "htc" if branch.series => member_k - behind_exchanger_k[0],
                "htc" => nodes_k[layout.loops[0].supply.index()] - member_k,
                _ => member_k - nodes_k[layout.loops[1].supply.index()],
            };
            assert_eq!(differences_k[place], expected, "branch {place}");
        }
    }
}
