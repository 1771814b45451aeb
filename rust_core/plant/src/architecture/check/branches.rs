//! Branches.

use crate::architecture::declaration::{BranchDeclaration, Declaration, Direction, Side};
use crate::architecture::flaw::Flaw;
use crate::architecture::kind::Meets;

impl Declaration {
    pub(super) fn check_branches(&self) -> Result<(), Flaw> {
        for (i, branch) in self.branches.iter().enumerate() {
            let key = |key: &str| format!("branch[{i}].{key}");
            let member = &self.members[self.known_member(key("member"), &branch.member, |_| true)?];
            self.known_loop(key("loop"), &branch.circuit)?;
            let same =
                |other: &BranchDeclaration| other.member == branch.member && other.circuit == branch.circuit;
            if self.branches[..i].iter().any(same) {
                let found = format!("`{}` in `{}` again", branch.member, branch.circuit);
                return Err(Flaw::new(key("member"), found, "must be in each loop once at most"));
            }
            let out_of_loop = |branch: &BranchDeclaration| match branch.direction {
                Some(direction) => direction == Direction::OutOfLoop,
                None => self.loops.iter().any(|c| c.name == branch.circuit && c.side == Side::Hot),
            };
            let before = self.branches[..i]
                .iter()
                .find(|other| other.member == branch.member && out_of_loop(other) == out_of_loop(branch));
            if let (Meets::SupplyAir, Some(other)) = (member.kind.data().meets, before) {
                let found = format!("`{}` beside `{}`", branch.circuit, other.circuit);
                let allowed = "a cabin must have one heater core and one cooling core at most";
                return Err(Flaw::new(key("loop"), found, allowed));
            }
            if branch.series && member.kind.data().meets != Meets::Mass {
                return Err(Flaw::new(
                    key("series"),
                    "true",
                    "must be false for what has no thermal mass of its own",
                ));
            }
            if member.from.as_deref() == Some(&branch.circuit) {
                let found = format!("`{}`", branch.circuit);
                return Err(Flaw::new(
                    key("loop"),
                    found,
                    "must not be the loop that the plate comes from: it would connect a loop with itself",
                ));
            }
        }
        Ok(())
    }
}
