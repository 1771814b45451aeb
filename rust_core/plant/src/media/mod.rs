//! Working fluids, one file each.

pub mod air;
pub mod refrigerant;
