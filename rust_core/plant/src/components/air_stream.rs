//! Air through the front end: ram air and fan together. Exchangers that share it get it as the one before left it.
//!
//! Ram air and fan push through the same core, whose pressure drop goes with the square of the flow; their pressures add, so
//! their flows add as squares. The fan obeys the fan laws: its power goes with the cube of its flow.

use crate::parameters;

parameters! {
    /// Air through the front end.
    pub struct AirStreamParameters {
        /// Area of the core that the air passes [m2].
        core_area_m2: f64 = 0.01 .. 5.0,
        /// Speed of ram air in the core over the vehicle's speed [-].
        ram_air_share: f64 = 0.0 .. 1.0,
        /// Air flow of the fan alone at its full power [m3/s].
        fan_air_flow_m3_s: f64 = 0.0 .. 10.0,
        /// Power of the fan at that flow [W].
        fan_power_w: f64 = 0.0 .. 2000.0,
        /// Vehicle speed from which on the fan rests; its largest flow fades out linearly up to there [m/s].
        fan_off_speed_m_s: f64 = 0.1 .. 100.0,
        /// Difference between refrigerant and air that the fan is to hold, where refrigerant meets air [K].
        fan_approach_k: f64 = 1.0 .. 40.0,
    }
}

/// Speed of the air in a core at rest, by wind and buoyancy [m/s].
const DRAUGHT_M_S: f64 = 0.1;

/// What ram air and fan can do at a speed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Draught {
    /// Without the fan [m3/s].
    pub ram_m3_s: f64,
    /// With the most that the fan gives at this speed [m3/s].
    pub full_m3_s: f64,
}

impl AirStreamParameters {
    /// Air flows at a vehicle speed without the fan and with all of it.
    #[must_use]
    #[inline(always)]
    pub fn draught(&self, speed_m_s: f64) -> Draught {
        let face_m_s = self.ram_air_share * speed_m_s;
        let ram_m3_s = self.core_area_m2 * (face_m_s * face_m_s + DRAUGHT_M_S * DRAUGHT_M_S).sqrt();
        let fan_m3_s = self.fan_air_flow_m3_s * (1.0 - speed_m_s / self.fan_off_speed_m_s).max(0.0);
        Draught { ram_m3_s, full_m3_s: (ram_m3_s * ram_m3_s + fan_m3_s * fan_m3_s).sqrt() }
    }

    /// Power of the fan that brings the flow from `ram_m3_s` to `flow_m3_s` [W].
    #[must_use]
    #[inline(always)]
    pub fn fan_power_w(&self, ram_m3_s: f64, flow_m3_s: f64) -> f64 {
        let fan_m3_s = (flow_m3_s * flow_m3_s - ram_m3_s * ram_m3_s).max(0.0).sqrt();
        let level = fan_m3_s / self.fan_air_flow_m3_s;
        if fan_m3_s > 0.0 { self.fan_power_w * level * level * level } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream() -> AirStreamParameters {
        AirStreamParameters {
            core_area_m2: 0.25,
            ram_air_share: 0.2,
            fan_air_flow_m3_s: 0.6,
            fan_power_w: 200.0,
            fan_off_speed_m_s: 15.0,
            fan_approach_k: 10.0,
        }
    }

    /// By hand: 0.25 m2 times 0.2 times 5 m/s is 0.25 m3/s, the draught hardly adds; the fan gives two thirds of 0.6.
    #[test]
    fn flows_of_ram_air_and_fan_add_as_squares() {
        let draught = stream().draught(5.0);
        assert!((draught.ram_m3_s - 0.251_25).abs() < 1e-5, "{draught:?}");
        assert!((draught.full_m3_s - 0.472_36).abs() < 1e-5, "{draught:?}");
        let fast = stream().draught(20.0);
        assert_eq!(fast.ram_m3_s, fast.full_m3_s, "no fan from its last speed on");
    }

    /// Fan laws: half the flow takes an eighth of the power.
    #[test]
    fn the_power_of_the_fan_goes_with_the_cube_of_its_flow() {
        let (stream, still) = (stream(), 0.025);
        let with = |fan_m3_s: f64| (still * still + fan_m3_s * fan_m3_s).sqrt();
        assert!((stream.fan_power_w(still, with(0.6)) - 200.0).abs() < 1e-9);
        assert!((stream.fan_power_w(still, with(0.3)) - 25.0).abs() < 1e-9);
        assert_eq!(stream.fan_power_w(still, still), 0.0);
    }
}
