//! Tables of a cell: open-circuit voltage, equivalent circuit, usable capacity.

use crate::config::{Validate, Violation, check_range};
use serde::{Deserialize, Serialize};

/// OCV(SOC) of one cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct OpenCircuitVoltageTable {
    /// State of charge, rising from 0 to 1.
    pub state_of_charge: Vec<f64>,
    /// Open-circuit voltage at each [V].
    pub voltage_v: Vec<f64>,
}

/// R0, R1 and C1 of one cell, one row a temperature, one column a state of charge.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Default)]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct UsableCapacityTable {
    /// Temperatures, rising [degC].
    pub temperature_degc: Vec<f64>,
    /// Usable share of the capacity at each [-].
    pub share: Vec<f64>,
}

pub(super) fn check_axis(key: &str, axis: &[f64], low: f64, high: f64) -> Result<(), Violation> {
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

/// Checks a table of so many rows and columns whose values have a range.
pub(super) fn check_rows(
    key: &str,
    table: &[Vec<f64>],
    (rows, columns): (usize, usize),
    (low, high): (f64, f64),
) -> Result<(), Violation> {
    if table.len() != rows {
        return Err(Violation::new(
            key,
            format!("{} rows", table.len()),
            format!("must hold {rows} rows, one for each temperature"),
        ));
    }
    for (i, row) in table.iter().enumerate() {
        check_values(&format!("{key}[{i}]"), row, columns, low, high)?;
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
            check_rows(key, table, (self.temperature_degc.len(), self.state_of_charge.len()), (low, high))?;
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
