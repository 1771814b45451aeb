//! Windscreen: temperature of its inner surface, for fog.
//!
//! Its heat is part of the panels' conductance: here it is only told apart, so that it adds nothing to the energy ledger. What
//! air blown at it loses beyond that is a larger conductance of the panels. Sun, radiation to the sky and the heat of fog itself
//! are left out.

use crate::media::air::SPECIFIC_HEAT_J_KG_K;
use crate::parameters;

/// Conductivity of laminated glass: 3.74 mm of glass (1.0) and 0.76 mm of PVB (0.21) in series [W/(m K)].
const CONDUCTIVITY_W_M_K: f64 = 0.61;

/// Heat capacity of glass by volume: 2500 kg/m3, 800 J/(kg K) [J/(m3 K)].
const VOLUMETRIC_HEAT_J_M3_K: f64 = 2.0e6;

/// Lewis number of vapour in air to the power of two thirds [-] (Bergman et al., table A.8: 0.865 at 25 degC).
const LEWIS_POWER: f64 = 0.908;

/// Water that stays on a square metre of glass; more runs down [kg/m2] (assumed).
const FILM_KG_M2: f64 = 0.05;

parameters! {
    /// Windscreen.
    pub struct WindscreenParameters {
        /// Area [m2].
        area_m2: f64 = 0.1 .. 10.0,
        /// Thickness of the laminate [m].
        thickness_m: f64 = 0.001 .. 0.03,
        /// Inner coefficient of heat transfer while no air is blown at it [W/(m2 K)].
        inner_coefficient_w_m2_k: f64 = 0.5 .. 50.0,
        /// Its rise with the air blown at it [W/(m2 K) per kg/s].
        inner_coefficient_per_flow_j_m2_kg_k: f64 = 0.0 .. 5000.0,
        /// Outer coefficient at standstill [W/(m2 K)].
        outer_coefficient_w_m2_k: f64 = 0.5 .. 50.0,
        /// Its rise with vehicle speed [W/(m2 K) per m/s].
        outer_coefficient_per_speed_w_s_m3_k: f64 = 0.0 .. 20.0,
    }
}

/// What a windscreen meets during a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WindscreenConditions {
    /// Inner conductance [W/K].
    pub inner_w_k: f64,
    /// From the inner surface through the glass to ambient [W/K].
    pub outer_w_k: f64,
    /// Share of the inner conductance that blown air makes [-].
    pub blown_share: f64,
    /// Air that is moved along the inner surface, as one that gives off all its water [kg/s].
    pub water_exchange_kg_s: f64,
    /// Conductance from cabin air to ambient beyond that without blown air [W/K].
    pub extra_w_k: f64,
}

impl WindscreenParameters {
    /// Conductances with so much air blown at it, at a vehicle speed.
    #[must_use]
    #[inline]
    pub fn conditions(&self, blown_kg_s: f64, speed_m_s: f64) -> WindscreenConditions {
        let rest = self.inner_coefficient_w_m2_k;
        let blown = self.inner_coefficient_per_flow_j_m2_kg_k * blown_kg_s;
        let inner_w_k = self.area_m2 * (rest + blown);
        let outside = self.outer_coefficient_w_m2_k + self.outer_coefficient_per_speed_w_s_m3_k * speed_m_s;
        let outer_w_k = self.area_m2 / (self.thickness_m / CONDUCTIVITY_W_M_K + outside.recip());
        let in_series = |inner_w_k: f64| inner_w_k * outer_w_k / (inner_w_k + outer_w_k);
        WindscreenConditions {
            inner_w_k,
            outer_w_k,
            blown_share: blown / (rest + blown),
            water_exchange_kg_s: inner_w_k / (SPECIFIC_HEAT_J_KG_K * LEWIS_POWER),
            extra_w_k: if blown > 0.0 { in_series(inner_w_k) - in_series(self.area_m2 * rest) } else { 0.0 },
        }
    }

    /// Heat capacity of the glass [J/K].
    #[must_use]
    #[inline]
    pub fn heat_capacity_j_k(&self) -> f64 {
        self.area_m2 * self.thickness_m * VOLUMETRIC_HEAT_J_M3_K
    }

    /// Most water that stays on it [kg].
    #[must_use]
    #[inline]
    pub fn largest_film_kg(&self) -> f64 {
        self.area_m2 * FILM_KG_M2
    }

    /// Temperature of the inner surface after a step (backward Euler) between air and ambient [K].
    #[must_use]
    #[inline]
    pub fn after(
        &self,
        start_k: f64,
        now: &WindscreenConditions,
        air_k: f64,
        ambient_k: f64,
        step_s: f64,
    ) -> f64 {
        let inertia_w_k = self.heat_capacity_j_k() / step_s;
        let into_w = inertia_w_k * start_k + now.inner_w_k * air_k + now.outer_w_k * ambient_k;
        into_w / (inertia_w_k + now.inner_w_k + now.outer_w_k)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::vehicle::VehicleParameters;

    fn windscreen() -> WindscreenParameters {
        VehicleParameters::load("jeffs2019", &[]).expect("built in").cabin().windscreen.clone()
    }

    /// By hand, 60 km/h: 1/8 + 0.0045/0.61 + 1/(5.8 + 3.2 16.667) = 0.125 + 0.00738 + 0.01691 m2 K/W; of 40 K the inner surface
    /// keeps 0.02429/0.14929.
    #[test]
    fn steady_temperature_is_that_of_resistances_in_series() {
        let (glass, speed_m_s) = (windscreen(), 60.0 / 3.6);
        let now = glass.conditions(0.0, speed_m_s);
        let mut surface_k = 300.0;
        for _ in 0..5000 {
            surface_k = glass.after(surface_k, &now, 293.15, 253.15, 1.0);
        }
        let expected_k = 253.15 + 40.0 * 0.02429 / 0.14929;
        assert!((surface_k - expected_k).abs() < 0.02, "{surface_k} {expected_k}");
        assert_eq!(now.extra_w_k, 0.0);
    }

    #[test]
    fn blown_air_warms_it_and_costs_heat() {
        let glass = windscreen();
        let (rest, blown) = (glass.conditions(0.0, 15.0), glass.conditions(0.09, 15.0));
        let end = |now| glass.after(260.0, now, 295.15, 263.15, 1e9);
        assert!(end(&blown) > end(&rest) + 10.0);
        assert!(blown.extra_w_k > 5.0 && blown.extra_w_k < 40.0, "{blown:?}");
        assert!((0.7..0.9).contains(&blown.blown_share), "{blown:?}");
    }

    #[test]
    fn any_step_is_stable() {
        let glass = windscreen();
        let now = glass.conditions(0.1, 30.0);
        for step_s in [1e-3, 1.0, 1e6] {
            let after_k = glass.after(290.0, &now, 310.0, 260.0, step_s);
            assert!((260.0..310.0).contains(&after_k), "{after_k} after {step_s} s");
        }
    }
}
