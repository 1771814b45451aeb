//! How much there is room for: a state stays one flat value, whose arrays have these lengths.

/// Most thermal nodes.
pub const NODE_PLACES: usize = 22;
/// Most links of the thermal network.
pub const LINK_PLACES: usize = 56;
/// Most branches; a multiple of four, so that they are worked out side by side.
pub const BRANCH_PLACES: usize = 16;
/// Most flows; a multiple of four.
pub const FLOW_PLACES: usize = 80;
/// Most actuators; a multiple of eight.
pub const ACTUATOR_PLACES: usize = 40;
/// Most coolant loops.
pub const LOOP_PLACES: usize = 4;
/// Most cabins.
pub const CABIN_PLACES: usize = 2;
/// Most members.
pub const MEMBER_PLACES: usize = 12;
/// Most masses besides cabins.
pub const MASS_PLACES: usize = 8;
/// Most heaters.
pub const HEATER_PLACES: usize = 4;
/// Most exchangers of the refrigerant loop.
pub const EXCHANGER_PLACES: usize = 6;
/// Most front-end exchangers.
pub const FRONT_END_PLACES: usize = 3;
/// Most weights of branches in series.
pub const WEIGHT_PLACES: usize = 8;
/// Most loops that heat enters: exchangers of the refrigerant loop, heaters.
pub const INLET_PLACES: usize = 3;
