//! How components connect: coolant branches, thermal network, refrigerant loop.

pub mod assembly;
pub mod branches;
pub mod refrigeration_cycle;
pub mod refrigeration_loop;
mod refrigeration_solver;
