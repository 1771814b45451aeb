//! The body: longitudinal dynamics, and its glass.

use crate::config::ZERO_CELSIUS_K;
use crate::media::air::AirProperties;
use crate::parameters;

/// Standard gravity as used by WLTP road-load work [m/s2].
const GRAVITY_M_S2: f64 = 9.81;

/// Ambient temperature that the rolling resistance coefficient belongs to (ISO 28580, UN Regulation 117) [K].
const TYRE_REFERENCE_K: f64 = 25.0 + ZERO_CELSIUS_K;

parameters! {
    /// Longitudinal dynamics, and what the sun meets.
    pub struct BodyParameters {
        /// Mass with driver [kg].
        mass_kg: f64 = 300.0 .. 40000.0,
        /// Rotating inertia as a share of the mass [-].
        rotating_mass_share: f64 = 0.0 .. 0.3,
        /// Drag coefficient times frontal area [m2].
        drag_area_m2: f64 = 0.1 .. 10.0,
        /// Rolling resistance coefficient at 25 degC ambient [-].
        rolling_resistance_coefficient: f64 = 0.001 .. 0.05,
        /// Its rise for each kelvin that ambient is colder than 25 degC, as a share [1/K].
        rolling_resistance_rise_per_k: f64 = 0.0 .. 0.015,
        /// Area that the sun's irradiance on level ground enters the cabins by: all glass, as the sun sees it, times what it lets
        /// through [m2].
        solar_aperture_m2: f64 = 0.0 .. 10.0,
    }
}

/// A piece of road and the air over it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Road<'a> {
    /// Air.
    pub air: &'a AirProperties,
    /// Wind against the vehicle [m/s]; from behind is negative.
    pub headwind_m_s: f64,
    /// Rise over horizontal length [-].
    pub grade: f64,
}

impl<'a> Road<'a> {
    /// A level road without wind.
    #[must_use]
    pub fn level(air: &'a AirProperties) -> Self {
        Self { air, headwind_m_s: 0.0, grade: 0.0 }
    }

    /// Sine and cosine of the slope.
    #[inline]
    fn slope(&self) -> (f64, f64) {
        // Most roads: no root and no quotient in their steps.
        if self.grade == 0.0 {
            return (0.0, 1.0);
        }
        let cosine = (1.0 + self.grade * self.grade).sqrt().recip();
        (self.grade * cosine, cosine)
    }
}

/// Mean powers over a step with linearly changing speed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RoadLoad {
    /// Power lost to drag [W]; negative where a wind from behind pushes.
    pub drag_power_w: f64,
    /// Power lost to rolling resistance [W].
    pub rolling_power_w: f64,
    /// Rise of kinetic energy [W].
    pub kinetic_power_w: f64,
    /// Rise of potential energy [W].
    pub climb_power_w: f64,
}

impl RoadLoad {
    /// Power that the wheels must deliver; negative while braking [W].
    #[must_use]
    pub fn wheel_power_w(&self) -> f64 {
        self.drag_power_w + self.rolling_power_w + self.kinetic_power_w + self.climb_power_w
    }
}

impl BodyParameters {
    /// Kinetic energy with rotating masses [J].
    #[must_use]
    pub fn kinetic_energy_j(&self, speed_m_s: f64) -> f64 {
        0.5 * self.mass_kg * (1.0 + self.rotating_mass_share) * speed_m_s * speed_m_s
    }

    /// Potential energy that a way along a road brings [J].
    #[must_use]
    pub fn potential_energy_j(&self, road: &Road<'_>, way_m: f64) -> f64 {
        let (sine, _) = road.slope();
        self.mass_kg * GRAVITY_M_S2 * sine * way_m
    }

    /// Rolling resistance of warmed-up tyres, in proportion to how much colder than 25 degC ambient is [N].
    #[must_use]
    pub fn rolling_force_n(&self, ambient_k: f64) -> f64 {
        let colder_k = TYRE_REFERENCE_K - ambient_k;
        let force_n = self.mass_kg * GRAVITY_M_S2 * self.rolling_resistance_coefficient;
        force_n * (1.0 + self.rolling_resistance_rise_per_k * colder_k)
    }

    /// Road load between two speeds; exact means over the ramp, so sub-steps add up to the whole.
    #[must_use]
    pub fn road_load(&self, start_m_s: f64, end_m_s: f64, step_s: f64, road: &Road<'_>) -> RoadLoad {
        let (mean_speed, air) = (0.5 * (start_m_s + end_m_s), road.air);
        let (sine, cosine) = road.slope();
        let resisted_m3_s3 = resisted_m3_s3(start_m_s, end_m_s, road.headwind_m_s);
        RoadLoad {
            drag_power_w: 0.5 * air.density_kg_m3 * self.drag_area_m2 * resisted_m3_s3,
            rolling_power_w: self.rolling_force_n(air.temperature_k) * cosine * mean_speed,
            kinetic_power_w: (self.kinetic_energy_j(end_m_s) - self.kinetic_energy_j(start_m_s)) / step_s,
            climb_power_w: self.mass_kg * GRAVITY_M_S2 * sine * mean_speed,
        }
    }
}

