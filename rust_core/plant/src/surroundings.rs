//! What the surroundings do during a step.

use crate::components::body::Road;
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
    /// Rise of the road over its horizontal length [-]; downhill is negative.
    pub grade: f64,
    /// Wind against the vehicle [m/s]; from behind is negative.
    pub headwind_m_s: f64,
}

impl Disturbance {
    /// Mean vehicle speed, where the vehicle does as asked [m/s].
    #[must_use]
    pub fn mean_speed_m_s(&self) -> f64 {
        0.5 * (self.start_speed_m_s + self.end_speed_m_s)
    }

    /// Speed of the air along a vehicle of a speed [m/s], whichever way it goes: what outer surfaces exchange heat with.
    #[must_use]
    #[inline]
    pub fn air_speed_m_s(&self, speed_m_s: f64) -> f64 {
        (speed_m_s + self.headwind_m_s).abs()
    }

    /// Speed of the air that meets the front of a vehicle of a speed [m/s]; none enters where the wind overtakes it.
    #[must_use]
    #[inline]
    pub fn frontal_air_speed_m_s(&self, speed_m_s: f64) -> f64 {
        (speed_m_s + self.headwind_m_s).max(0.0)
    }

    /// The road and the air over it.
    #[must_use]
    #[inline]
    pub fn road(&self) -> Road<'_> {
        Road { air: &self.air, headwind_m_s: self.headwind_m_s, grade: self.grade }
    }
}
