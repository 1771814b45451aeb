//! Physical components, one a file: parameters plus pure functions.

pub mod ambient_exchanger;
pub mod battery;
pub mod body;
pub mod cabin;
pub mod compressor;
pub mod heat_exchanger;
pub mod motor;
pub mod powertrain;
pub mod pump;
pub mod refrigerant_exchanger;
pub mod transmission;
pub mod underbody_plate;
