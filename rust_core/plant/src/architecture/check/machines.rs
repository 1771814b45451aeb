//! Exchangers of the refrigerant loop, heaters and shared air.

use crate::architecture::declaration::{Declaration, ExchangerDeclaration, Level, MemberDeclaration, Side};
use crate::architecture::flaw::{Flaw, among};
use crate::architecture::kind::Meets;

impl Declaration {
    pub(super) fn check_exchangers(&self) -> Result<(), Flaw> {
        for (i, exchanger) in self.exchangers.iter().enumerate() {
            let key = |key: &str| format!("exchanger[{i}].{key}");
            match (&exchanger.circuit, &exchanger.air) {
                (Some(name), None) => {
                    let circuit = self.known_loop(key("loop"), name)?;
                    let side = if exchanger.level == Level::Condensing { Side::Hot } else { Side::Cold };
                    if self.loops[circuit].side != side {
                        let allowed = "must be a hot loop for a condenser, a cold one for an evaporator";
                        return Err(Flaw::new(key("loop"), format!("`{name}`"), allowed));
                    }
                    let same = |other: &ExchangerDeclaration| other.circuit.as_ref() == Some(name);
                    if self.exchangers[..i].iter().any(same) {
                        return Err(Flaw::new(
                            key("loop"),
                            format!("`{name}`"),
                            "must be a loop without another exchanger",
                        ));
                    }
                }
                (None, Some(name)) => {
                    let airy = |member: &MemberDeclaration| member.kind.data().has_air();
                    self.known_member(key("air"), name, airy)?;
                    let same = |other: &ExchangerDeclaration| {
                        other.level == exchanger.level && other.air.as_ref() == Some(name)
                    };
                    if self.exchangers[..i].iter().any(same) {
                        let allowed = "must be air without another exchanger of the same level";
                        return Err(Flaw::new(key("air"), format!("`{name}`"), allowed));
                    }
                }
                _ => {
                    let found =
                        if exchanger.air.is_some() { "given beside `loop`" } else { "missing, like `loop`" };
                    return Err(Flaw::new(
                        key("air"),
                        found,
                        "exactly one of `loop` and `air` must be given",
                    ));
                }
            }
        }
        self.check_levels()
    }

    /// Names and numbers of exchangers on each pressure level.
    fn check_levels(&self) -> Result<(), Flaw> {
        let count =
            |level: Level| self.exchangers.iter().filter(|exchanger| exchanger.level == level).count();
        if (count(Level::Condensing) == 0) != (count(Level::Evaporating) == 0) {
            let found =
                format!("{} condensing, {} evaporating", count(Level::Condensing), count(Level::Evaporating));
            return Err(Flaw::new("exchanger.level", found, "must be there on both levels, or on none"));
        }
        for (i, exchanger) in self.exchangers.iter().enumerate() {
            let total = if exchanger.level == Level::Condensing { "condenser" } else { "evaporator" };
            let carries_all = count(exchanger.level) == 1 && exchanger.circuit.is_some();
            if exchanger.name == total && !carries_all {
                let allowed = format!(
                    "must be another name: `{total}_heat_flow_w` is the total of all, and only in a loop and alone on its \
                     level an exchanger is that"
                );
                return Err(Flaw::new(format!("exchanger[{i}].name"), format!("`{total}`"), allowed));
            }
        }
        Ok(())
    }

    pub(super) fn check_heaters(&self) -> Result<(), Flaw> {
        for (i, heater) in self.heaters.iter().enumerate() {
            if self.circuit(&heater.heats).is_some() {
                continue;
            }
            let masses =
                self.members.iter().filter(|member| member.has_mass()).map(|member| member.name.as_str());
            let names: Vec<&str> =
                self.loops.iter().map(|circuit| circuit.name.as_str()).chain(masses).collect();
            if !names.contains(&heater.heats.as_str()) {
                let found = format!("`{}`", heater.heats);
                return Err(Flaw::new(format!("heater[{i}].heats"), found, among(&names, &heater.heats)));
            }
        }
        Ok(())
    }

    pub(super) fn check_air_streams(&self) -> Result<(), Flaw> {
        let mut used: Vec<&String> = Vec::new();
        for (i, stream) in self.air_streams.iter().enumerate() {
            for name in &stream.through {
                let key = format!("air_stream[{i}].through");
                self.known_member(key.clone(), name, |member| member.kind.data().meets == Meets::AmbientAir)?;
                if used.contains(&name) {
                    return Err(Flaw::new(
                        key,
                        format!("with `{name}` twice"),
                        "must name each exchanger once",
                    ));
                }
                used.push(name);
            }
            if stream.through.len() < 2 {
                let found = format!("{:?}", stream.through);
                return Err(Flaw::new(
                    format!("air_stream[{i}].through"),
                    found,
                    "must name at least two exchangers",
                ));
            }
        }
        Ok(())
    }
}
