//! Electric-vehicle thermal plant after Jeffs et al. 2019 (doi 10.3384/ecp19157107).
//!
//! A vehicle with powertrain, battery, cabin, two coolant loops and a refrigerant loop, stepped at 1 s. The
//! crate knows physics and the vehicle's own controls; it knows neither reinforcement learning nor Python.

mod air_side;
pub mod architecture;
pub mod circuits;
pub mod command;
pub mod components;
pub mod config;
mod controls;
pub mod error;
pub mod flows;
pub mod ledger;
pub mod media;
pub mod network;
pub mod numerics;
pub mod plant;
pub mod signals;
pub mod state;
mod step_parameters;
mod surroundings;

#[doc(hidden)]
pub use numerics::elimination::MAXIMUM_OPERATIONS as UNROLLED;
