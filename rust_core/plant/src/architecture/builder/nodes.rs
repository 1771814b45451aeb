//! Nodes of an architecture: those of its loops, then those of its members, kind by kind.

use super::{Builder, label};
use crate::architecture::declaration::MemberKind;
use crate::architecture::flows::Flow;
use crate::architecture::kind::Meets;
use crate::architecture::layout::{LoopLayout, MassLayout, MemberLayout};

impl Builder<'_> {
    /// Loops, then members by kind.
    pub(super) fn add_nodes(&mut self) {
        let declaration = self.declaration;
        for circuit in &declaration.loops {
            let label = label(circuit.label.as_ref(), &circuit.name);
            let supply =
                self.node(format!("{}_supply", circuit.name), format!("{label} before its branches"));
            let back = self.node(format!("{}_return", circuit.name), format!("{label} behind its branches"));
            self.layout.loops.push(LoopLayout {
                name: circuit.name.clone(),
                label,
                side: circuit.side,
                supply,
                back,
                series: Vec::new(),
                pump_flow: Flow::AUXILIARY,
                flow_row: 0,
                exchanger: None,
            });
        }
        for member in &declaration.members {
            self.layout.members.push(MemberLayout {
                name: member.name.clone(),
                label: label(member.label.as_ref(), &member.name),
                kind: member.kind,
                section: member.section().to_owned(),
                node: None,
                options: Vec::new(),
                connection_row: None,
                request_row: None,
                valve_row: None,
                from: member.from.as_ref().and_then(|name| declaration.circuit(name)),
            });
        }
        self.for_each_member(|builder, kind, member| {
            if kind.meets == Meets::Mass {
                builder.add_mass(member);
            }
            (kind.add_nodes)(builder, member);
        });
    }

    /// A member that is one mass.
    fn add_mass(&mut self, member: usize) {
        let MemberLayout { name, label, kind, .. } = self.layout.members[member].clone();
        let node = self.node(name, label);
        self.layout.members[member].node = Some(node);
        self.layout.masses.push(MassLayout { member, node });
        match kind {
            MemberKind::Battery => self.layout.battery = node,
            MemberKind::Motor => self.layout.motor = node,
            MemberKind::Transmission => self.layout.transmission = node,
            _ => {}
        }
    }
}
