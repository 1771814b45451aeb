//! Physical components, one a file: parameters, state and equations, and for what an architecture can name, what it has to know
//! of that kind.

pub mod air_stream;
pub mod ambient_exchanger;
pub mod battery;
pub mod battery_tables;
pub mod body;
pub mod cabin;
pub mod cabin_air;
pub mod compressor;
pub mod coolant_loop;
pub mod equivalent_temperature;
pub mod exhaust_recovery;
pub mod frost;
pub mod heat_exchanger;
pub mod heater;
mod hose;
pub mod liquid_plate;
pub mod motor;
pub mod pid;
pub mod powertrain;
pub mod pump;
pub mod rate_limit;
pub mod reachable_speed;
pub mod refrigerant_exchanger;
pub mod store;
pub mod thermal_mass;
pub mod thermal_switch;
pub mod transmission;
pub mod underbody_plate;
pub mod wet_core;
pub mod windscreen;

use crate::architecture::kind::component_kinds;

// What an architecture's members can be, in the order of their nodes: a row for each file with a `KIND`.
component_kinds! {
    /// The traction battery; there is one.
    Battery => battery,
    /// Motor and inverter; there is one.
    Motor => motor,
    /// Transmission and driveline; there is one.
    Transmission => transmission,
    /// Cabin: air, exhaust volume, soft and hard furnishings.
    Cabin => cabin,
    /// Sensible heat store.
    Store => store,
    /// Exchanger with ambient air at the front end.
    FrontEnd => ambient_exchanger,
    /// Liquid-to-liquid plate between two loops.
    Plate => liquid_plate,
}
