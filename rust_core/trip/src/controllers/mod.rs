//! Rule-based controllers.

pub mod file;
pub mod hpcu;
