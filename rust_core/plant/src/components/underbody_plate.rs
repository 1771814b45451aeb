//! The plate between battery and underbody air, equations (1) to (5).

use crate::media::air::AirProperties;
use crate::numerics::elementary;
use crate::parameters;

/// Reynolds number of transition on a flat plate (Bergman et al., section 7.2).
const TRANSITION_REYNOLDS: f64 = 5e5;

parameters! {
    /// Plate between pack and underbody air, equations (1) to (5).
    pub struct PlateParameters {
        /// Length along the flow [m].
        length_m: f64 = 0.1 .. 20.0,
        /// Width [m].
        width_m: f64 = 0.1 .. 4.0,
        /// Conductance between pack and plate [W/K].
        pack_conductance_w_k: f64 = 0.01 .. 1000.0,
        /// Natural-convection conductance of the plate at standstill [W/K].
        natural_convection_w_k: f64 = 0.0 .. 100.0,
    }
}

/// Mean convection coefficient of parallel flow over a flat plate [W/(m2 K)].
///
/// Above transition the mixed correlation of equation (1), `(0.037 Re^0.8 - 871) Pr^(1/3) k / L`; below it,
/// where that turns negative, the laminar mean `0.664 Re^0.5 Pr^(1/3) k / L`. They meet at Re = 5e5.
#[must_use]
pub fn convection_coefficient_w_m2_k(speed_m_s: f64, length_m: f64, air: &AirProperties) -> f64 {
    let reynolds = speed_m_s * length_m * air.per_kinematic_viscosity_s_m2;
    let scale = air.prandtl_cube_root * air.conductivity_w_m_k / length_m;
    if reynolds < TRANSITION_REYNOLDS {
        0.664 * reynolds.sqrt() * scale
    } else {
        (0.037 * elementary::power(reynolds, 0.8) - 871.0) * scale
    }
}

impl PlateParameters {
    /// Conductance between battery and ambient air [W/K].
    ///
    /// Equation (5) is printed with an extra length; heat flow is coefficient times area `W L`.
    #[must_use]
    pub fn conductance_to_ambient_w_k(&self, speed_m_s: f64, air: &AirProperties) -> f64 {
        let coefficient = convection_coefficient_w_m2_k(speed_m_s, self.length_m, air);
        let outside = coefficient * self.width_m * self.length_m + self.natural_convection_w_k;
        self.pack_conductance_w_k * outside / (self.pack_conductance_w_k + outside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::air;

    #[test]
    fn mixed_correlation_matches_published_values_over_the_paper_s_4_m() {
        let air = air::at_temperature(273.15);
        for (speed, expected) in [(5.0, 12.8), (10.0, 25.8), (20.0, 48.4), (30.0, 68.8)] {
            let value = convection_coefficient_w_m2_k(speed, 4.0, &air);
            assert!((value / expected - 1.0).abs() < 0.02, "{value} at {speed} m/s");
        }
    }

    #[test]
    fn laminar_and_mixed_laws_meet_at_transition_and_never_turn_negative() {
        let air = air::at_temperature(273.15);
        let transition = TRANSITION_REYNOLDS / (air.per_kinematic_viscosity_s_m2 * 4.0);
        let below = convection_coefficient_w_m2_k(transition * 0.999_999, 4.0, &air);
        let above = convection_coefficient_w_m2_k(transition * 1.000_001, 4.0, &air);
        assert!((below / above - 1.0).abs() < 1e-3);
        assert_eq!(convection_coefficient_w_m2_k(0.0, 4.0, &air), 0.0);
        let mut last = 0.0;
        for i in 1..400 {
            let value = convection_coefficient_w_m2_k(0.1 * f64::from(i), 4.0, &air);
            assert!(value > last, "falls at {} m/s", 0.1 * f64::from(i));
            last = value * 0.999;
        }
    }
}
