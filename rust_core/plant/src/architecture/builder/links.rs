//! Links of the thermal network with the flows that they carry.

use super::Builder;
use crate::architecture::flows::{Crossing, Flow};
use crate::architecture::layout::{BranchLayout, BranchSide, LoopLayout, MassLayout, MemberLayout};
use crate::architecture::wiring::Law;
use crate::numerics::graph::{LinkPorts, Node};

impl Builder<'_> {
    /// Links with the flows that they carry, in the order in which both are listed.
    pub(super) fn add_links(&mut self) {
        self.add_loop_links();
        for branch in 0..self.layout.branches.len() {
            self.add_branch_links(branch);
        }
        self.for_each_member(|builder, kind, member| (kind.add_loop_links)(builder, member));
        for mass in 0..self.layout.masses.len() {
            let MassLayout { member, node } = self.layout.masses[mass];
            let MemberLayout { name, label, .. } = &self.layout.members[member];
            let (column, text) =
                (format!("{name}_ambient_heat_flow_w"), format!("From the {label} to ambient."));
            let flow = self.flow(column, text, Crossing::Leaves);
            self.link(LinkPorts::to_surroundings(node), Law::MassToAmbient(mass as u8), flow);
        }
        self.for_each_member(|builder, kind, member| (kind.add_links)(builder, member));
    }

    fn add_loop_links(&mut self) {
        let count = self.layout.loops.len();
        for place in 0..count {
            let LoopLayout { name, label, supply, back, .. } = self.layout.loops[place].clone();
            let text = format!("Coolant flow of the {label}, supply to return side; internal.");
            let flow = self.flow(format!("{name}_advection_w"), text, Crossing::Inside);
            self.link(LinkPorts::between(supply, back), Law::Advection(place as u8), flow);
        }
        for place in 0..count {
            let LoopLayout { name, label, supply, back, .. } = self.layout.loops[place].clone();
            for (end, node) in [("supply", supply), ("return", back)] {
                let text = format!("Hoses of the {label}'s {end} to ambient.");
                let flow = self.flow(format!("{name}_{end}_hose_heat_flow_w"), text, Crossing::Leaves);
                self.link(LinkPorts::to_surroundings(node), Law::Hose(place as u8), flow);
            }
        }
    }

    fn add_branch_links(&mut self, place: usize) {
        let branch = self.layout.branches[place];
        let circuit = self.layout.loops[branch.circuit].clone();
        let member = self.layout.members[branch.member].clone();
        let (from, to) = if branch.out_of_loop {
            (&circuit.label, &member.label)
        } else {
            (&member.label, &circuit.label)
        };
        let crossing = match (branch.side, branch.out_of_loop) {
            (BranchSide::Ambient(_), true) => Crossing::Leaves,
            (BranchSide::Ambient(_), false) => Crossing::Enters,
            _ => Crossing::Inside,
        };
        let column = format!("{}_{}_heat_flow_w", member.name, circuit.name);
        let flow = self.flow(column, format!("From {from} to {to}."), crossing);
        self.layout.branches[place].flow = flow;
        let (law, own) = self.branch_law(place as u8, &branch);
        if branch.series {
            self.add_series_links(place, (law, own), flow);
        } else {
            self.add_parallel_link(&branch, &circuit, (law, own), flow);
        }
    }

    /// The supply drives it, the return takes or gives the heat.
    fn add_parallel_link(
        &mut self,
        branch: &BranchLayout,
        circuit: &LoopLayout,
        (law, own): (Law, Option<Node>),
        flow: Flow,
    ) {
        let other = match branch.side {
            BranchSide::Plate(from) => Some((self.layout.loops[from].back, self.layout.loops[from].supply)),
            _ => own.map(|node| (node, node)),
        };
        let (drives, exchanges) = (other.map(|ends| ends.0), other.map(|ends| ends.1));
        let ports = if branch.out_of_loop {
            LinkPorts { loses: Some(circuit.back), gains: exchanges, hot: Some(circuit.supply), cold: drives }
        } else {
            LinkPorts { loses: exchanges, gains: Some(circuit.back), hot: drives, cold: Some(circuit.supply) }
        };
        self.link(ports, law, flow);
    }

    /// Return and all members before it in the series drive it, each by its weight.
    fn add_series_links(&mut self, place: usize, (law, own): (Law, Option<Node>), flow: Flow) {
        let branch = self.layout.branches[place];
        let circuit = self.layout.loops[branch.circuit].clone();
        let before: Vec<Node> = circuit
            .series
            .iter()
            .take_while(|&&other| other != place)
            .filter_map(|&other| match self.layout.branches[other].side {
                BranchSide::Mass(node) => Some(node),
                _ => None,
            })
            .collect();
        let ports = |drives: Node, member: Option<Node>| {
            if branch.out_of_loop {
                LinkPorts { loses: Some(circuit.supply), gains: own, hot: Some(drives), cold: member }
            } else {
                LinkPorts { loses: own, gains: Some(circuit.supply), hot: member, cold: Some(drives) }
            }
        };
        if before.is_empty() {
            self.link(ports(circuit.back, own), law, flow);
            return;
        }
        let weight = self.layout.series_weight(branch.circuit, before.len());
        self.link(
            ports(circuit.back, own),
            Law::SeriesReturn(place as u8, weight as u8, branch.out_of_loop),
            flow,
        );
        for (k, node) in before.into_iter().enumerate() {
            let weight = (weight + 1 + k) as u8;
            self.link(ports(node, None), Law::SeriesBefore(place as u8, weight, branch.out_of_loop), flow);
        }
    }

    fn branch_law(&self, place: u8, branch: &BranchLayout) -> (Law, Option<Node>) {
        match (branch.side, branch.out_of_loop) {
            (BranchSide::Mass(node), _) => (Law::Branch(place), Some(node)),
            (BranchSide::Plate(_), _) => (Law::Branch(place), None),
            (BranchSide::Core(cabin), true) => {
                (Law::HeaterCore(place, cabin as u8), Some(self.layout.cabins[cabin].air))
            }
            (BranchSide::Core(cabin), false) => {
                (Law::CoolingCore(place, cabin as u8), Some(self.layout.cabins[cabin].air))
            }
            (BranchSide::Ambient(end), out_of_loop) => {
                let law = if out_of_loop { Law::BranchToAir } else { Law::BranchFromAir };
                (law(place, end as u8), None)
            }
        }
    }
}
