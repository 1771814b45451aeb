//! What the header of a refrigerant's table says of the fluid: its critical point and the usual limits of a machine with it.
//!
//! Lines that begin with `#:` are TOML; `configs/refrigerants/make_table.py` writes them.

use crate::config::bounded;
use crate::config::{Validate, Violation, check_range, deserialized};
use crate::error::{PlantError, PlantResult};
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

/// Critical temperature below which a heat pump with the fluid would be supercritical on its hot side [degC].
pub const LOWEST_CRITICAL_DEGC: f64 = 60.0;

/// What is written before a line that counts.
const MARK: &str = "#:";

/// Names of fluids that are known to be asked for and cannot condense in a heat pump, with their critical temperature [degC].
const SUPERCRITICAL: [(&str, f64); 5] =
    [("r744", 31.0), ("co2", 31.0), ("carbondioxide", 31.0), ("r170", 32.2), ("r41", 44.1)];

/// Critical point of a fluid, and the limits that a vehicle has with it unless its file gives its own.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FluidLimits {
    /// Critical temperature [degC].
    pub critical_temperature_degc: f64,
    /// Critical pressure [bar].
    pub critical_pressure_bar: f64,
    /// Highest condensing pressure of usual components [bar].
    pub maximum_pressure_bar: f64,
    /// Lowest suction pressure [bar].
    pub minimum_suction_pressure_bar: f64,
    /// Highest discharge gas temperature, by oil and fluid [degC].
    pub maximum_discharge_temperature_degc: f64,
}

impl Validate for FluidLimits {
    fn validate(&self) -> Result<(), Violation> {
        if self.critical_temperature_degc.is_nan() || self.critical_temperature_degc < LOWEST_CRITICAL_DEGC {
            let allowed = format!(
                "must be at least {LOWEST_CRITICAL_DEGC} degC: a heat pump with this fluid is supercritical on its hot side"
            );
            return Err(Violation::new("critical_temperature_degc", self.critical_temperature_degc, allowed));
        }
        check_range("critical_pressure_bar", self.critical_pressure_bar, 1.0, 250.0)?;
        check_range("maximum_pressure_bar", self.maximum_pressure_bar, 1.0, self.critical_pressure_bar)?;
        check_range(
            "minimum_suction_pressure_bar",
            self.minimum_suction_pressure_bar,
            0.0,
            self.maximum_pressure_bar,
        )?;
        check_range(
            "maximum_discharge_temperature_degc",
            self.maximum_discharge_temperature_degc,
            60.0,
            150.0,
        )
    }
}

impl FluidLimits {
    /// Reads them from the header of a table; `None` where it has none. `file` is what an error names.
    ///
    /// # Errors
    /// A line is no TOML, one of the keys is missing or unknown, or a value is not allowed.
    pub fn from_table(file: &str, text: &str) -> PlantResult<Option<Self>> {
        let lines: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix(MARK)).collect();
        if lines.is_empty() {
            return Ok(None);
        }
        let header = bounded::toml(&lines.join("\n")).map_err(|message| PlantError::Syntax {
            file: file.to_owned(),
            message: format!("lines with `{MARK}`: {message}"),
        })?;
        let limits: Self = deserialized(file, "", Value::Table(header))?;
        limits.validate().map_err(|violation| violation.in_file(file))?;
        Ok(Some(limits))
    }

    /// The limits as a vehicle's section `refrigeration` holds them.
    #[must_use]
    pub fn section(&self) -> Table {
        let value = |key: &str, value: f64| (key.to_owned(), Value::Float(value));
        let compressor = Table::from_iter([value(
            "maximum_discharge_temperature_degc",
            self.maximum_discharge_temperature_degc,
        )]);
        Table::from_iter([
            value("maximum_pressure_bar", self.maximum_pressure_bar),
            value("minimum_suction_pressure_bar", self.minimum_suction_pressure_bar),
            ("compressor".to_owned(), Value::Table(compressor)),
        ])
    }
}

/// Critical temperature of a fluid that cannot condense in a heat pump, by the names that are used for it [degC].
#[must_use]
pub fn supercritical_degc(name: &str) -> Option<f64> {
    let plain: String = name.chars().filter(char::is_ascii_alphanumeric).collect();
    SUPERCRITICAL.iter().find(|(known, _)| known.eq_ignore_ascii_case(&plain)).map(|(_, degc)| *degc)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "# a table\n#: critical_temperature_degc = 101.0\n#: critical_pressure_bar = 40.6\n\
        #: maximum_pressure_bar = 30.0\n#: minimum_suction_pressure_bar = 1.0\n\
        #: maximum_discharge_temperature_degc = 130.0\ntemperature_k,a\n1,2\n";

    #[test]
    fn marked_lines_of_the_header_are_the_limits() {
        let limits = FluidLimits::from_table("t", HEADER).expect("fine").expect("some");
        assert_eq!((limits.critical_temperature_degc, limits.maximum_pressure_bar), (101.0, 30.0));
        assert_eq!(FluidLimits::from_table("t", "temperature_k,a\n"), Ok(None));
    }

    #[test]
    fn impossible_limits_are_refused_with_key_value_and_rule() {
        for (old, new, parts) in [
            ("= 101.0", "= 31.0", ["critical_temperature_degc", "31", "supercritical"]),
            ("bar = 30.0", "bar = 45.0", ["maximum_pressure_bar", "45", "between 1 and 40.6"]),
            ("bar = 1.0", "bar = -1.0", ["minimum_suction_pressure_bar", "-1", "between 0 and 30"]),
            ("maximum_pressure_bar", "highest_bar", ["highest_bar", "unknown field", "maximum_pressure_bar"]),
            ("= 130.0", "130", ["#:", "line 5", "="]),
        ] {
            let text = HEADER.replace(old, new);
            let message = FluidLimits::from_table("my.csv", &text).expect_err("refused").to_string();
            assert!(
                message.starts_with("my.csv: ") && parts.iter().all(|part| message.contains(part)),
                "{message}"
            );
        }
    }

    #[test]
    fn carbon_dioxide_is_known_by_its_names() {
        for name in ["R744", "r-744", "CO2", "Carbon dioxide"] {
            assert_eq!(supercritical_degc(name), Some(31.0), "{name}");
        }
        assert_eq!(supercritical_degc("r290"), None);
    }
}
