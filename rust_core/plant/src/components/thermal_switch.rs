//! Thermal switches between components and loops: when they may close. How far is up to `control/thermal_switch.rs`.

use super::pid::PidParameters;
use crate::parameters;

parameters! {
    /// Thermal switches between components and loops.
    pub struct SwitchParameters {
        /// Temperature difference needed to close a connection [K].
        closing_difference_k: f64 = 0.0 .. 20.0,
        /// Temperature difference below which it opens again [K].
        opening_difference_k: f64 = 0.0 .. 20.0,
        ;
        /// Controller on the heat flow, both normalised by what the exchanger could pass.
        pid: PidParameters,
    }
}
