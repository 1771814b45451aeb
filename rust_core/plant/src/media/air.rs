//! Dry air at ambient pressure.

use crate::config::ZERO_CELSIUS_K;
use crate::numerics::cubic_table::CubicTable;

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
    /// Cube root of the Prandtl number of equation (3) [-].
    pub prandtl_cube_root: f64,
}

/// Air at a temperature [K]: ideal gas, power-law viscosity, linear conductivity (fits to the same table A.4).
#[must_use]
pub fn at_temperature(temperature_k: f64) -> AirProperties {
    let density_kg_m3 = density_kg_m3(temperature_k);
    let viscosity_pa_s = 1.716e-5 * (temperature_k / ZERO_CELSIUS_K).powf(0.7);
    let conductivity_w_m_k = conductivity_w_m_k(temperature_k);
    let prandtl = SPECIFIC_HEAT_J_KG_K * viscosity_pa_s / conductivity_w_m_k;
    AirProperties { density_kg_m3, viscosity_pa_s, conductivity_w_m_k, prandtl_cube_root: prandtl.cbrt() }
}

/// Temperatures that the table covers [K].
const TABLE_RANGE_K: (f64, f64) = (180.0, 360.0);
const TABLE_STEP_K: f64 = 2.0;

/// [`at_temperature`] with its powers and roots interpolated, to 1e-9 of their value.
#[derive(Debug, Clone, PartialEq)]
pub struct AirTable(Option<CubicTable<2>>);

impl Default for AirTable {
    fn default() -> Self {
        let (first, last) = TABLE_RANGE_K;
        let grid: Vec<f64> = (0..=((last - first) / TABLE_STEP_K) as u32)
            .map(|k| first + TABLE_STEP_K * f64::from(k))
            .collect();
        let exact = |&temperature_k: &f64| {
            let air = at_temperature(temperature_k);
            [air.viscosity_pa_s, air.prandtl_cube_root]
        };
        let rows: Vec<[f64; 2]> = grid.iter().map(exact).collect();
        Self(CubicTable::new(&grid, &rows).ok())
    }
}

impl AirTable {
    /// Air at a temperature [K].
    #[must_use]
    #[inline]
    pub fn at_temperature(&self, temperature_k: f64) -> AirProperties {
        let (first, last) = TABLE_RANGE_K;
        let Some(table) = self.0.as_ref().filter(|_| (first..=last).contains(&temperature_k)) else {
            return at_temperature(temperature_k);
        };
        let [viscosity_pa_s, prandtl_cube_root] = table.evaluate::<_, 0, 2>(temperature_k);
        AirProperties {
            density_kg_m3: density_kg_m3(temperature_k),
            viscosity_pa_s,
            conductivity_w_m_k: conductivity_w_m_k(temperature_k),
            prandtl_cube_root,
        }
    }
}

fn density_kg_m3(temperature_k: f64) -> f64 {
    AMBIENT_PRESSURE_PA / (287.05 * temperature_k)
}

fn conductivity_w_m_k(temperature_k: f64) -> f64 {
    0.0241 + 7e-5 * (temperature_k - ZERO_CELSIUS_K)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn table_and_formula_agree_within_and_beyond_its_range(temperature_k in 150.0..400.0_f64) {
            let (table, formula) = (AirTable::default().at_temperature(temperature_k), at_temperature(temperature_k));
            for (a, b) in [
                (table.density_kg_m3, formula.density_kg_m3),
                (table.viscosity_pa_s, formula.viscosity_pa_s),
                (table.conductivity_w_m_k, formula.conductivity_w_m_k),
                (table.prandtl_cube_root, formula.prandtl_cube_root),
            ] {
                prop_assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
            }
        }
    }
}
