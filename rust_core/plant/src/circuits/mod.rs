//! How components connect: coolant branches, refrigerant loop and its exchangers.

pub mod branches;
pub mod exchangers;
pub mod front_ends;
pub mod refrigeration_cycle;
pub mod refrigeration_loop;
mod refrigeration_solver;
pub mod vapour_injection;
