//! What a rule-based controller is, and the closed set of them as plain data.

use crate::roles::Roles;
use crate::settings::DriverSettings;
use crate::strategy::Strategy;
use hp_plant::architecture::layout::Layout;
use hp_plant::command::Demand;
use hp_plant::config::{Celsius, Validate};
use hp_plant::plant::Plant;
use hp_plant::state::State;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fmt::Debug;

/// What the cabin needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum CabinMode {
    /// Heat.
    Heating,
    /// Air conditioning.
    Cooling,
}

impl CabinMode {
    /// How far a cabin is from its target, counted in the direction that this mode works against [K].
    #[must_use]
    pub fn lack_k(self, target_k: f64, cabin_k: f64) -> f64 {
        match self {
            Self::Heating => target_k - cabin_k,
            Self::Cooling => cabin_k - target_k,
        }
    }
}

/// A cabin and its target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comfort {
    /// Temperature of the cabin that counts for comfort [K].
    pub cabin_k: f64,
    /// What it is to be [K].
    pub target_k: f64,
}

impl Comfort {
    /// How far the cabin is from its target, counted in the direction that a mode works against [K].
    #[must_use]
    pub fn lack_k(&self, mode: CabinMode) -> f64 {
        mode.lack_k(self.target_k, self.cabin_k)
    }
}

/// What a controller asks for whatever happens; an agent that does not control these rows leaves them as they are here.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantSettings {
    /// Cabin temperature that the PTC's PID aims at.
    pub cabin_set_point_degc: Celsius,
    /// Coolant flow of the HTC [kg/s].
    pub htc_flow_kg_s: f64,
    /// Coolant flow of the chiller circuit [kg/s].
    pub chiller_flow_kg_s: f64,
    /// Blower level while heating [-].
    pub blower_level: f64,
    /// Blower level while cooling [-].
    pub cooling_blower_level: f64,
    /// Recirculated share while heating [-].
    pub heating_recirculation: f64,
    /// Recirculated share while cooling [-].
    pub cooling_recirculation: f64,
}

impl ConstantSettings {
    /// Recirculated share in a mode [-].
    #[must_use]
    pub fn recirculation(&self, mode: CabinMode) -> f64 {
        match mode {
            CabinMode::Heating => self.heating_recirculation,
            CabinMode::Cooling => self.cooling_recirculation,
        }
    }

    /// Blower level in a mode [-].
    #[must_use]
    pub fn blower_level(&self, mode: CabinMode) -> f64 {
        match mode {
            CabinMode::Heating => self.blower_level,
            CabinMode::Cooling => self.cooling_blower_level,
        }
    }

    /// Rows and values of these settings in a mode.
    #[must_use]
    pub fn rows(&self, mode: CabinMode, roles: &Roles) -> Vec<(usize, f64)> {
        let all = |rows: &[usize], value: f64| rows.iter().map(|&row| (row, value)).collect::<Vec<_>>();
        [
            all(&roles.recirculation_rows, self.recirculation(mode)),
            all(&roles.blower_rows, self.blower_level(mode)),
            all(&roles.hot_flow_rows, self.htc_flow_kg_s),
            all(&roles.cold_flow_rows, self.chiller_flow_kg_s),
            all(roles.set_point_row.as_slice(), self.cabin_set_point_degc.kelvin()),
        ]
        .concat()
    }

    /// Enters these settings into a demand.
    pub fn enter(&self, mode: CabinMode, roles: &Roles, demand: &mut Demand) {
        for (row, value) in self.rows(mode, roles) {
            demand[row] = value;
        }
    }
}

/// Takes these settings from parameters that have keys of their names.
macro_rules! constant_settings_of {
    ($parameters:ty) => {
        impl From<&$parameters> for $crate::controllers::rule_based::ConstantSettings {
            fn from(parameters: &$parameters) -> Self {
                Self {
                    cabin_set_point_degc: parameters.cabin_set_point_degc,
                    htc_flow_kg_s: parameters.htc_flow_kg_s,
                    chiller_flow_kg_s: parameters.chiller_flow_kg_s,
                    blower_level: parameters.blower_level,
                    cooling_blower_level: parameters.cooling_blower_level,
                    heating_recirculation: parameters.heating_recirculation,
                    cooling_recirculation: parameters.cooling_recirculation,
                }
            }
        }
    };
}

pub(super) use constant_settings_of;

/// What does not change while a mode lasts, as rows and values: connections by role, and constant settings.
#[derive(Debug, Clone, PartialEq)]
pub struct Presets {
    heating: Box<[(usize, f64)]>,
    cooling: Box<[(usize, f64)]>,
}

impl Presets {
    /// Presets of roles and settings.
    #[must_use]
    pub fn of(roles: &Roles, settings: &ConstantSettings) -> Self {
        let rows = |mode: CabinMode| {
            let mut rows = roles.connections(mode == CabinMode::Heating);
            rows.extend(settings.rows(mode, roles));
            rows.into()
        };
        Self { heating: rows(CabinMode::Heating), cooling: rows(CabinMode::Cooling) }
    }

