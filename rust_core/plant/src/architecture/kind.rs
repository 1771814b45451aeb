//! What an architecture has to know of a kind of component. Each kind says it in its own file in `components/`, and is
//! registered by one row in `components/mod.rs`.

use super::builder::Builder;
use super::flows::Flow;
use super::ranks;
use crate::components::thermal_mass::ReadMass;

/// How many members of a kind an architecture has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Count {
    /// One.
    Once,
    /// One or more.
    AtLeastOnce,
    /// Any number.
    Any,
}

/// What a branch, an exchanger or a heater meets at a member.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meets {
    /// A thermal mass: it has a node, loses heat to ambient, and may stand in series.
    Mass,
    /// Supply air of a room, heated or cooled in a core; the room's air is a node.
    SupplyAir,
    /// Ambient air.
    AmbientAir,
    /// Coolant of another loop.
    OtherLoop,
}

/// What rules take a member for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// It is kept in a range of temperatures.
    Battery,
    /// Its waste heat feeds the heat pump, or is rejected.
    HeatSource,
    /// Heat comes from ambient and goes there.
    FrontEnd,
    /// It is charged and emptied.
    Store,
    /// People sit in it.
    Cabin,
    /// It is always open.
    Plate,
}

/// Keys of a member that only some kinds have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Key {
    /// `comfort`.
    Comfort,
    /// `exhaust_recovery`.
    ExhaustRecovery,
    /// `from`, which such a kind needs.
    From,
}

/// Bounds of a signal, and its place among those that agents are offered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Lowest value.
    pub low: f64,
    /// Highest value.
    pub high: f64,
    /// Place; see [`ranks`].
    pub rank: u8,
}

impl Bounds {
    /// From `low` to `high`.
    #[must_use]
    pub const fn new(low: f64, high: f64, rank: u8) -> Self {
        Self { low, high, rank }
    }

    /// Heat flow of a branch in either direction; `place` is that of the kind among all.
    #[must_use]
    pub const fn branch(most_w: f64, place: u8) -> Self {
        Self::new(-most_w, most_w, ranks::BRANCHES + place)
    }
}

/// Adds something of a member to a layout; the number is the member's place.
pub type Add = fn(&mut Builder<'_>, usize);

/// Adds nothing.
fn nothing(_: &mut Builder<'_>, _: usize) {}

/// A kind of component that members of an architecture can be.
#[derive(Debug, Clone, Copy)]
pub struct ComponentKind {
    /// Its word in architecture files.
    pub word: &'static str,
    /// How many there are.
    pub count: Count,
    /// What is met at it.
    pub meets: Meets,
    /// What rules take it for; nothing of theirs without.
    pub role: Option<Role>,
    /// Keys of its members besides those that all have.
    pub keys: &'static [Key],
    /// The vehicle's section with its numbers, where that has one name in every vehicle.
    pub section: Option<&'static str>,
    /// Whether it is of no use without a branch, an exchanger or a heater.
    pub needs_link: bool,
    /// Flow of the heat that is produced in its mass.
    pub loss: Option<Flow>,
    /// Bounds of its temperature, where it has one.
    pub temperature: Bounds,
    /// Bounds of the heat flow of its branches, where agents are offered it.
    pub branch_heat_flow: Option<Bounds>,
    /// Reads its numbers, where the plant needs no more of it than those of a passive mass.
    pub read: Option<ReadMass>,
    /// Adds its nodes; that of a mass is there.
    pub add_nodes: Add,
    /// Adds flows of electrical power.
    pub add_loads: Add,
    /// Adds flows of heat that enter it from outside.
    pub add_gains: Add,
    /// Adds links to loops besides branches.
    pub add_loop_links: Add,
    /// Adds links to ambient and among its nodes; that of a mass is there.
    pub add_links: Add,
    /// Adds what its flows bring into its nodes.
    pub add_sources: Add,
    /// Adds actuators besides connection, request and valve.
    pub add_levels: Add,
}

impl ComponentKind {
    /// What most masses have in common.
    pub const MASS: Self = Self {
        word: "",
        count: Count::Any,
        meets: Meets::Mass,
        role: None,
        keys: &[],
        section: None,
        needs_link: true,
        loss: None,
        temperature: Bounds::new(-40.0, 100.0, ranks::STORE),
        branch_heat_flow: None,
        read: None,
        add_nodes: nothing,
        add_loads: nothing,
        add_gains: nothing,
        add_loop_links: nothing,
        add_links: nothing,
        add_sources: nothing,
        add_levels: nothing,
    };

    /// What masses of the powertrain have in common: there is one of each, and its losses warm it.
    pub const POWERTRAIN: Self = Self { count: Count::Once, needs_link: false, ..Self::MASS };

    /// Whether it has a temperature of its own.
    #[must_use]
    pub const fn has_mass(&self) -> bool {
        matches!(self.meets, Meets::Mass | Meets::SupplyAir)
    }

    /// Whether an exchanger of the refrigerant loop can face its air.
    #[must_use]
    pub const fn has_air(&self) -> bool {
        matches!(self.meets, Meets::SupplyAir | Meets::AmbientAir)
    }

    /// Whether its members have a key.
    #[must_use]
    pub fn takes(&self, key: Key) -> bool {
        self.keys.contains(&key)
    }
}

/// Makes the list of kinds: `component_kinds! { /// What it is. Name => module, ... }`; each module has a `KIND`.
macro_rules! component_kinds {
    ($( $(#[$doc:meta])* $name:ident => $module:ident, )*) => {
        /// What a member of an architecture is.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum MemberKind { $( $(#[$doc])* $name, )* }

        impl MemberKind {
            /// All kinds, in the order of their nodes.
            pub const ALL: &'static [Self] = &[$( Self::$name, )*];

            /// Their words in files.
            pub const WORDS: &'static [&'static str] = &[$( $module::KIND.word, )*];

            /// What its file says of it.
            #[must_use]
            pub const fn data(self) -> &'static $crate::architecture::kind::ComponentKind {
                match self { $( Self::$name => &$module::KIND, )* }
            }
        }

        impl<'de> serde::Deserialize<'de> for MemberKind {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let word = <String as serde::Deserialize>::deserialize(deserializer)?;
                let kind = Self::ALL.iter().find(|kind| kind.data().word == word);
                kind.copied().ok_or_else(|| serde::de::Error::unknown_variant(&word, Self::WORDS))
            }
        }
    };
}
pub(crate) use component_kinds;
