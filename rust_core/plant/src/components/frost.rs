//! Frost on a front-end exchanger that takes heat from humid air below 0 degC.
//!
//! It grows with `m' = h_m A (X_air - X_sat(T_frost))`, where `h_m` follows from the heat transfer by Lewis. It narrows the gap
//! between the fins: less air passes, less surface is left, and heat has to pass the frost. Frost lies outside of the
//! vehicle, whose boundary is the wall of the exchanger, and counts from ice: what vapour gives off when it becomes ice comes
//! in with the heat from the air, what melts frost leaves with the heat to it.
//!
//! The other model has no growth: EnergyPlus' multiplier for defrosting on demand (22.2, section 15.2.11).

use super::ambient_exchanger::FrontAir;
use super::heat_exchanger::inlet_conductance_w_k;
use crate::config::{Validate, Violation, ZERO_CELSIUS_K};
use crate::media::moist_air;
use crate::parameters;
use serde::{Deserialize, Serialize};

/// What frost does to an exchanger.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum FrostModel {
    #[default]
    /// It grows and melts.
    Growth,
    /// Its mean effect with defrosting on demand, as EnergyPlus has it; nothing is remembered.
    Multipliers,
}

impl Validate for FrostModel {
    fn validate(&self) -> Result<(), Violation> {
        Ok(())
    }
}

parameters! {
    /// Frost on a front-end exchanger.
    pub struct FrostParameters {
        /// Surface of fins and tubes that frost grows on [m2]; 0: there is never any.
        area_m2: f64 = 0.0 .. 50.0,
        /// Gap between the fins, which frost narrows from both sides [mm].
        fin_gap_mm: f64 = 0.3 .. 10.0,
        /// Density of the frost [kg/m3].
        density_kg_m3: f64 = 30.0 .. 900.0,
        ;
        /// Whether it grows or only its mean effect counts.
        model: FrostModel,
    }
}

/// Frost of one exchanger.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Frost {
    /// Mass [kg].
    pub mass_kg: f64,
    /// By how much vapour that becomes frost warms the surface, as a rise of the air's temperature [K].
    pub rise_k: f64,
}

/// What frost makes of an exchanger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrostEffect {
    /// Air flow over that without frost [-].
    pub flow_share: f64,
    /// Conductance of the air over that without frost at the same air flow [-].
    pub air_share: f64,
    /// Resistance of the layer [K/W].
    pub layer_k_w: f64,
}

impl FrostEffect {
    /// None.
    pub const NONE: Self = Self { flow_share: 1.0, air_share: 1.0, layer_k_w: 0.0 };
}

/// Heat of sublimation and of melting of ice at 0 degC [J/kg].
const SUBLIMATION_J_KG: f64 = 2.834e6;
const MELTING_J_KG: f64 = 3.335e5;

/// Lewis number of water vapour in air, 0.86, to the power of 2/3.
const LEWIS_POWER: f64 = 0.904;

/// Least share of the gap that stays open: air finds a way where frost is uneven.
const LEAST_GAP: f64 = 0.1;

/// Share of a new rise that counts at once: as the surface warms, less vapour becomes frost, so the whole would overshoot.
const RISE_STEP: f64 = 0.5;

impl FrostParameters {
    /// Whether frost may grow.
    #[must_use]
    #[inline(always)]
    pub fn grows(&self) -> bool {
        self.area_m2 > 0.0 && self.model == FrostModel::Growth
    }

    /// Thickness of the layer [m].
    #[must_use]
    #[inline]
    pub fn thickness_m(&self, mass_kg: f64) -> f64 {
        mass_kg / (self.density_kg_m3 * self.area_m2)
    }

    /// Conductivity of frost of its density [W/(m K)] (Yonko and Sepsy 1967).
    #[must_use]
    #[inline]
    pub fn conductivity_w_m_k(&self) -> f64 {
        let density = self.density_kg_m3;
        0.024_22 + density * (7.214e-4 + 1.1797e-6 * density)
    }

    /// What a mass of frost makes of the exchanger.
    ///
    /// The pressure drop of a gap goes with its width to the power of -3, so at the same pressure the flow goes with that of
    /// 1.5; louvres fill up, so heat transfer goes with the width.
    #[must_use]
    #[inline]
    pub fn effect(&self, mass_kg: f64) -> FrostEffect {
        if mass_kg <= 0.0 {
            return FrostEffect::NONE;
        }
        let thickness_m = self.thickness_m(mass_kg);
        let open = (1.0 - 2e3 * thickness_m / self.fin_gap_mm).max(LEAST_GAP);
        FrostEffect {
            flow_share: open * open.sqrt(),
            air_share: open,
            layer_k_w: thickness_m / (self.conductivity_w_m_k() * self.area_m2),
        }
    }

