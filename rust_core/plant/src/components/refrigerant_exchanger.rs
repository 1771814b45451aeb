//! Condenser and evaporator: coolant on one side, refrigerant at constant saturation temperature on the other.
//!
//! The duty follows `Q = C (1 - exp(-UA/C)) |T_saturation - T_coolant,in|` (`heat_exchanger`, Bergman et al.,
//! chapter 11). Superheat and subcooling fade where the coolant leaves no room for them, so no stream crosses.

use crate::numerics::dual::Real;

/// Superheat or subcooling that a coolant `available_k` away from saturation allows [K].
///
/// `x / (1 + (x/target)^4)^(1/4)`: smooth, below both the target and what is available.
#[inline]
pub fn approach_limited_k<T: Real>(target_k: f64, available_k: T) -> T {
    // The last term keeps 0/0 out where both are zero.
    let fourth_power = available_k.powi(4) + (target_k.powi(4) + 1e-12);
    available_k * target_k / fourth_power.sqrt().sqrt()
}

/// Heat flows and temperatures along one exchanger in counterflow, hot end of the refrigerant first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CondenserStreams {
    /// Coolant inlet [K].
    pub coolant_inlet_k: f64,
    /// Coolant capacity rate [W/K].
    pub capacity_rate_w_k: f64,
    /// Gas inlet temperature [K].
    pub discharge_k: f64,
    /// Condensing temperature [K].
    pub condensing_k: f64,
    /// Subcooling [K].
    pub subcooling_k: f64,
    /// Heat released above the dew point [W].
    pub desuperheating_w: f64,
    /// Heat released between dew and bubble point [W].
    pub condensation_w: f64,
    /// Heat released below the bubble point [W].
    pub subcooling_w: f64,
}

impl CondenserStreams {
    /// Refrigerant minus coolant temperature at gas inlet, dew point, bubble point and liquid outlet [K].
    #[must_use]
    pub fn margins_k(&self) -> [f64; 4] {
        let at_bubble = self.coolant_inlet_k + self.subcooling_w / self.capacity_rate_w_k;
        let at_dew = at_bubble + self.condensation_w / self.capacity_rate_w_k;
        let outlet = at_dew + self.desuperheating_w / self.capacity_rate_w_k;
        [
            self.discharge_k - outlet,
            self.condensing_k - at_dew,
            self.condensing_k - at_bubble,
            self.condensing_k - self.subcooling_k - self.coolant_inlet_k,
        ]
    }
}

/// Heat flows and temperatures along the evaporator in counterflow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EvaporatorStreams {
    /// Coolant inlet [K].
    pub coolant_inlet_k: f64,
    /// Coolant capacity rate [W/K].
    pub capacity_rate_w_k: f64,
    /// Evaporating temperature [K].
    pub evaporating_k: f64,
    /// Superheat [K].
    pub superheat_k: f64,
    /// Heat taken up to the dew point [W].
    pub evaporation_w: f64,
    /// Heat taken up above the dew point [W].
    pub superheating_w: f64,
}

impl EvaporatorStreams {
    /// Coolant minus refrigerant temperature at gas outlet, dew point and refrigerant inlet [K].
    #[must_use]
    pub fn margins_k(&self) -> [f64; 3] {
        let at_dew = self.coolant_inlet_k - self.superheating_w / self.capacity_rate_w_k;
        let outlet = at_dew - self.evaporation_w / self.capacity_rate_w_k;
        [
            self.coolant_inlet_k - self.evaporating_k - self.superheat_k,
            at_dew - self.evaporating_k,
            outlet - self.evaporating_k,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subcooling_never_exceeds_target_or_room() {
        for room in [0.0, 1e-9, 0.3, 4.9, 5.0, 5.1, 60.0] {
            let actual: f64 = approach_limited_k(5.0, room);
            assert!(actual >= 0.0 && actual <= room && actual < 5.0, "{room} {actual}");
        }
        assert!(approach_limited_k(5.0, 20.0) > 4.99);
        assert_eq!(approach_limited_k(0.0, 0.0), 0.0);
    }
}
