//! A plant as a decision process: what an agent does, sees and is paid for, from start to arrival.
//!
//! One [`episode::Episode`] is one environment, a [`vector::Vector`] many that step together. Everything that
//! changes is plain data and can be written as bytes ([`snapshot`]).

pub mod action;
pub mod defaults;
pub mod episode;
pub mod garage;
pub mod guard;
pub mod kinds;
pub mod limits;
pub mod observation;
mod prefetch;
pub mod random;
pub mod reference;
pub mod reward;
pub mod rows;
pub mod scenario_sampler;
pub mod setup;
mod side_by_side;
pub mod snapshot;
pub mod summaries;
pub mod threads;
pub mod timing;
pub mod totals;
pub mod vector;