/// Mean over a ramp of speed times the square of the speed against the air, in the direction of that [m3/s3].
fn resisted_m3_s3(start_m_s: f64, end_m_s: f64, headwind_m_s: f64) -> f64 {
    let mean_speed = 0.5 * (start_m_s + end_m_s);
    let mean_cube = mean_speed * 0.5 * (start_m_s * start_m_s + end_m_s * end_m_s);
    if headwind_m_s == 0.0 {
        return mean_cube;
    }
    let (start_air, end_air) = (start_m_s + headwind_m_s, end_m_s + headwind_m_s);
    if start_air * end_air < 0.0 {
        // On either side of where vehicle and wind are as fast the air pushes another way.
        let (share, as_fast_m_s) = (start_air / (start_air - end_air), -headwind_m_s);
        return share * resisted_m3_s3(start_m_s, as_fast_m_s, headwind_m_s)
            + (1.0 - share) * resisted_m3_s3(as_fast_m_s, end_m_s, headwind_m_s);
    }
    let mean_square = (start_m_s * start_m_s + start_m_s * end_m_s + end_m_s * end_m_s) / 3.0;
    let against = mean_cube + headwind_m_s * (2.0 * mean_square + headwind_m_s * mean_speed);
    if start_air + end_air < 0.0 { -against } else { against }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::air;
    use proptest::prelude::*;

    fn body() -> BodyParameters {
        BodyParameters {
            mass_kg: 1500.0,
            rotating_mass_share: 0.04,
            drag_area_m2: 0.7,
            rolling_resistance_coefficient: 0.01,
            rolling_resistance_rise_per_k: 0.008,
            solar_aperture_m2: 0.8,
        }
    }

    proptest! {
        #[test]
        fn half_steps_add_up_to_the_whole_step(
            a in 0.0..40.0_f64, b in 0.0..40.0_f64, headwind_m_s in -20.0..20.0_f64, grade in -0.3..0.3_f64,
        ) {
            let (air, middle) = (air::at_temperature(266.15), 0.5 * (a + b));
            let road = Road { air: &air, headwind_m_s, grade };
            let whole = body().road_load(a, b, 1.0, &road);
            let halves = [body().road_load(a, middle, 0.5, &road), body().road_load(middle, b, 0.5, &road)];
            let sum: f64 = halves.iter().map(|half| 0.5 * half.wheel_power_w()).sum();
            prop_assert!((whole.wheel_power_w() - sum).abs() < 1e-8 * (1.0 + sum.abs()));
        }
    }

    #[test]
    fn constant_speed_needs_drag_and_rolling_power_only() {
        let air = air::at_temperature(TYRE_REFERENCE_K);
        let load = body().road_load(20.0, 20.0, 1.0, &Road::level(&air));
        assert_eq!(load.kinetic_power_w, 0.0);
        assert!((load.drag_power_w - 0.5 * air.density_kg_m3 * 0.7 * 8000.0).abs() < 1e-9);
        assert!((load.rolling_power_w - 1500.0 * 9.81 * 0.01 * 20.0).abs() < 1e-9);
    }

    /// By hand: 6 % is 3.4336 degrees; the way up is what gravity works against, the air resists with the square of its speed.
    #[test]
    fn hills_cost_their_height_and_wind_its_square() {
        let air = air::at_temperature(TYRE_REFERENCE_K);
        let load =
            |headwind_m_s, grade| body().road_load(20.0, 20.0, 1.0, &Road { air: &air, headwind_m_s, grade });
        let (level, hill) = (load(0.0, 0.0), load(0.0, 0.06));
        let angle = 3.433_630_f64.to_radians();
        assert!((hill.climb_power_w - 1500.0 * 9.81 * angle.sin() * 20.0).abs() < 0.1, "{hill:?}");
        assert!((hill.rolling_power_w / level.rolling_power_w - angle.cos()).abs() < 1e-7);
        assert_eq!(load(0.0, -0.06).climb_power_w, -hill.climb_power_w);
        let way_up_j = body().potential_energy_j(&Road { air: &air, headwind_m_s: 0.0, grade: 0.06 }, 20.0);
        assert!((way_up_j - hill.climb_power_w).abs() < 1e-9);
        for (headwind_m_s, share) in [(10.0, 2.25), (-10.0, 0.25), (-20.0, 0.0), (-30.0, -0.25)] {
            let windy = load(headwind_m_s, 0.0);
            assert!(
                (windy.drag_power_w / level.drag_power_w - share).abs() < 1e-12,
                "{headwind_m_s}: {windy:?}"
            );
        }
    }

    /// UN Regulation 117, Annex 6: measured values are brought to 25 degC by 0.008 per kelvin for passenger cars' tyres.
    #[test]
    fn cold_tyres_roll_as_much_harder_as_regulation_117_corrects_for() {
        let at_reference_n = body().rolling_force_n(TYRE_REFERENCE_K);
        assert!((at_reference_n - 1500.0 * 9.81 * 0.01).abs() < 1e-9);
        for (degc, share) in [(35.0, 0.92), (20.0, 1.04), (0.0, 1.2), (-10.0, 1.28)] {
            let force_n = body().rolling_force_n(degc + ZERO_CELSIUS_K);
            assert!((force_n / at_reference_n - share).abs() < 1e-12, "{force_n} N at {degc} degC");
        }
    }
}
