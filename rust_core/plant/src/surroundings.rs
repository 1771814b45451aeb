//! What the surroundings do during a step.

use crate::media::air::AirProperties;

/// Period of all controllers and of a plant step [s].
pub const CONTROL_PERIOD_S: f64 = 1.0;

/// What the surroundings do during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disturbance {
    /// Vehicle speed at the beginning [m/s].
    pub start_speed_m_s: f64,
    /// Vehicle speed asked for at the end [m/s].
    pub end_speed_m_s: f64,
    /// Ambient air.
    pub air: AirProperties,
    /// Water in a kilogram of dry ambient air [kg/kg]; 0 is dry.
    pub ambient_humidity_ratio: f64,
    /// Solar heat into the cabin [W].
    pub solar_gain_w: f64,
    /// People in the cabin.
    pub occupants: f64,
}

impl Disturbance {
    /// Mean vehicle speed, where the vehicle does as asked [m/s].
    #[must_use]
    pub fn mean_speed_m_s(&self) -> f64 {
        0.5 * (self.start_speed_m_s + self.end_speed_m_s)
    }
}
