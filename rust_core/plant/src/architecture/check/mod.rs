//! Whether what an architecture says makes sense: names, numbers of each kind, and that nothing is there without a use.

mod branches;
mod machines;
mod members;

use super::declaration::{Declaration, MemberDeclaration, VEHICLE_SECTIONS};
use super::flaw::{Flaw, among};

impl Declaration {
    /// Checks names, and that everything has its place.
    ///
    /// # Errors
    /// The first flaw.
    pub fn check(&self) -> Result<(), Flaw> {
        self.check_names()?;
        self.check_kinds()?;
        self.check_members()?;
        self.check_branches()?;
        self.check_exchangers()?;
        self.check_heaters()?;
        self.check_air_streams()?;
        self.check_connected()
    }

    fn check_names(&self) -> Result<(), Flaw> {
        let groups: [(&str, Vec<&String>); 5] = [
            ("loop", self.loops.iter().map(|item| &item.name).collect()),
            ("exchanger", self.exchangers.iter().map(|item| &item.name).collect()),
            ("heater", self.heaters.iter().map(|item| &item.name).collect()),
            ("member", self.members.iter().map(|item| &item.name).collect()),
            ("air_stream", self.air_streams.iter().map(|item| &item.name).collect()),
        ];
        let mut seen: Vec<&String> = Vec::new();
        for (group, names) in groups {
            for (i, name) in names.into_iter().enumerate() {
                let key = format!("{group}[{i}].name");
                let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
                if !name.starts_with(|c: char| c.is_ascii_lowercase()) || !name.chars().all(plain) {
                    return Err(Flaw::new(
                        key,
                        format!("`{name}`"),
                        "must be of a-z, 0-9 and _, a letter first",
                    ));
                }
                if seen.contains(&name) {
                    return Err(Flaw::new(key, format!("`{name}`"), "must be the name of one thing only"));
                }
                let reserved =
                    VEHICLE_SECTIONS.contains(&name.as_str()) && !(group == "member" && name == "battery");
                if reserved {
                    return Err(Flaw::new(
                        key,
                        format!("`{name}`"),
                        "must not be that of a section of every vehicle",
                    ));
                }
                seen.push(name);
            }
        }
        Ok(())
    }

    /// Nothing is there without a use: loops have branches, members other than masses are reached.
    fn check_connected(&self) -> Result<(), Flaw> {
        for (i, circuit) in self.loops.iter().enumerate() {
            let branches = self.branches.iter().any(|branch| branch.circuit == circuit.name);
            if !branches {
                return Err(Flaw::new(
                    format!("loop[{i}]"),
                    format!("`{}` without a branch", circuit.name),
                    "must have at least one",
                ));
            }
        }
        for (i, member) in self.members.iter().enumerate() {
            let branches = self.branches.iter().any(|branch| branch.member == member.name);
            let air = self.exchangers.iter().any(|exchanger| exchanger.air.as_ref() == Some(&member.name));
            let heated = self.heaters.iter().any(|heater| heater.heats == member.name);
            if member.kind.data().needs_link && !branches && !air && !heated {
                let found = format!("`{}` without any link", member.name);
                return Err(Flaw::new(
                    format!("member[{i}]"),
                    found,
                    "must have a branch, an exchanger or a heater",
                ));
            }
        }
        Ok(())
    }

    fn known_loop(&self, key: String, name: &str) -> Result<usize, Flaw> {
        let names: Vec<&str> = self.loops.iter().map(|circuit| circuit.name.as_str()).collect();
        self.circuit(name).ok_or_else(|| Flaw::new(key, format!("`{name}`"), among(&names, name)))
    }

    fn known_member(
        &self,
        key: String,
        name: &str,
        fits: impl Fn(&MemberDeclaration) -> bool,
    ) -> Result<usize, Flaw> {
        let names: Vec<&str> =
            self.members.iter().filter(|member| fits(member)).map(|member| member.name.as_str()).collect();
        match self.member(name) {
            Some(place) if fits(&self.members[place]) => Ok(place),
            _ => Err(Flaw::new(key, format!("`{name}`"), among(&names, name))),
        }
    }
}
