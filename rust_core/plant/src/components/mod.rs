//! Physical components, one a file: parameters, state and equations.

pub mod air_stream;
pub mod ambient_exchanger;
pub mod battery;
pub mod battery_tables;
pub mod body;
pub mod cabin;
pub mod compressor;
pub mod coolant_loop;
pub mod exhaust_recovery;
pub mod heat_exchanger;
pub mod heater;
mod hose;
pub mod liquid_plate;
pub mod motor;
pub mod pid;
pub mod powertrain;
pub mod pump;
pub mod refrigerant_exchanger;
pub mod store;
pub mod thermal_switch;
pub mod transmission;
pub mod underbody_plate;
