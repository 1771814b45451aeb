//! Order in which signals are offered to an agent: the smaller, the earlier.

/// Time of the trip.
pub const TIME: u8 = 0;
/// Vehicle speed.
pub const SPEED: u8 = 1;
/// Traction power.
pub const TRACTION: u8 = 2;
/// Ambient temperature.
pub const AMBIENT: u8 = 3;
/// Air of cabins.
pub const CABIN: u8 = 4;
/// Humidity, carbon dioxide and fog of cabins.
pub const CABIN_AIR: u8 = 5;
/// Battery temperature.
pub const BATTERY: u8 = 6;
/// Temperature of motor and inverter.
pub const MOTOR: u8 = 7;
/// Transmission temperature.
pub const TRANSMISSION: u8 = 8;
/// Temperatures of other masses.
pub const STORE: u8 = 9;
/// Supply and return of loops.
pub const LOOP: u8 = 10;
/// Coolant flows.
pub const LOOP_FLOW: u8 = 11;
/// Condensing state.
pub const CONDENSING: u8 = 12;
/// Evaporating state.
pub const EVAPORATING: u8 = 13;
/// Discharge temperature.
pub const DISCHARGE: u8 = 14;
/// Compressor speed.
pub const COMPRESSOR_SPEED: u8 = 15;
/// State of charge.
pub const CHARGE: u8 = 16;
/// Charge limit.
pub const CHARGE_LIMIT: u8 = 17;
/// Discharge limit.
pub const DISCHARGE_LIMIT: u8 = 18;
/// Battery power.
pub const BATTERY_POWER: u8 = 19;
/// Compressor power.
pub const COMPRESSOR_POWER: u8 = 20;
/// Heater powers.
pub const HEATER_POWER: u8 = 21;
/// Constant loads.
pub const AUXILIARY: u8 = 22;
/// Heat flow of all condensers.
pub const CONDENSER: u8 = 23;
/// Heat flow of all evaporators.
pub const EVAPORATOR: u8 = 24;
/// Heat flows of single exchangers.
pub const EXCHANGER: u8 = 25;
/// Heat flows of branches; each kind of component adds its own place.
pub const BRANCHES: u8 = 26;
