//! What a rule-based controller is, and the closed set of them as plain data.

use crate::strategy::Strategy;
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

/// What a controller asks for whatever happens; an agent that does not control these rows leaves them as they are here.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantSettings {
    /// Cabin temperature that the PTC's PID aims at.
    pub cabin_set_point_degc: Celsius,
    /// Coolant flow of the HTC [kg/s].
    pub htc_flow_kg_s: f64,
    /// Coolant flow of the chiller circuit [kg/s].
    pub chiller_flow_kg_s: f64,
    /// Blower level [-].
    pub blower_level: f64,
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

    /// A demand with these settings; everything else as [`Demand::default`] has it.
    #[must_use]
    pub fn demand(&self, mode: CabinMode, requests_w: &[f64; 6]) -> Demand {
        Demand {
            recirculation: self.recirculation(mode),
            blower_level: self.blower_level,
            htc_flow_kg_s: self.htc_flow_kg_s,
            chiller_flow_kg_s: self.chiller_flow_kg_s,
            requests_w: *requests_w,
            cabin_set_point_k: self.cabin_set_point_degc.kelvin(),
            ..Demand::default()
        }
    }
}

/// A controller that follows rules: parameters from its file, and a memory that is plain data.
pub trait RuleBased: Debug + Clone + PartialEq {
    /// What its file gives.
    type Parameters: Debug + Clone + PartialEq + DeserializeOwned + Validate;
    /// What it remembers from one control period to the next.
    type Memory: Debug + Clone + Copy + PartialEq + Serialize + DeserializeOwned;

    /// A controller with parameters and what it may use.
    #[must_use]
    fn new(parameters: Self::Parameters, strategy: Strategy) -> Self;

    /// What it asks for whatever happens.
    #[must_use]
    fn constant_settings(&self) -> ConstantSettings;

    /// Memory at the start of a run.
    #[must_use]
    fn awake(&self, plant: &Plant, state: &State) -> Self::Memory;

    /// Demand for the next control period, given the heat flows requested by the heatDemandCommander [W].
    fn demand(
        &self,
        plant: &Plant,
        state: &State,
        memory: &mut Self::Memory,
        requests_w: &[f64; 6],
    ) -> Demand;
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

            /// The controller with these parameters and what it may use.
            #[must_use]
            pub fn controller(&self, strategy: Strategy) -> Rules {
                match self {
                    $( Self::$controller(parameters) => {
                        Rules::$controller(RuleBased::new(parameters.clone(), strategy))
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

            /// Memory at the start of a run.
            #[must_use]
            pub fn awake(&self, plant: &Plant, state: &State) -> RuleMemory {
                match self {
                    $( Self::$controller(rules) => RuleMemory::$controller(rules.awake(plant, state)), )+
                }
            }

            /// Demand for the next control period; a memory of other rules counts as none.
            pub fn demand(
                &self,
                plant: &Plant,
                state: &State,
                memory: &mut RuleMemory,
                requests_w: &[f64; 6],
            ) -> Demand {
                match (self, &mut *memory) {
                    $( (Self::$controller(rules), RuleMemory::$controller(memory)) => {
                        rules.demand(plant, state, memory, requests_w)
                    } )+
                    (rules, memory) => {
                        *memory = rules.awake(plant, state);
                        rules.demand(plant, state, memory, requests_w)
                    }
                }
            }
        }
    };
}

pub(super) use rule_based_controllers;
