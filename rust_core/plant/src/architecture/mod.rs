//! The thermal architecture as data: what a vehicle is made of and how it is connected.
//!
//! A file (`configs/architectures/`) is read as a [`declaration::Declaration`], which knows names. [`layout::Layout`] is
//! what follows from it: nodes, links, flows, actuators and signals, by position; [`builder`] makes it, and asks each kind of
//! component ([`kind::ComponentKind`]) for its part. The build script compiles this module, the components and what they need
//! too, and emits the networks of the built-in files (`crate::network::built_in`), so nothing here may depend on more of the
//! crate than that.

pub mod builder;
mod check;
pub mod declaration;
pub mod flaw;
pub mod flows;
pub mod indices;
pub mod kind;
pub mod layout;
pub mod places;
pub mod ranks;
pub mod rows;
pub mod wiring;
