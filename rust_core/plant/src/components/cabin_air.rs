//! Water and carbon dioxide in the air of a cabin, fog on its windscreen.
//!
//! One well-mixed volume. Fresh air comes in with the humidity of ambient, the exhaust (through its recovery too) leaves with that
//! of the cabin, recirculated air goes round. Both balances are backward Euler with transfer coefficients that hold during a
//! step, so they are stable with any step and close to round-off. The heat of the vapour itself (1.9 against 2501 kJ/kg) is left
//! out of the energy of air.

use super::wet_core::WetSurface;
use super::windscreen::{WindscreenConditions, WindscreenParameters};
use crate::media::moist_air::{dew_point_k, saturation_ratio};
use crate::parameters;
use serde::{Deserialize, Serialize};

/// Carbon dioxide in ambient air [-].
pub const AMBIENT_CO2: f64 = 420e-6;

/// Density of the air of a cabin: at 20 degC [kg/m3].
const DENSITY_KG_M3: f64 = 1.204;

/// Smallest flow of water that a residual is compared with: a quarter of an occupant's [kg/s].
pub const SMALLEST_WATER_KG_S: f64 = 1e-5;

parameters! {
    /// Air of a cabin and what its occupants give it.
    pub struct CabinAirParameters {
        /// Volume [m3].
        volume_m3: f64 = 0.1 .. 100.0,
        /// Water that an occupant breathes out and evaporates [kg/s].
        occupant_moisture_kg_s: f64 = 0.0 .. 0.001,
        /// Carbon dioxide that an occupant breathes out [m3/s].
        occupant_co2_m3_s: f64 = 0.0 .. 0.0001,
        /// Share of the cooling core's resistance that is on the side of the air [-].
        cooling_core_air_share: f64 = 0.3 .. 0.95,
    }
}

/// Air of a cabin.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct CabinAir {
    /// Water in a kilogram of dry air [kg/kg].
    pub humidity_ratio: f64,
    /// Carbon dioxide, by volume [-].
    pub co2: f64,
    /// Inner surface of the windscreen [K].
    pub windscreen_k: f64,
    /// Water on it [kg].
    pub film_kg: f64,
}

/// What the air of a cabin meets during a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AirConditions {
    /// Blown air [kg/s].
    pub supply_kg_s: f64,
    /// Recirculated share [-].
    pub recirculation: f64,
    /// Humidity ratio of ambient [kg/kg].
    pub ambient_ratio: f64,
    /// People.
    pub occupants: f64,
    /// Core on which water condenses.
    pub wet: Option<WetSurface>,
    /// Windscreen.
    pub windscreen: WindscreenConditions,
    /// Air at the windscreen [K].
    pub windscreen_air_k: f64,
    /// Ambient [K].
    pub ambient_k: f64,
}

/// Flows of water of a cabin during a step [kg/s].
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct WaterFlows {
    /// With fresh air.
    pub fresh_kg_s: f64,
    /// From the occupants.
    pub occupants_kg_s: f64,
    /// With the exhaust.
    pub exhaust_kg_s: f64,
    /// Condensing on the cooling core, from where it drains.
    pub core_kg_s: f64,
    /// Condensing on the windscreen; negative while that dries.
    pub windscreen_kg_s: f64,
    /// Running down the windscreen.
    pub drained_kg_s: f64,
}

impl WaterFlows {
    /// Adds other flows with a weight.
    pub fn accumulate(&mut self, other: &Self, weight: f64) {
        self.fresh_kg_s += weight * other.fresh_kg_s;
        self.occupants_kg_s += weight * other.occupants_kg_s;
        self.exhaust_kg_s += weight * other.exhaust_kg_s;
        self.core_kg_s += weight * other.core_kg_s;
        self.windscreen_kg_s += weight * other.windscreen_kg_s;
        self.drained_kg_s += weight * other.drained_kg_s;
    }
}

impl CabinAir {
    /// Air of a parked cabin: as dry as can be, ambient's carbon dioxide, a dry windscreen.
    #[must_use]
    pub fn parked(windscreen_k: f64) -> Self {
        Self { humidity_ratio: 0.0, co2: AMBIENT_CO2, windscreen_k, film_kg: 0.0 }
    }

    /// Dew point [K].
    #[must_use]
    pub fn dew_point_k(&self) -> f64 {
        dew_point_k(self.humidity_ratio)
    }

    /// How far the inner surface of the windscreen is above the dew point of the air [K]; below 0 it fogs up.
    #[must_use]
    pub fn fog_margin_k(&self) -> f64 {
        self.windscreen_k - self.dew_point_k()
    }
}

