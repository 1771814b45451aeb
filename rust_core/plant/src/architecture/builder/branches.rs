//! Branches between members and loops, and the options that they give the members.

use super::Builder;
use crate::architecture::declaration::{Direction, Side};
use crate::architecture::flows::Flow;
use crate::architecture::kind::Meets;
use crate::architecture::layout::{BranchLayout, BranchSide};

impl Builder<'_> {
    pub(super) fn add_branches(&mut self) {
        let declaration = self.declaration;
        for (place, declared) in declaration.branches.iter().enumerate() {
            let (Some(member), Some(circuit)) =
                (declaration.member(&declared.member), declaration.circuit(&declared.circuit))
            else {
                continue;
            };
            let hot = declaration.loops[circuit].side == Side::Hot;
            let out_of_loop = match declared.direction {
                Some(direction) => direction == Direction::OutOfLoop,
                None => hot,
            };
            let side = self.branch_side(member);
            if let BranchSide::Core(cabin) = side {
                let core = if out_of_loop {
                    &mut self.layout.cabins[cabin].heater
                } else {
                    &mut self.layout.cabins[cabin].cooler
                };
                *core = Some(place);
            }
            if declared.series {
                self.layout.loops[circuit].series.push(place);
            }
            self.layout.branches.push(BranchLayout {
                member,
                circuit,
                option: 0,
                series: declared.series,
                out_of_loop,
                side,
                flow: Flow::AUXILIARY,
            });
        }
        for member in 0..self.layout.members.len() {
            self.add_options(member);
        }
    }

    pub(super) fn branch_side(&self, member: usize) -> BranchSide {
        let layout = &self.layout;
        match layout.members[member].kind.data().meets {
            Meets::SupplyAir => BranchSide::Core(self.cabin_place(member)),
            Meets::AmbientAir => BranchSide::Ambient(
                layout.front_ends.iter().position(|end| end.member == member).unwrap_or(0),
            ),
            Meets::OtherLoop => BranchSide::Plate(layout.members[member].from.unwrap_or(0)),
            Meets::Mass => BranchSide::Mass(layout.members[member].node.unwrap_or(layout.battery)),
        }
    }

    fn add_options(&mut self, member: usize) {
        let declaration = self.declaration;
        let declared = &declaration.members[member];
        let loops: Vec<usize> = match &declared.options {
            Some(names) => names.iter().filter_map(|name| declaration.circuit(name)).collect(),
            None => declaration
                .loops_of(&declared.name)
                .into_iter()
                .filter_map(|n| declaration.circuit(n))
                .collect(),
        };
        for circuit in loops {
            if let Some(branch) = self.layout.branch(member, circuit) {
                self.layout.members[member].options.push(branch);
                self.layout.branches[branch].option = self.layout.members[member].options.len();
            }
        }
    }
}
