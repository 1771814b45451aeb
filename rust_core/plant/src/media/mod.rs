//! Working fluids, one file each.

pub mod air;
pub mod fluid_limits;
pub mod moist_air;
pub mod refrigerant;
