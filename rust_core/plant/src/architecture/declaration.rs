//! What an architecture's file says, by name.

pub use crate::components::MemberKind;
use serde::Deserialize;

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
        self.kind.data().section.or(self.section.as_deref()).unwrap_or(&self.name)
    }

    /// Whether it has a temperature of its own.
    #[must_use]
    pub fn has_mass(&self) -> bool {
        self.kind.data().has_mass()
    }
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

    /// Loops that a member has branches in, in the order of the file.
    #[must_use]
    pub fn loops_of(&self, member: &str) -> Vec<&str> {
        let own = self.branches.iter().filter(|branch| branch.member == member);
        own.map(|branch| branch.circuit.as_str()).collect()
    }

    /// Positions of the members of a kind.
    pub fn of_kind(&self, kind: MemberKind) -> impl Iterator<Item = usize> + '_ {
        (0..self.members.len()).filter(move |&member| self.members[member].kind == kind)
    }
}
