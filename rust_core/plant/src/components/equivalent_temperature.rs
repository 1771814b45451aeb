//! Equivalent temperature: that of a uniform room with still air in which a person loses as much heat (Madsen; ISO 14505-2).

use crate::architecture::layout::CabinLayout;
use crate::config::ZERO_CELSIUS_K;
use crate::numerics::thermal_network::{Node, NodeValues};

/// Warmth of clothes [clo] (assumed: indoor clothes in winter; ISO 9920).
const CLOTHES_CLO: f64 = 1.0;

/// Air speed up to which air counts as still [m/s].
const STILL_M_S: f64 = 0.1;

/// Air speed at a person without blown air [m/s], and its rise with the air flow [m/s per kg/s] (assumed: 0.3 m/s at 0.1 kg/s).
const REST_SPEED_M_S: f64 = 0.05;
const SPEED_PER_FLOW_M_KG: f64 = 2.5;

/// Air speed at the people in a cabin [m/s].
#[must_use]
pub fn air_speed_m_s(supply_kg_s: f64) -> f64 {
    REST_SPEED_M_S + SPEED_PER_FLOW_M_KG * supply_kg_s
}

/// Equivalent temperature [degC] of air and radiant temperature [degC] at an air speed [m/s].
#[must_use]
pub fn equivalent_temperature_degc(air_degc: f64, radiant_degc: f64, speed_m_s: f64) -> f64 {
    if speed_m_s <= STILL_M_S {
        return 0.5 * (air_degc + radiant_degc);
    }
    let draught = (0.24 - 0.75 * speed_m_s.sqrt()) / (1.0 + CLOTHES_CLO);
    0.55 * air_degc + 0.45 * radiant_degc + draught * (36.5 - air_degc)
}

/// Equivalent temperature of a cabin [degC], its furnishings being what radiates, with air that its blower moves [kg/s].
#[must_use]
pub fn of_cabin(cabin: &CabinLayout, temperatures_k: &NodeValues, supply_kg_s: f64) -> f64 {
    let degc = |node: Node| temperatures_k[node.index()] - ZERO_CELSIUS_K;
    let radiant_degc = 0.5 * (degc(cabin.soft) + degc(cabin.hard));
    equivalent_temperature_degc(degc(cabin.air), radiant_degc, air_speed_m_s(supply_kg_s))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand from the published formula.
    #[test]
    fn equivalent_temperatures_are_those_of_the_formula() {
        assert_eq!(equivalent_temperature_degc(22.0, 18.0, 0.1), 20.0);
        // 12.1 + 8.1 + (0.24 - 0.75 0.5) / 2 (36.5 - 22) = 20.2 - 0.97875
        assert!((equivalent_temperature_degc(22.0, 18.0, 0.25) - 19.221_25).abs() < 1e-12);
        // Air and walls at the temperature of the skin: no draught is felt.
        assert!((equivalent_temperature_degc(36.5, 36.5, 0.4) - 36.5).abs() < 1e-12);
    }

    #[test]
    fn it_is_nearly_continuous_where_air_begins_to_move() {
        let at = |speed_m_s| equivalent_temperature_degc(22.0, 18.0, speed_m_s);
        assert!((at(0.1) - at(0.1 + 1e-9)).abs() < 0.25);
    }
}
