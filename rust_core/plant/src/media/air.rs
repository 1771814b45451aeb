//! Dry air at ambient pressure.

use crate::config::ZERO_CELSIUS_K;

/// Ambient pressure [Pa].
pub const AMBIENT_PRESSURE_PA: f64 = 101_325.0;

/// Specific heat of air [J/(kg K)] (Bergman et al., Fundamentals of Heat and Mass Transfer, table A.4).
pub const SPECIFIC_HEAT_J_KG_K: f64 = 1006.0;

/// Air at a temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AirProperties {
    /// Temperature [K].
    pub temperature_k: f64,
    /// Density [kg/m3].
    pub density_kg_m3: f64,
    /// Density over dynamic viscosity: Reynolds number per metre and metre a second [s/m2].
    pub per_kinematic_viscosity_s_m2: f64,
    /// Thermal conductivity [W/(m K)].
    pub conductivity_w_m_k: f64,
    /// Cube root of the Prandtl number of equation (3) [-].
    pub prandtl_cube_root: f64,
}

/// Air at a temperature [K]: ideal gas, power-law viscosity, linear conductivity (fits to the same table A.4).
///
/// Powers and roots: a trip's air is worked out once.
#[must_use]
pub fn at_temperature(temperature_k: f64) -> AirProperties {
    let density_kg_m3 = AMBIENT_PRESSURE_PA / (287.05 * temperature_k);
    let viscosity_pa_s = 1.716e-5 * (temperature_k / ZERO_CELSIUS_K).powf(0.7);
    let conductivity_w_m_k = 0.0241 + 7e-5 * (temperature_k - ZERO_CELSIUS_K);
    let prandtl = SPECIFIC_HEAT_J_KG_K * viscosity_pa_s / conductivity_w_m_k;
    AirProperties {
        temperature_k,
        density_kg_m3,
        per_kinematic_viscosity_s_m2: density_kg_m3 / viscosity_pa_s,
        conductivity_w_m_k,
        prandtl_cube_root: prandtl.cbrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bergman et al., table A.4.
    #[test]
    fn properties_are_those_of_the_published_table() {
        for (temperature_k, density, kinematic, conductivity, prandtl) in
            [(250.0, 1.3947, 11.44e-6, 22.3e-3, 0.720), (300.0, 1.1614, 15.89e-6, 26.3e-3, 0.707)]
        {
            let air = at_temperature(temperature_k);
            for (found, published, tolerance) in [
                (air.density_kg_m3, density, 0.02),
                (air.per_kinematic_viscosity_s_m2.recip(), kinematic, 0.02),
                (air.conductivity_w_m_k, conductivity, 0.03),
                (air.prandtl_cube_root.powi(3), prandtl, 0.03),
            ] {
                assert!(
                    (found / published - 1.0).abs() < tolerance,
                    "{found} {published} at {temperature_k} K"
                );
            }
        }
    }
}
