//! Cooling core below the dew point: bypass factor (Carrier; ASHRAE Fundamentals).
//!
//! The air that touches the core leaves it saturated at the temperature of its surface, the rest passes by. Latent heat warms the
//! surface through the resistance of the coolant side, so that the sensible heat falls; it leaves through the core as well.

use crate::media::moist_air::saturation_ratio;
use crate::numerics::elementary;

/// Slope of the saturated humidity ratio over itself: latent heat over the gas constant of vapour, 2.47e6 / 461.5 [K].
const CLAUSIUS_CLAPEYRON_K: f64 = 5352.0;

/// Newton's steps from the dry surface: the third is within 0.1 % of the condensed water up to 45 degC.
const NEWTON_STEPS: usize = 3;

/// A core that air passes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Core {
    /// Air flow [kg/s], and its capacity rate [W/K].
    pub air_kg_s: f64,
    /// Its capacity rate [W/K].
    pub air_w_k: f64,
    /// Conductance of the air side [W/K].
    pub air_ua_w_k: f64,
    /// Conductance between the inlets of air and coolant while it is dry [W/K].
    pub dry_w_k: f64,
    /// Air at the inlet [K].
    pub inlet_k: f64,
    /// Its humidity ratio [kg/kg].
    pub inlet_ratio: f64,
    /// Coolant, or refrigerant, at its inlet [K].
    pub coolant_k: f64,
    /// Heat that a kilogram of condensing water gives off [J/kg].
    pub latent_j_kg: f64,
}

/// A core on which water condenses.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WetSurface {
    /// Temperature of its surface, the apparatus dew point [K].
    pub surface_k: f64,
    /// Humidity ratio of air that is saturated there [kg/kg].
    pub surface_ratio: f64,
    /// Air that touches the surface [kg/s].
    pub touched_kg_s: f64,
    /// Sensible conductance over that of the dry core [-].
    pub sensible_share: f64,
}

impl Core {
    /// Share of the air that touches the surface: 1 less the bypass factor [-].
    #[must_use]
    #[inline]
    pub fn contact_factor(&self) -> f64 {
        -elementary::exp_m1(-self.air_ua_w_k / self.air_w_k)
    }

    /// The surface, if water condenses on it.
    #[must_use]
    #[inline]
    pub fn wet(&self) -> Option<WetSurface> {
        if self.inlet_ratio <= 0.0 || self.dry_w_k <= 0.0 || self.inlet_k <= self.coolant_k {
            return None;
        }
        let contact = self.contact_factor();
        let touched_kg_s = contact * self.air_kg_s;
        let air_w_k = contact * self.air_w_k;
        // What the dry core's conductance leaves to the coolant side.
        let coolant_w_k = self.dry_w_k * air_w_k / (air_w_k - self.dry_w_k).max(1e-6 * air_w_k);
        let dry_k = (air_w_k * self.inlet_k + coolant_w_k * self.coolant_k) / (air_w_k + coolant_w_k);
        let mut surface_ratio = saturation_ratio(dry_k);
        if self.inlet_ratio <= surface_ratio {
            return None;
        }
        let latent_w = touched_kg_s * self.latent_j_kg;
        let mut surface_k = dry_k;
        for _ in 0..NEWTON_STEPS {
            let slope = surface_ratio * CLAUSIUS_CLAPEYRON_K / (surface_k * surface_k);
            let excess_w = air_w_k * (self.inlet_k - surface_k)
                + latent_w * (self.inlet_ratio - surface_ratio)
                - coolant_w_k * (surface_k - self.coolant_k);
            surface_k += excess_w / (air_w_k + coolant_w_k + latent_w * slope);
            surface_ratio = saturation_ratio(surface_k);
        }
        let sensible_share = ((self.inlet_k - surface_k) / (self.inlet_k - dry_k)).clamp(0.0, 1.0);
        Some(WetSurface { surface_k, surface_ratio, touched_kg_s, sensible_share })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::moist_air::{humidity_ratio, latent_heat_j_kg};
    use proptest::prelude::*;

    fn core(inlet_degc: f64, relative: f64, coolant_degc: f64) -> Core {
        let (air_kg_s, inlet_k) = (0.1, inlet_degc + 273.15);
        Core {
            air_kg_s,
            air_w_k: air_kg_s * 1006.0,
            air_ua_w_k: 250.0 / 0.7,
            dry_w_k: 80.0,
            inlet_k,
            inlet_ratio: humidity_ratio(relative, inlet_k),
            coolant_k: coolant_degc + 273.15,
            latent_j_kg: latent_heat_j_kg(283.15),
        }
    }

    /// Bisected in scripts/check_moist_air.py with CoolProp's `HAPropsSI("W", ...)` for the saturated air: surface [degC],
    /// sensible and latent heat [W].
    #[test]
    fn surface_and_heats_are_those_of_a_solution_with_coolprop() {
        for (inlet_degc, relative, coolant_degc, surface_degc, sensible_w, latent_w) in WET_CORES {
            let core = core(inlet_degc, relative, coolant_degc);
            let wet = core.wet().expect("below the dew point");
            let sensible_found_w = core.dry_w_k * wet.sensible_share * (core.inlet_k - core.coolant_k);
            let latent_found_w = wet.touched_kg_s * (core.inlet_ratio - wet.surface_ratio) * core.latent_j_kg;
            assert!((wet.surface_k - 273.15 - surface_degc).abs() < 0.1, "{wet:?} {surface_degc}");
            assert!((sensible_found_w / sensible_w - 1.0).abs() < 0.01, "{sensible_found_w} {sensible_w}");
            assert!((latent_found_w / latent_w - 1.0).abs() < 0.02, "{latent_found_w} {latent_w}");
        }
    }

    const WET_CORES: [(f64, f64, f64, f64, f64, f64); 3] = [
        (35.0, 0.4, 3.0, 11.384, 2307.6, 1392.6),
        (25.0, 0.5, 3.0, 8.360, 1625.9, 739.7),
        (30.0, 0.9, 5.0, 15.524, 1414.5, 3230.4),
    ];

    #[test]
    fn nothing_condenses_above_the_dew_point_and_without_water() {
        // Dew point of 35 degC and 20 %: 8.7 degC.
        assert_eq!(core(35.0, 0.2, 9.0).wet(), None);
        assert_eq!(core(35.0, 0.0, -20.0).wet(), None);
        assert_eq!(core(5.0, 1.0, 6.0).wet(), None);
    }

    proptest! {
        #[test]
        fn the_surface_is_between_coolant_and_dew_point(
            inlet_degc in 0.0..45.0_f64, relative in 0.0..1.0_f64, coolant_degc in -20.0..40.0_f64, dry_share in 0.01..0.99_f64,
        ) {
            let mut core = core(inlet_degc, relative, coolant_degc);
            core.dry_w_k = dry_share * core.contact_factor() * core.air_w_k;
            if let Some(wet) = core.wet() {
                prop_assert!(wet.surface_k > core.coolant_k && wet.surface_k < core.inlet_k);
                prop_assert!(wet.surface_ratio <= core.inlet_ratio * (1.0 + 1e-3), "{wet:?} {core:?}");
                prop_assert!((0.0..=1.0).contains(&wet.sensible_share));
            }
        }
    }
}