impl CabinAirParameters {
    /// Dry air in it [kg].
    #[must_use]
    #[inline]
    pub fn mass_kg(&self) -> f64 {
        DENSITY_KG_M3 * self.volume_m3
    }

    /// Water in air and on the windscreen [kg].
    #[must_use]
    #[inline]
    pub fn water_kg(&self, air: &CabinAir) -> f64 {
        self.mass_kg() * air.humidity_ratio + air.film_kg
    }

    /// Steps the air; returns the flows of water.
    #[inline]
    pub fn step(
        &self,
        glass: &WindscreenParameters,
        air: &mut CabinAir,
        now: &AirConditions,
        step_s: f64,
    ) -> WaterFlows {
        let fresh_kg_s = (1.0 - now.recirculation) * now.supply_kg_s;
        air.windscreen_k =
            glass.after(air.windscreen_k, &now.windscreen, now.windscreen_air_k, now.ambient_k, step_s);
        let inertia_kg_s = self.mass_kg() / step_s;
        let breathed_kg_s = now.occupants * self.occupant_co2_m3_s * DENSITY_KG_M3;
        air.co2 =
            (inertia_kg_s * air.co2 + fresh_kg_s * AMBIENT_CO2 + breathed_kg_s) / (inertia_kg_s + fresh_kg_s);
        let balance = WaterBalance {
            inertia_kg_s,
            fresh_kg_s,
            occupants_kg_s: now.occupants * self.occupant_moisture_kg_s,
            exchange_kg_s: now.windscreen.water_exchange_kg_s,
            glass_ratio: saturation_ratio(air.windscreen_k),
            most_drying_kg_s: air.film_kg / step_s,
        };
        let (ratio, flows) = balance.solve(air.humidity_ratio, now);
        air.humidity_ratio = ratio;
        let film_kg = air.film_kg + flows.windscreen_kg_s * step_s;
        air.film_kg = film_kg.clamp(0.0, glass.largest_film_kg());
        WaterFlows { drained_kg_s: (film_kg - air.film_kg).max(0.0) / step_s, ..flows }
    }
}

/// What is known of the water before a step.
struct WaterBalance {
    inertia_kg_s: f64,
    fresh_kg_s: f64,
    occupants_kg_s: f64,
    exchange_kg_s: f64,
    glass_ratio: f64,
    most_drying_kg_s: f64,
}

impl WaterBalance {
    /// Humidity ratio at the end of a step and the flows.
    ///
    /// Core and windscreen are taken for wet; where the one would give off water, or the other more than there is on it, they
    /// are not, and the linear balance is solved again.
    #[inline]
    fn solve(&self, start_ratio: f64, now: &AirConditions) -> (f64, WaterFlows) {
        let fresh_in_kg_s = self.fresh_kg_s * now.ambient_ratio;
        let into_kg_s = self.inertia_kg_s * start_ratio + fresh_in_kg_s + self.occupants_kg_s;
        let (mut wet, mut dries_up) = (now.wet, false);
        loop {
            let mut known_kg_s = into_kg_s;
            let mut out_kg_s = self.inertia_kg_s + self.fresh_kg_s;
            let fresh_part = (1.0 - now.recirculation) * now.ambient_ratio;
            if let Some(core) = wet {
                known_kg_s += core.touched_kg_s * (core.surface_ratio - fresh_part);
                out_kg_s += core.touched_kg_s * now.recirculation;
            }
            if dries_up {
                known_kg_s += self.most_drying_kg_s;
            } else {
                known_kg_s += self.exchange_kg_s * self.glass_ratio;
                out_kg_s += self.exchange_kg_s;
            }
            let ratio = known_kg_s / out_kg_s;
            let core_kg_s = wet.map_or(0.0, |core| {
                core.touched_kg_s * (fresh_part + now.recirculation * ratio - core.surface_ratio)
            });
            let windscreen_kg_s = if dries_up {
                -self.most_drying_kg_s
            } else {
                self.exchange_kg_s * (ratio - self.glass_ratio)
            };
            if core_kg_s < 0.0 {
                wet = None;
            } else if windscreen_kg_s < -self.most_drying_kg_s {
                dries_up = true;
            } else {
                let flows = WaterFlows {
                    fresh_kg_s: fresh_in_kg_s,
                    occupants_kg_s: self.occupants_kg_s,
                    exhaust_kg_s: self.fresh_kg_s * ratio,
                    core_kg_s,
                    windscreen_kg_s,
                    drained_kg_s: 0.0,
                };
                return (ratio, flows);
            }
        }
    }
}
