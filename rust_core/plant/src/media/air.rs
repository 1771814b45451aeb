//! Dry air at ambient pressure.

use crate::config::ZERO_CELSIUS_K;

/// Ambient pressure [Pa].
pub const AMBIENT_PRESSURE_PA: f64 = 101_325.0;

/// Specific heat of air [J/(kg K)] (Bergman et al., Fundamentals of Heat and Mass Transfer, table A.4).
pub const SPECIFIC_HEAT_J_KG_K: f64 = 1006.0;

/// Properties that convection needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AirProperties {
    /// Density [kg/m3].
    pub density_kg_m3: f64,
    /// Dynamic viscosity [Pa s].
    pub viscosity_pa_s: f64,
    /// Thermal conductivity [W/(m K)].
    pub conductivity_w_m_k: f64,
    /// Prandtl number, equation (3) [-].
    pub prandtl: f64,
}

/// Air at a temperature [K]: ideal gas, power-law viscosity, linear conductivity (fits to the same table A.4).
#[must_use]
pub fn at_temperature(temperature_k: f64) -> AirProperties {
    let density_kg_m3 = AMBIENT_PRESSURE_PA / (287.05 * temperature_k);
    let viscosity_pa_s = 1.716e-5 * (temperature_k / ZERO_CELSIUS_K).powf(0.7);
    let conductivity_w_m_k = 0.0241 + 7e-5 * (temperature_k - ZERO_CELSIUS_K);
    let prandtl = SPECIFIC_HEAT_J_KG_K * viscosity_pa_s / conductivity_w_m_k;
    AirProperties { density_kg_m3, viscosity_pa_s, conductivity_w_m_k, prandtl }
}
