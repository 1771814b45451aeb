//! Cabin: ventilation, panels and cores (paper section 2.2).

use super::heat_exchanger::counterflow_conductance_w_k;
use crate::config::cabin::CabinParameters;
use crate::media::air::SPECIFIC_HEAT_J_KG_K;

/// Air flows of a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ventilation {
    /// Capacity rate of all blown air [W/K].
    pub supply_rate_w_k: f64,
    /// Capacity rate of its fresh part, equal to the exhaust [W/K].
    pub fresh_rate_w_k: f64,
    /// Recirculated share [-].
    pub recirculation: f64,
    /// Electrical power of the blower; all of it warms the supply air [W].
    pub blower_power_w: f64,
}

impl CabinParameters {
    /// Air flows at a blower level (0: smallest flow, 1: largest) and a recirculated share.
    ///
    /// Fan law: power rises with the cube of the flow.
    #[must_use]
    pub fn ventilation(&self, blower_level: f64, recirculation: f64) -> Ventilation {
        let flow_kg_s = self.minimum_air_flow_kg_s
            + blower_level * (self.maximum_air_flow_kg_s - self.minimum_air_flow_kg_s);
        let supply_rate_w_k = flow_kg_s * SPECIFIC_HEAT_J_KG_K;
        Ventilation {
            supply_rate_w_k,
            fresh_rate_w_k: supply_rate_w_k * (1.0 - recirculation),
            recirculation,
            blower_power_w: self.maximum_blower_power_w * (flow_kg_s / self.maximum_air_flow_kg_s).powi(3),
        }
    }

    /// Panel conductance to ambient [W/K].
    #[must_use]
    pub fn panel_conductance_w_k(&self, speed_m_s: f64) -> f64 {
        self.panel_conductance_w_k + self.panel_conductance_per_speed_w_s_k_m * speed_m_s
    }

    /// Largest conductance of the heater core between coolant and air inlet [W/K].
    #[must_use]
    pub fn heater_core_conductance_w_k(&self, coolant_rate_w_k: f64, ventilation: &Ventilation) -> f64 {
        counterflow_conductance_w_k(coolant_rate_w_k, ventilation.supply_rate_w_k, self.heater_core_ua_w_k)
    }

    /// Largest conductance of the cooling core between air inlet and coolant [W/K].
    #[must_use]
    pub fn cooling_core_conductance_w_k(&self, coolant_rate_w_k: f64, ventilation: &Ventilation) -> f64 {
        counterflow_conductance_w_k(coolant_rate_w_k, ventilation.supply_rate_w_k, self.cooling_core_ua_w_k)
    }
}
