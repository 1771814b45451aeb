//! State of a vehicle at the start.

use super::{Celsius, Validate, Violation, check_range};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;

/// What a key that gives a member's temperature ends with.
const TEMPERATURE_ENDING: &str = "_temperature_degc";

/// Temperatures that a member may start with [degC].
pub const MEMBER_RANGE_DEGC: (f64, f64) = (-50.0, 100.0);

/// Name of the windscreen of the cabin that counts for comfort, which has no node of its own.
pub const WINDSCREEN: &str = "windscreen";

/// State at the start; what is not given has the soak temperature.
///
/// In a file the temperature of each mass has a key of its own, the name of its trajectory column: `battery_temperature_degc`,
/// `soft_furnishings_temperature_degc`. That of a cabin counts for all in it that has none of its own, that of a loop for its
/// supply and return likewise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InitialParameters {
    /// Temperature of everything after the soak [degC].
    pub soak_temperature_degc: Celsius,
    /// State of charge [%].
    pub state_of_charge_pct: f64,
    /// Temperatures of masses by name [degC].
    members: BTreeMap<String, Celsius>,
}

impl InitialParameters {
    /// Everything at the soak temperature.
    #[must_use]
    pub fn soaked(soak_temperature_degc: Celsius, state_of_charge_pct: f64) -> Self {
        Self { soak_temperature_degc, state_of_charge_pct, members: BTreeMap::new() }
    }

    /// Temperature of a mass, where it is given.
    #[must_use]
    pub fn of(&self, member: &str) -> Option<Celsius> {
        self.members.get(member).copied()
    }

    /// Gives a mass a temperature of its own, or the soak temperature.
    pub fn set(&mut self, member: &str, temperature: Option<Celsius>) {
        match temperature {
            Some(value) => self.members.insert(member.to_owned(), value),
            None => self.members.remove(member),
        };
    }

    /// Masses with a temperature of their own.
    pub fn members(&self) -> impl Iterator<Item = &str> {
        self.members.keys().map(String::as_str)
    }
}

/// As bytes of a snapshot hold it.
#[derive(Deserialize)]
struct Plain {
    soak_temperature_degc: Celsius,
    state_of_charge_pct: f64,
    members: BTreeMap<String, Celsius>,
}

/// As a file gives it.
#[derive(Deserialize)]
struct InFile {
    soak_temperature_degc: Celsius,
    state_of_charge_pct: f64,
    #[serde(flatten)]
    others: BTreeMap<String, Celsius>,
}

impl<'de> Deserialize<'de> for InitialParameters {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if !deserializer.is_human_readable() {
            let Plain { soak_temperature_degc, state_of_charge_pct, members } =
                Plain::deserialize(deserializer)?;
            return Ok(Self { soak_temperature_degc, state_of_charge_pct, members });
        }
        let file = InFile::deserialize(deserializer)?;
        let mut members = BTreeMap::new();
        for (key, value) in file.others {
            let member = key.strip_suffix(TEMPERATURE_ENDING).ok_or_else(|| {
                let known =
                    format!("soak_temperature_degc, state_of_charge_pct and <mass>{TEMPERATURE_ENDING}");
                D::Error::custom(format!("unknown field `{key}`, expected one of {known}"))
            })?;
            members.insert(member.to_owned(), value);
        }
        Ok(Self {
            soak_temperature_degc: file.soak_temperature_degc,
            state_of_charge_pct: file.state_of_charge_pct,
            members,
        })
    }
}

impl Validate for InitialParameters {
    fn validate(&self) -> Result<(), Violation> {
        check_range("soak_temperature_degc", self.soak_temperature_degc, -50.0, 70.0)?;
        check_range("state_of_charge_pct", self.state_of_charge_pct, 0.0, 100.0)?;
        for (member, &value) in &self.members {
            check_range(
                &format!("{member}{TEMPERATURE_ENDING}"),
                value,
                MEMBER_RANGE_DEGC.0,
                MEMBER_RANGE_DEGC.1,
            )?;
        }
        Ok(())
    }
}
