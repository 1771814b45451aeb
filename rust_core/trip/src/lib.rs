//! Trips of a vehicle after Jeffs et al. 2019: scenarios, drive cycles and the rules that drive the plant through them.
//!
//! The plant holds physics and the vehicle's own protections; whatever is an opinion (set points, thresholds, sources,
//! requested heat flows, what counts as comfort) is here.

pub mod controllers;
pub mod drive_cycle;
pub mod experiment;
pub mod heat_demand_commander;
pub mod kinds;
pub mod pace;
pub mod road;
pub mod roles;
pub mod run;
pub mod scenario;
pub mod settings;
pub mod strategy;
pub mod summary;
pub mod trace;
pub mod weather;
