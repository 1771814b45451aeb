//! What an architecture's file says, by name, and whether it makes sense.

use serde::Deserialize;
use std::fmt;

/// What is wrong with an architecture; the loader adds the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Flaw {
    /// Dotted path of the key.
    pub key: String,
    /// Value found.
    pub value: String,
    /// What is allowed, as "must be ...".
    pub allowed: String,
}

impl Flaw {
    /// A flaw at `key`.
    pub fn new(key: impl Into<String>, value: impl ToString, allowed: impl Into<String>) -> Self {
        Self { key: key.into(), value: value.to_string(), allowed: allowed.into() }
    }
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` is {}, but {}", self.key, self.value, self.allowed)
    }
}

/// Which way a loop or a pressure level moves heat.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// It heats.
    Hot,
    /// It cools.
    Cold,
}

/// A coolant loop.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoopDeclaration {
    /// Name; the vehicle's section of that name holds its numbers.
    pub name: String,
    /// Name in texts.
    pub label: Option<String>,
    /// What its branches do unless they say otherwise.
    pub side: Side,
}

/// What a member of the architecture is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MemberKind {
    /// The traction battery; there is one.
    Battery,
    /// Motor and inverter; there is one.
    Motor,
    /// Transmission and driveline; there is one.
    Transmission,
    /// Exchanger with ambient air at the front end.
    FrontEnd,
    /// Sensible heat store.
    Store,
    /// Cabin: air, exhaust volume, soft and hard furnishings.
    Cabin,
    /// Liquid-to-liquid plate between two loops.
    Plate,
}

/// Something that coolant or refrigerant can reach.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemberDeclaration {
    /// Name, used for columns and actuators.
    pub name: String,
    /// What it is.
    pub kind: MemberKind,
    /// Name in texts.
    pub label: Option<String>,
    /// The vehicle's section with its numbers, where that has another name.
    pub section: Option<String>,
    /// Loops in the order of its actuator's options, where not that of its branches.
    pub options: Option<Vec<String>>,
    /// Loop that a cabin's exhaust heat goes into.
    pub exhaust_recovery: Option<String>,
    /// Loop that a plate cools or heats.
    pub from: Option<String>,
    /// Whether this cabin counts for comfort; needed where there are several.
    #[serde(default)]
    pub comfort: bool,
}

/// Which way a branch moves heat.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// From the member into the loop.
    IntoLoop,
    /// From the loop into the member.
    OutOfLoop,
}

/// A member's place in a loop.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BranchDeclaration {
    /// Member.
    pub member: String,
    /// Loop.
    #[serde(rename = "loop")]
    pub circuit: String,
    /// In series with the loop's exchanger, in the order of the file, instead of parallel to other branches.
    #[serde(default)]
    pub series: bool,
    /// Way of the heat, where not that of the loop's side.
    pub direction: Option<Direction>,
}

/// Pressure level of the refrigerant loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize)]
#[serde(try_from = "String")]
pub enum Level {
    /// High pressure: gives heat.
    Condensing,
    /// Low pressure: takes heat.
    Evaporating,
}

impl TryFrom<String> for Level {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        match name.as_str() {
            "condensing" => Ok(Self::Condensing),
            "evaporating" => Ok(Self::Evaporating),
            _ => Err(format!(
                "`{name}` is no pressure level; there are `condensing` and `evaporating` (a second evaporating \
                 pressure is not modelled)"
            )),
        }
    }
}

/// An exchanger of the refrigerant loop.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExchangerDeclaration {
    /// Name.
    pub name: String,
    /// Pressure level.
    pub level: Level,
    /// Coolant loop on its other side.
    #[serde(rename = "loop")]
    pub circuit: Option<String>,
    /// Cabin or front-end exchanger whose air is on its other side.
    pub air: Option<String>,
    /// Whether it can be closed.
    #[serde(default)]
    pub valve: bool,
}

/// A heater.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeaterDeclaration {
    /// Name; the vehicle's section of that name holds its numbers.
    pub name: String,
    /// Name in texts.
    pub label: Option<String>,
    /// Loop (at the end of its series part) or member with a thermal mass; a cabin's is its air.
    pub heats: String,
}

/// Front-end exchangers that share air and fan.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AirStreamDeclaration {
    /// Name; the vehicle's section of that name holds its numbers.
    pub name: String,
    /// Front-end exchangers in the order in which the air meets them.
    pub through: Vec<String>,
}

/// An architecture's file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Declaration {
    /// What it is, in a sentence.
    pub description: String,
    /// Coolant loops.
    #[serde(default, rename = "loop")]
    pub loops: Vec<LoopDeclaration>,
    /// Exchangers of the refrigerant loop; without any there is no such loop.
    #[serde(default, rename = "exchanger")]
    pub exchangers: Vec<ExchangerDeclaration>,
    /// Heaters.
    #[serde(default, rename = "heater")]
    pub heaters: Vec<HeaterDeclaration>,
    /// Members, in the order of their actuators.
    #[serde(default, rename = "member")]
    pub members: Vec<MemberDeclaration>,
    /// Branches.
    #[serde(default, rename = "branch")]
    pub branches: Vec<BranchDeclaration>,
    /// Shared air.
    #[serde(default, rename = "air_stream")]
    pub air_streams: Vec<AirStreamDeclaration>,
}

/// Sections of a vehicle that belong to no member.
pub const VEHICLE_SECTIONS: [&str; 5] = ["body", "regeneration", "battery", "refrigeration", "controls"];

impl MemberDeclaration {
    /// Section of the vehicle that holds its numbers.
    #[must_use]
    pub fn section(&self) -> &str {
        // The battery has one in every vehicle.
        if self.kind == MemberKind::Battery {
            return "battery";
        }
        self.section.as_deref().unwrap_or(&self.name)
    }

    /// Whether it has a temperature of its own.
    #[must_use]
    pub fn has_mass(&self) -> bool {
        !matches!(self.kind, MemberKind::FrontEnd | MemberKind::Plate)
    }
}

/// A name among others, as "must be one of ... (nearest: ...)".
#[must_use]
pub fn among(names: &[&str], wanted: &str) -> String {
    let nearest =
        names.iter().map(|name| (similarity(name, wanted), name)).max_by(|a, b| a.0.total_cmp(&b.0));
    let hint = match nearest {
        Some((share, name)) if share >= 0.5 && names.len() > 1 => format!(" (nearest: {name})"),
        _ => String::new(),
    };
    if names.is_empty() {
        "there is none".to_owned()
    } else {
        format!("must be one of {}{hint}", names.join(", "))
    }
}

/// Share of letter pairs that two words have in common (Dice).
#[must_use]
pub fn similarity(one: &str, other: &str) -> f64 {
    let pairs = |word: &str| word.as_bytes().windows(2).map(<[u8]>::to_vec).collect::<Vec<_>>();
    let (mine, mut theirs) = (pairs(one), pairs(other));
    let total = mine.len() + theirs.len();
    let mut common = 0;
    for pair in mine {
        if let Some(place) = theirs.iter().position(|other| *other == pair) {
            theirs.swap_remove(place);
            common += 1;
        }
    }
    if total == 0 { 0.0 } else { 2.0 * f64::from(common) / total as f64 }
}

impl Declaration {
    /// Position of a loop.
    #[must_use]
    pub fn circuit(&self, name: &str) -> Option<usize> {
        self.loops.iter().position(|circuit| circuit.name == name)
    }

    /// Position of a member.
    #[must_use]
    pub fn member(&self, name: &str) -> Option<usize> {
        self.members.iter().position(|member| member.name == name)
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

    fn check_kinds(&self) -> Result<(), Flaw> {
        let count = |kind: MemberKind| self.members.iter().filter(|member| member.kind == kind).count();
        for (kind, word) in [
            (MemberKind::Battery, "battery"),
            (MemberKind::Motor, "motor"),
            (MemberKind::Transmission, "transmission"),
        ] {
            if count(kind) != 1 {
                let found = format!("there {} times as kind `{word}`", count(kind));
                return Err(Flaw::new("member", found, "must be there once"));
            }
        }
        if count(MemberKind::Cabin) == 0 {
            return Err(Flaw::new("member", "without a cabin", "must have one of kind `cabin`"));
        }
        let comfortable = self.members.iter().filter(|member| member.comfort).count();
        if let Some(i) = self.members.iter().position(|m| m.comfort && m.kind != MemberKind::Cabin) {
            return Err(Flaw::new(
                format!("member[{i}].comfort"),
                "true",
                "must be false for what is no cabin",
            ));
        }
        if count(MemberKind::Cabin) > 1 && comfortable != 1 {
            let found = format!("true for {comfortable} of {} cabins", count(MemberKind::Cabin));
            return Err(Flaw::new(
                "member.comfort",
                found,
                "must be true for the one that counts for comfort",
            ));
        }
        Ok(())
    }

    fn check_members(&self) -> Result<(), Flaw> {
        for (i, member) in self.members.iter().enumerate() {
            let key = |key: &str| format!("member[{i}].{key}");
            self.check_section(i, member)?;
            match (&member.exhaust_recovery, member.kind) {
                (None, _) => {}
                (Some(name), MemberKind::Cabin) => {
                    let circuit = self.known_loop(key("exhaust_recovery"), name)?;
                    if self.loops[circuit].side == Side::Hot {
                        return Err(Flaw::new(
                            key("exhaust_recovery"),
                            format!("`{name}`"),
                            "must be a cold loop",
                        ));
                    }
                }
                (Some(_), _) => {
                    return Err(Flaw::new(
                        key("exhaust_recovery"),
                        "given",
                        "must be left out for what is no cabin",
                    ));
                }
            }
            match (&member.from, member.kind) {
                (None, MemberKind::Plate) => {
                    return Err(Flaw::new(
                        key("from"),
                        "missing",
                        "must name the loop that the plate cools or heats",
                    ));
                }
                (Some(name), MemberKind::Plate) => {
                    self.known_loop(key("from"), name)?;
                }
                (None, _) => {}
                (Some(_), _) => {
                    return Err(Flaw::new(key("from"), "given", "must be left out for what is no plate"));
                }
            }
            for name in member.options.iter().flatten() {
                self.known_loop(key("options"), name)?;
            }
            if let Some(options) = &member.options {
                let mut own: Vec<&str> = self.loops_of(&member.name);
                let mut given: Vec<&str> = options.iter().map(String::as_str).collect();
                own.sort_unstable();
                given.sort_unstable();
                if own != given {
                    let allowed =
                        format!("must name the loops of its branches, each once: {}", own.join(", "));
                    return Err(Flaw::new(key("options"), format!("{options:?}"), allowed));
                }
            }
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

    /// Loops that a member has branches in, in the order of the file.
    #[must_use]
    pub fn loops_of(&self, member: &str) -> Vec<&str> {
        let own = self.branches.iter().filter(|branch| branch.member == member);
        own.map(|branch| branch.circuit.as_str()).collect()
    }

    fn check_branches(&self) -> Result<(), Flaw> {
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
            if let (MemberKind::Cabin, Some(other)) = (member.kind, before) {
                let found = format!("`{}` beside `{}`", branch.circuit, other.circuit);
                let allowed = "a cabin must have one heater core and one cooling core at most";
                return Err(Flaw::new(key("loop"), found, allowed));
            }
            if branch.series
                && !matches!(
                    member.kind,
                    MemberKind::Battery | MemberKind::Motor | MemberKind::Transmission | MemberKind::Store
                )
            {
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

    fn check_exchangers(&self) -> Result<(), Flaw> {
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
                    let airy = |member: &MemberDeclaration| {
                        matches!(member.kind, MemberKind::Cabin | MemberKind::FrontEnd)
                    };
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

    fn check_heaters(&self) -> Result<(), Flaw> {
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

    fn check_air_streams(&self) -> Result<(), Flaw> {
        let mut used: Vec<&String> = Vec::new();
        for (i, stream) in self.air_streams.iter().enumerate() {
            for name in &stream.through {
                let key = format!("air_stream[{i}].through");
                self.known_member(key.clone(), name, |member| member.kind == MemberKind::FrontEnd)?;
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
            let needed = matches!(member.kind, MemberKind::FrontEnd | MemberKind::Store | MemberKind::Plate);
            if needed && !branches && !air && !heated {
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
}
