//! Members: how many of a kind, and what each says beyond its kind.

use crate::architecture::declaration::{Declaration, MemberDeclaration, MemberKind, Side, VEHICLE_SECTIONS};
use crate::architecture::flaw::Flaw;
use crate::architecture::kind::{Count, Key};

impl Declaration {
    pub(super) fn check_kinds(&self) -> Result<(), Flaw> {
        for &kind in MemberKind::ALL {
            let (word, count) = (kind.data().word, self.of_kind(kind).count());
            if kind.data().count == Count::Once && count != 1 {
                let found = format!("there {count} times as kind `{word}`");
                return Err(Flaw::new("member", found, "must be there once"));
            }
            if kind.data().count == Count::AtLeastOnce && count == 0 {
                let allowed = format!("must have one of kind `{word}`");
                return Err(Flaw::new("member", format!("without a {word}"), allowed));
            }
        }
        let rooms: Vec<&MemberDeclaration> =
            self.members.iter().filter(|member| member.kind.data().takes(Key::Comfort)).collect();
        let comfortable = rooms.iter().filter(|member| member.comfort).count();
        if rooms.len() > 1 && comfortable != 1 {
            let found = format!("true for {comfortable} of {} cabins", rooms.len());
            let allowed = "must be true for the one that counts for comfort";
            return Err(Flaw::new("member.comfort", found, allowed));
        }
        Ok(())
    }

    pub(super) fn check_members(&self) -> Result<(), Flaw> {
        for (i, member) in self.members.iter().enumerate() {
            let key = |key: &str| format!("member[{i}].{key}");
            self.check_section(i, member)?;
            check_keys(i, member)?;
            if let Some(name) = &member.exhaust_recovery {
                let circuit = self.known_loop(key("exhaust_recovery"), name)?;
                if self.loops[circuit].side == Side::Hot {
                    return Err(Flaw::new(
                        key("exhaust_recovery"),
                        format!("`{name}`"),
                        "must be a cold loop",
                    ));
                }
            }
            if let Some(name) = &member.from {
                self.known_loop(key("from"), name)?;
            }
            self.check_options(i, member)?;
        }
        Ok(())
    }

    /// Options are the loops of a member's branches in another order.
    fn check_options(&self, place: usize, member: &MemberDeclaration) -> Result<(), Flaw> {
        let Some(options) = &member.options else { return Ok(()) };
        let key = || format!("member[{place}].options");
        for name in options {
            self.known_loop(key(), name)?;
        }
        let mut own: Vec<&str> = self.loops_of(&member.name);
        let mut given: Vec<&str> = options.iter().map(String::as_str).collect();
        own.sort_unstable();
        given.sort_unstable();
        if own != given {
            let allowed = format!("must name the loops of its branches, each once: {}", own.join(", "));
            return Err(Flaw::new(key(), format!("{options:?}"), allowed));
        }
        Ok(())
    }

    /// A member's section is its own.
    fn check_section(&self, place: usize, member: &MemberDeclaration) -> Result<(), Flaw> {
        let Some(section) = &member.section else { return Ok(()) };
        let others = self.members.iter().enumerate().filter(|(other, _)| *other != place);
        let others = others.map(|(_, other)| other.section());
        let loops = self.loops.iter().map(|circuit| circuit.name.as_str());
        let heaters = self.heaters.iter().map(|heater| heater.name.as_str());
        let streams = self.air_streams.iter().map(|stream| stream.name.as_str());
        let reserved = VEHICLE_SECTIONS.iter().copied();
        let mut taken = others.chain(loops).chain(heaters).chain(streams).chain(reserved);
        if taken.any(|other| other == section) {
            let key = format!("member[{place}].section");
            return Err(Flaw::new(
                key,
                format!("`{section}`"),
                "must be a section that belongs to nothing else",
            ));
        }
        Ok(())
    }
}

/// Keys that its kind does not have are left out; those that it needs are there.
fn check_keys(place: usize, member: &MemberDeclaration) -> Result<(), Flaw> {
    let kind = member.kind.data();
    for (key, name, given) in [
        (Key::Comfort, "comfort", member.comfort.then_some("true")),
        (Key::ExhaustRecovery, "exhaust_recovery", member.exhaust_recovery.as_ref().map(|_| "given")),
        (Key::From, "from", member.from.as_ref().map(|_| "given")),
    ] {
        if let (Some(found), false) = (given, kind.takes(key)) {
            let takers: Vec<&str> = MemberKind::ALL
                .iter()
                .map(|kind| kind.data())
                .filter(|kind| kind.takes(key))
                .map(|kind| kind.word)
                .collect();
            let allowed = format!("must be left out for what is no {}", takers.join(" or "));
            return Err(Flaw::new(format!("member[{place}].{name}"), found, allowed));
        }
    }
    if kind.takes(Key::From) && member.from.is_none() {
        let allowed = "must name the loop that the plate cools or heats";
        return Err(Flaw::new(format!("member[{place}].from"), "missing", allowed));
    }
    Ok(())
}
