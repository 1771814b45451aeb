//! Parameters of the battery.

use super::{Validate, Violation, check_range};
use crate::parameters;
use serde::{Deserialize, Serialize};

parameters! {
    /// Battery pack: equivalent circuit per string, lumped thermal mass, exterior plate.
    pub struct BatteryParameters {
        /// Cells in series in a string.
        cells_in_series: u32 = 1 .. 1000,
        /// Strings in parallel.
        strings_in_parallel: u32 = 1 .. 100,
        /// Capacity of one cell at 25 degC [Ah].
        cell_capacity_ah: f64 = 0.5 .. 500.0,
        /// Mass of one cell with its share of the module [kg].
        cell_mass_kg: f64 = 0.01 .. 10.0,
        /// Specific heat of the cell [J/(kg K)].
        cell_specific_heat_j_kg_k: f64 = 300.0 .. 3000.0,
        /// Factor on the resistance tables [-].
        resistance_scale: f64 = 0.1 .. 10.0,
        /// Lowest cell voltage under load [V].
        minimum_cell_voltage_v: f64 = 1.0 .. 3.6,
        /// Highest cell voltage when charged [V].
        maximum_cell_voltage_v: f64 = 3.0 .. 5.0,
        /// Coolant plate conductance [W/K].
        coolant_ua_w_k: f64 = 1.0 .. 10000.0,
        ;
        /// Charge-rate limit against temperature.
        charge_limit: RateLimitParameters,
        /// Discharge-rate limit against temperature.
        discharge_limit: RateLimitParameters,
        /// Exterior plate under the vehicle.
        plate: PlateParameters,
        /// Open-circuit voltage against state of charge.
        open_circuit_voltage: OpenCircuitVoltageTable,
        /// Resistances and capacitance against temperature and state of charge.
        circuit: CircuitTable,
        /// Share of the capacity that can be used against temperature, C_eff of equation (6).
        usable_capacity: UsableCapacityTable,
    }
}

parameters! {
    /// A C-rate limit that rises linearly with temperature between zero and a largest rate.
    pub struct RateLimitParameters {
        /// Rate at 0 degC [1/h]; may be negative, the limit itself never is.
        rate_at_zero_degc_per_h: f64 = -20.0 .. 100.0,
        /// Rise with temperature [1/h per K].
        rate_rise_per_h_k: f64 = 0.0 .. 10.0,
        /// Largest rate [1/h].
        maximum_rate_per_h: f64 = 0.0 .. 100.0,
    }
}

parameters! {
    /// Plate between pack and underbody air, equations (1) to (5).
    pub struct PlateParameters {
        /// Length along the flow [m].
        length_m: f64 = 0.1 .. 20.0,
        /// Width [m].
        width_m: f64 = 0.1 .. 4.0,
        /// Conductance between pack and plate [W/K].
        pack_conductance_w_k: f64 = 0.01 .. 1000.0,
        /// Natural-convection conductance of the plate at standstill [W/K].
        natural_convection_w_k: f64 = 0.0 .. 100.0,
    }
}

/// OCV(SOC) of one cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OpenCircuitVoltageTable {
    /// State of charge, rising from 0 to 1.
    pub state_of_charge: Vec<f64>,
    /// Open-circuit voltage at each [V].
    pub voltage_v: Vec<f64>,
}

/// R0, R1 and C1 of one cell, one row a temperature, one column a state of charge.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CircuitTable {
    /// Temperatures of the rows, rising [degC].
    pub temperature_degc: Vec<f64>,
    /// States of charge of the columns, rising [-].
    pub state_of_charge: Vec<f64>,
    /// Ohmic resistance [ohm].
    pub series_resistance_ohm: Vec<Vec<f64>>,
    /// Polarisation resistance [ohm].
    pub polarisation_resistance_ohm: Vec<Vec<f64>>,
    /// Polarisation capacitance [F].
    pub polarisation_capacitance_f: Vec<Vec<f64>>,
}

/// C_eff(T).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct UsableCapacityTable {
    /// Temperatures, rising [degC].
    pub temperature_degc: Vec<f64>,
    /// Usable share of the capacity at each [-].
    pub share: Vec<f64>,
}

fn check_axis(key: &str, axis: &[f64], low: f64, high: f64) -> Result<(), Violation> {
    if axis.len() < 2 {
        return Err(Violation::new(key, format!("{} values", axis.len()), "must hold at least 2 values"));
    }
    for (i, &value) in axis.iter().enumerate() {
        check_range(&format!("{key}[{i}]"), value, low, high)?;
    }
    match axis.windows(2).position(|pair| pair[1] <= pair[0]) {
        Some(i) => Err(Violation::new(
            format!("{key}[{}]", i + 1),
            axis[i + 1],
            "must be larger than the value before it",
        )),
        None => Ok(()),
    }
}

fn check_values(key: &str, values: &[f64], length: usize, low: f64, high: f64) -> Result<(), Violation> {
    if values.len() != length {
        return Err(Violation::new(
            key,
            format!("{} values", values.len()),
            format!("must hold {length} values, one for each point of its axis"),
        ));
    }
    for (i, &value) in values.iter().enumerate() {
        check_range(&format!("{key}[{i}]"), value, low, high)?;
    }
    Ok(())
}

impl Validate for OpenCircuitVoltageTable {
    fn validate(&self) -> Result<(), Violation> {
        check_axis("state_of_charge", &self.state_of_charge, 0.0, 1.0)?;
        if self.state_of_charge[0] != 0.0 || self.state_of_charge[self.state_of_charge.len() - 1] != 1.0 {
            return Err(Violation::new(
                "state_of_charge",
                format!("{:?}", self.state_of_charge),
                "must run from 0 to 1",
            ));
        }
        check_values("voltage_v", &self.voltage_v, self.state_of_charge.len(), 1.0, 5.0)?;
        check_axis("voltage_v", &self.voltage_v, 1.0, 5.0)
    }
}

impl Validate for CircuitTable {
    fn validate(&self) -> Result<(), Violation> {
        check_axis("temperature_degc", &self.temperature_degc, -100.0, 150.0)?;
        check_axis("state_of_charge", &self.state_of_charge, 0.0, 1.0)?;
        let tables = [
            ("series_resistance_ohm", &self.series_resistance_ohm, 1e-6, 10.0),
            ("polarisation_resistance_ohm", &self.polarisation_resistance_ohm, 1e-6, 10.0),
            ("polarisation_capacitance_f", &self.polarisation_capacitance_f, 1.0, 1e8),
        ];
        for (key, table, low, high) in tables {
            if table.len() != self.temperature_degc.len() {
                return Err(Violation::new(
                    key,
                    format!("{} rows", table.len()),
                    format!("must hold {} rows, one for each temperature", self.temperature_degc.len()),
                ));
            }
            for (i, row) in table.iter().enumerate() {
                check_values(&format!("{key}[{i}]"), row, self.state_of_charge.len(), low, high)?;
            }
        }
        Ok(())
    }
}

impl Validate for UsableCapacityTable {
    fn validate(&self) -> Result<(), Violation> {
        check_axis("temperature_degc", &self.temperature_degc, -100.0, 150.0)?;
        check_values("share", &self.share, self.temperature_degc.len(), 0.05, 1.2)
    }
}