    /// EnergyPlus' share of the capacity as heat source that defrosting on demand leaves; 1 where its rule does not apply.
    #[must_use]
    pub fn capacity_share(&self, ambient_k: f64, humidity_ratio: f64) -> f64 {
        if self.area_m2 <= 0.0 || self.model != FrostModel::Multipliers {
            return 1.0;
        }
        on_demand(ambient_k, humidity_ratio).capacity
    }
}

/// EnergyPlus' multipliers for defrosting on demand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Multipliers {
    /// Share of the time that defrosting takes [-].
    pub time_share: f64,
    /// Heating capacity over that without frost [-].
    pub capacity: f64,
    /// Power over that without frost [-].
    pub power: f64,
}

/// Multipliers at an ambient temperature and humidity (EnergyPlus 22.2, Engineering Reference 15.2.11: below 4.44 degC).
#[must_use]
pub fn on_demand(ambient_k: f64, humidity_ratio: f64) -> Multipliers {
    let degc = ambient_k - ZERO_CELSIUS_K;
    if degc > 4.44 {
        return Multipliers { time_share: 0.0, capacity: 1.0, power: 1.0 };
    }
    let coil_k = 0.82 * degc - 8.589 + ZERO_CELSIUS_K;
    let excess = (humidity_ratio - moist_air::saturation_ratio(coil_k)).max(1e-6);
    let time_share = 1.0 / (1.0 + 0.01446 / excess);
    Multipliers { time_share, capacity: 0.875 * (1.0 - time_share), power: 0.954 * (1.0 - time_share) }
}

/// What an exchanger met during a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Met {
    /// Air [K], without what the frost itself warms.
    pub air_k: f64,
    /// Water in that air [kg/kg].
    pub humidity_ratio: f64,
    /// Heat taken from the air; negative where heat is given to it [W].
    pub taken_w: f64,
}

impl Frost {
    /// The frost after a time in which the exchanger, with air as `front` has it, met something.
    pub fn advance(&mut self, own: &FrostParameters, front: &FrontAir, met: &Met, time_s: f64) {
        // Conductance between air and the surface of the frost, without the layer.
        let surface_ua_w_k = (front.ua_w_k.recip() - own.effect(self.mass_kg).layer_k_w).recip();
        let surface_w_k = inlet_conductance_w_k(front.rate_w_k, surface_ua_w_k);
        // Vapour brings no more than all that is taken, so it warms the surface no further than to the air's temperature.
        let latent_k = self.rise_k.min(met.taken_w.max(0.0) / surface_w_k);
        let surface_k = met.air_k + latent_k - met.taken_w / surface_w_k;
        if surface_k >= ZERO_CELSIUS_K {
            let melted_kg = surface_w_k * (surface_k - ZERO_CELSIUS_K) * time_s / MELTING_J_KG;
            *self = Self { mass_kg: (self.mass_kg - melted_kg).max(0.0), rise_k: 0.0 };
            return;
        }
        let excess = (met.humidity_ratio - moist_air::saturation_ratio(surface_k)).max(0.0);
        let vapour_w_k = inlet_conductance_w_k(front.rate_w_k, surface_ua_w_k / LEWIS_POWER);
        let growth_kg_s = vapour_w_k / crate::media::air::SPECIFIC_HEAT_J_KG_K * excess;
        self.mass_kg += growth_kg_s * time_s;
        self.rise_k += RISE_STEP * (SUBLIMATION_J_KG * growth_kg_s / surface_w_k - self.rise_k);
    }
}

#[cfg(test)]
mod tests {
    use super::super::ambient_exchanger::AmbientExchangerParameters;
    use super::*;

    fn frost() -> FrostParameters {
        FrostParameters { area_m2: 7.0, fin_gap_mm: 2.4, density_kg_m3: 160.0, model: FrostModel::Growth }
    }

    fn front(frost: &FrostEffect) -> FrontAir {
        FrontAir::of(&AmbientExchangerParameters { ua_w_k: 900.0, ..Default::default() }, 1.0, frost)
    }