    /// Enters those of a mode into a demand.
    #[inline]
    pub fn enter(&self, mode: CabinMode, demand: &mut Demand) {
        let rows = if mode == CabinMode::Heating { &self.heating } else { &self.cooling };
        for &(row, value) in rows {
            demand[row] = value;
        }
    }
}

/// A controller that follows rules: parameters from its file, and a memory that is plain data.
pub trait RuleBased: Debug + Clone + PartialEq {
    /// What its file gives.
    type Parameters: Debug + Clone + PartialEq + DeserializeOwned + Validate;
    /// What it remembers from one control period to the next.
    type Memory: Debug + Clone + Copy + PartialEq + Serialize + DeserializeOwned;

    /// A controller with parameters, what it may use, and what there is.
    #[must_use]
    fn new(parameters: Self::Parameters, strategy: Strategy, layout: &Layout) -> Self;

    /// What it found in the vehicle.
    #[must_use]
    fn roles(&self) -> &Roles;

    /// What it asks for whatever happens.
    #[must_use]
    fn constant_settings(&self) -> ConstantSettings;

    /// Memory at the start of a run.
    #[must_use]
    fn awake(&self, plant: &Plant, state: &State, settings: &DriverSettings) -> Self::Memory;

    /// Enters what it asks for in the next control period into a demand that has everything off and the heat flows that the
    /// heatDemandCommander requests. What the driver has set counts before its own numbers.
    fn demand(
        &self,
        plant: &Plant,
        state: &State,
        settings: &DriverSettings,
        memory: &mut Self::Memory,
        demand: &mut Demand,
    );
}

/// Declares the closed set of rule-based controllers: of each its file's name, by which `rules = "..."` selects it, and its
/// type.
macro_rules! rule_based_controllers {
    ($( $(#[$doc:meta])* $rules:ident: $controller:ident, )+) => {
        /// Names that a controller file may give as its `rules`.
        pub const RULES: &[&str] = &[$( stringify!($rules) ),+];

        /// Parameters of one of the controllers.
        // One a run or a band: what a smaller one wastes does not matter, nor in the types below.
        #[allow(clippy::large_enum_variant)]
        #[derive(Debug, Clone, PartialEq)]
        pub enum RuleParameters {
            $( $(#[$doc])* $controller(<$rules::$controller as RuleBased>::Parameters), )+
        }

        /// One of the controllers, ready to run.
        #[allow(clippy::large_enum_variant)]
        #[derive(Debug, Clone, PartialEq)]
        pub enum Rules {
            $( $(#[$doc])* $controller($rules::$controller), )+
        }

        /// What one of the controllers remembers: plain data.
        #[allow(clippy::large_enum_variant)]
        #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
        pub enum RuleMemory {
            $( $(#[$doc])* $controller(<$rules::$controller as RuleBased>::Memory), )+
        }

        impl RuleParameters {
            /// Reads and checks the parameters of named rules; `place` is the file that an error names.
            fn of_rules(rules: &str, place: &str, table: Table) -> PlantResult<Self> {
                match rules {
                    $( stringify!($rules) => library::read(place, table).map(Self::$controller), )+
                    _ => {
                        let allowed = format!("must be one of {}", RULES.join(", "));
                        Err(Violation::new("rules", format!("\"{rules}\""), allowed).in_file(place))
                    }
                }
            }

            /// The controller with these parameters, what it may use, and what there is.
            #[must_use]
            pub fn controller(&self, strategy: Strategy, layout: &Layout) -> Rules {
                match self {
                    $( Self::$controller(parameters) => {
                        Rules::$controller(RuleBased::new(parameters.clone(), strategy, layout))
                    } )+
                }
            }
        }

        impl Rules {
            /// What the controller asks for whatever happens.
            #[must_use]
            pub fn constant_settings(&self) -> ConstantSettings {
                match self {
                    $( Self::$controller(rules) => rules.constant_settings(), )+
                }
            }

            /// What the controller found in the vehicle.
            #[must_use]
            pub fn roles(&self) -> &Roles {
                match self {
                    $( Self::$controller(rules) => rules.roles(), )+
                }
            }

            /// Memory at the start of a run.
            #[must_use]
            pub fn awake(&self, plant: &Plant, state: &State, settings: &DriverSettings) -> RuleMemory {
                match self {
                    $( Self::$controller(rules) => {
                        RuleMemory::$controller(rules.awake(plant, state, settings))
                    } )+
                }
            }

            /// Enters what the controller asks for in the next control period; a memory of other rules counts as none.
            pub fn demand(
                &self,
                plant: &Plant,
                state: &State,
                settings: &DriverSettings,
                memory: &mut RuleMemory,
                demand: &mut Demand,
            ) {
                match (self, &mut *memory) {
                    $( (Self::$controller(rules), RuleMemory::$controller(memory)) => {
                        rules.demand(plant, state, settings, memory, demand)
                    } )+
                    (rules, memory) => {
                        *memory = rules.awake(plant, state, settings);
                        rules.demand(plant, state, settings, memory, demand);
                    }
                }
            }
        }
    };
}

pub(super) use rule_based_controllers;
