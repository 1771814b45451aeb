//! The thermal architecture as data: what a vehicle is made of and how it is connected.
//!
//! A file (`configs/architectures/`) is read as a [`declaration::Declaration`], which knows names. [`layout::Layout`] is
//! what follows from it: nodes, links, flows, actuators and signals, by position. The build script compiles this module
//! too and emits the networks of the built-in files (`crate::network::built_in`), so nothing here may depend on the rest
//! of the crate.

pub mod declaration;
pub mod flows;
pub mod indices;
pub mod layout;
pub mod rows;
pub mod wiring;
