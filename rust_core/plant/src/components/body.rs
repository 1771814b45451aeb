//! Longitudinal dynamics of the body.

use crate::config::ZERO_CELSIUS_K;
use crate::media::air::AirProperties;
use crate::parameters;

/// Standard gravity as used by WLTP road-load work [m/s2].
const GRAVITY_M_S2: f64 = 9.81;

/// Ambient temperature that the rolling resistance coefficient belongs to (ISO 28580, UN Regulation 117) [K].
const TYRE_REFERENCE_K: f64 = 25.0 + ZERO_CELSIUS_K;

parameters! {
    /// Longitudinal dynamics.
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
    }
}

/// Mean powers over a step with linearly changing speed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RoadLoad {
    /// Power lost to drag [W].
    pub drag_power_w: f64,
    /// Power lost to rolling resistance [W].
    pub rolling_power_w: f64,
    /// Rise of kinetic energy [W].
    pub kinetic_power_w: f64,
}

impl RoadLoad {
    /// Power that the wheels must deliver; negative while braking [W].
    #[must_use]
    pub fn wheel_power_w(&self) -> f64 {
        self.drag_power_w + self.rolling_power_w + self.kinetic_power_w
    }
}

impl BodyParameters {
    /// Kinetic energy with rotating masses [J].
    #[must_use]
    pub fn kinetic_energy_j(&self, speed_m_s: f64) -> f64 {
        0.5 * self.mass_kg * (1.0 + self.rotating_mass_share) * speed_m_s * speed_m_s
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
    pub fn road_load(&self, start_m_s: f64, end_m_s: f64, step_s: f64, air: &AirProperties) -> RoadLoad {
        let mean_speed = 0.5 * (start_m_s + end_m_s);
        let mean_cube = mean_speed * 0.5 * (start_m_s * start_m_s + end_m_s * end_m_s);
        RoadLoad {
            drag_power_w: 0.5 * air.density_kg_m3 * self.drag_area_m2 * mean_cube,
            rolling_power_w: self.rolling_force_n(air.temperature_k) * mean_speed,
            kinetic_power_w: (self.kinetic_energy_j(end_m_s) - self.kinetic_energy_j(start_m_s)) / step_s,
        }
    }
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
        }
    }

    proptest! {
        #[test]
        fn half_steps_add_up_to_the_whole_step(a in 0.0..40.0_f64, b in 0.0..40.0_f64) {
            let (air, middle) = (air::at_temperature(266.15), 0.5 * (a + b));
            let whole = body().road_load(a, b, 1.0, &air);
            let halves = [body().road_load(a, middle, 0.5, &air), body().road_load(middle, b, 0.5, &air)];
            let sum: f64 = halves.iter().map(|half| 0.5 * half.wheel_power_w()).sum();
            prop_assert!((whole.wheel_power_w() - sum).abs() < 1e-8 * (1.0 + sum.abs()));
        }
    }

    #[test]
    fn constant_speed_needs_drag_and_rolling_power_only() {
        let air = air::at_temperature(TYRE_REFERENCE_K);
        let load = body().road_load(20.0, 20.0, 1.0, &air);
        assert_eq!(load.kinetic_power_w, 0.0);
        assert!((load.drag_power_w - 0.5 * air.density_kg_m3 * 0.7 * 8000.0).abs() < 1e-9);
        assert!((load.rolling_power_w - 1500.0 * 9.81 * 0.01 * 20.0).abs() < 1e-9);
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