    /// By hand: 1 g/kg more than saturation at the coil makes 1 / (1 + 14.46) of the time, 0.0646831.
    #[test]
    fn multipliers_are_those_of_energyplus() {
        let ambient_k = ZERO_CELSIUS_K + 0.0;
        let saturated = moist_air::saturation_ratio(ZERO_CELSIUS_K - 8.589);
        let wet = on_demand(ambient_k, saturated + 0.001);
        assert!((wet.time_share - 0.064_683_05).abs() < 1e-8, "{wet:?}");
        assert!(
            (wet.capacity - 0.818_402_33).abs() < 1e-8 && (wet.power - 0.892_292_37).abs() < 1e-8,
            "{wet:?}"
        );
        // Dry air counts with an excess of 1e-6.
        let dry = on_demand(ambient_k, 0.0);
        assert!(
            (dry.capacity - 0.874_939_49).abs() < 1e-8 && (dry.power - 0.953_934_03).abs() < 1e-8,
            "{dry:?}"
        );
        assert_eq!(on_demand(ZERO_CELSIUS_K + 4.5, 0.004).capacity, 1.0);
        let simple = FrostParameters { model: FrostModel::Multipliers, ..frost() };
        assert_eq!(simple.capacity_share(ambient_k, saturated + 0.001), wet.capacity);
        assert_eq!(frost().capacity_share(ambient_k, saturated + 0.001), 1.0);
    }

    /// Sui et al. 2023, doi 10.3390/su151813998: at 0.8 mm and the same air flow the pressure drop is 28.4 times as large and
    /// three quarters of the heat transfer are lost.
    #[test]
    fn a_layer_does_what_a_published_calculation_says() {
        let own = frost();
        let mass_kg = 0.8e-3 * own.density_kg_m3 * own.area_m2;
        let effect = own.effect(mass_kg);
        let pressure_drop = effect.flow_share.powi(-2);
        assert!((pressure_drop / 28.4 - 1.0).abs() < 0.1, "{pressure_drop}");
        let left = front(&effect).ua_w_k / front(&FrostEffect::NONE).ua_w_k;
        assert!((left - 0.25).abs() < 0.06, "{left}");
        assert_eq!(own.effect(0.0), FrostEffect::NONE);
    }

    /// By hand with saturated air at -5.04 degC holding 2.467 g/kg over ice (PsychroLib 2.5.0): conductance to the surface
    /// 594.9 W/K, exchange of vapour 0.6283 kg/s.
    #[test]
    fn growth_follows_from_the_excess_of_humidity_over_the_surface() {
        let mut state = Frost::default();
        let met = Met { air_k: ZERO_CELSIUS_K, humidity_ratio: 0.0032, taken_w: 3000.0 };
        state.advance(&frost(), &front(&FrostEffect::NONE), &met, 1.0);
        assert!((state.mass_kg / (0.6283 * (0.0032 - 0.002_467)) - 1.0).abs() < 0.01, "{state:?}");
        let rise_k = 0.5 * 2.834e6 * state.mass_kg / 594.9;
        assert!((state.rise_k / rise_k - 1.0).abs() < 1e-3, "{state:?} {rise_k}");
        // Air drier than the surface leaves the frost as it is.
        let before = state;
        state.advance(&frost(), &front(&FrostEffect::NONE), &Met { humidity_ratio: 0.001, ..met }, 1.0);
        assert_eq!(state.mass_kg, before.mass_kg);
    }

    /// Heat from the coolant, or from air above 0 degC, melts 1 kg with 333.5 kJ; nothing is heated beyond that.
    #[test]
    fn heat_melts_what_its_latent_heat_says() {
        for (air_degc, taken_w) in [(5.0, 0.0), (0.0, -2000.0), (-2.0, -4000.0)] {
            let (own, mut state) = (frost(), Frost { mass_kg: 0.5, rise_k: 0.0 });
            let air = front(&own.effect(0.5));
            let surface_ua_w_k = 900.0 * own.effect(0.5).air_share;
            let surface_w_k = 1006.0 * (1.0 - f64::exp(-surface_ua_w_k / 1006.0));
            let met = Met { air_k: ZERO_CELSIUS_K + air_degc, humidity_ratio: 0.003, taken_w };
            state.advance(&own, &air, &met, 1.0);
            let melted_j = (0.5 - state.mass_kg) * 3.335e5;
            let expected_j = surface_w_k * air_degc - taken_w;
            assert!((melted_j - expected_j).abs() < 1e-6 * expected_j, "{melted_j} {expected_j}");
            for _ in 0..3600 {
                state.advance(&own, &air, &met, 1.0);
            }
            assert_eq!(state.mass_kg, 0.0);
        }
    }
}
