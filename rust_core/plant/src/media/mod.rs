//! Working fluids, one file each.

pub mod air;
pub mod moist_air;
pub mod fluid_limits;
pub mod refrigerant;
