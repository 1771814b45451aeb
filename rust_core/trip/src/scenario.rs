//! A scenario: vehicle, cycle, climate, strategy, heat demands.

use crate::heat_demand_commander::{ConnectionChange, HeatDemandParameters, check_order};
use crate::kinds::{SCENARIO, SERIES};
use crate::settings::SettingsParameters;
use crate::strategy::Strategy;
use crate::trace::Trace;
use crate::trace::columns::Quantity;
use crate::weather;
use hp_plant::architecture::flaw::among;
use hp_plant::architecture::layout::Layout;
use hp_plant::config::initial::InitialParameters;
use hp_plant::config::library::{self, Override};
use hp_plant::config::vehicle::{built_in_masses, built_in_members, masses};
use hp_plant::config::{Celsius, Validate, Violation, deserialized};
use hp_plant::error::PlantResult;
use hp_plant::media::air::{self, AirProperties};
use hp_plant::media::moist_air;
use hp_plant::parameters;
use serde::Deserialize;
use std::sync::Arc;
use toml::{Table, Value};

/// Everything that defines a run except the numbers of vehicle and controller.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenarioParameters {
    /// What this scenario is, in a sentence.
    pub description: String,
    /// Name or path of the vehicle.
    pub vehicle: String,
    /// Name or path of the drive cycle.
    pub cycle: String,
    /// Name or path of the controller.
    pub controller: String,
    /// Climate.
    pub climate: ClimateParameters,
    /// Climate over time, where the table `[climate]` has a `series`.
    #[serde(skip)]
    pub climate_series: Option<Arc<Trace>>,
    /// What the driver has set, instead of the controller.
    #[serde(default)]
    pub settings: SettingsParameters,
    /// State at the start.
    pub initial: InitialParameters,
    /// What the controller may use.
    pub strategy: Strategy,
    /// Heat flows that the heatDemandCommander asks for.
    pub heat_demand: HeatDemandParameters,
    /// Connections that follow a schedule instead of the controller.
    #[serde(default)]
    pub connection_schedule: Vec<ConnectionChange>,
}

parameters! {
    /// Climate: what holds where no series gives anything else. What a series of ambient temperature or humidity begins with stands
    /// here too.
    pub struct ClimateParameters {
        /// Ambient temperature [degC].
        ambient_temperature_degc: Celsius = -50.0 .. 60.0,
        /// Relative humidity of ambient air [-], against ice below 0 degC (ours); dry air where the file does not say.
        #[serde(default)]
        relative_humidity: f64 = 0.0 .. 1.0,
        /// Solar heat that reaches the cabin [W] (ours; 0 in the paper).
        solar_gain_w: f64 = 0.0 .. 3000.0,
        /// Number of people (ours; the driver in the paper).
        occupants: u32 = 0 .. 9,
    }
}

impl ClimateParameters {
    /// Ambient air.
    #[must_use]
    pub fn air(&self) -> AirProperties {
        air::at_temperature(self.ambient_temperature_degc.kelvin())
    }

    /// Water in a kilogram of dry ambient air [kg/kg].
    #[must_use]
    pub fn humidity_ratio(&self) -> f64 {
        moist_air::humidity_ratio(self.relative_humidity, self.ambient_temperature_degc.kelvin())
    }
}

impl ScenarioParameters {
    /// Loads a scenario by name or path with overrides; one that gives no soak temperature starts soaked at its ambient, with that
    /// which its series begins with where it has one.
    ///
    /// # Errors
    /// Anything wrong in its file, its bases or an override.
    pub fn load(name: &str, overrides: &[Override]) -> PlantResult<Self> {
        let mut table = library::table(SCENARIO, name, overrides)?;
        let climate_series = take_climate_series(name, &mut table)?;
        let ambient =
            table.get("climate").and_then(|climate| climate.get("ambient_temperature_degc")).cloned();
        if let (Some(ambient), Some(Value::Table(initial))) = (ambient, table.get_mut("initial")) {
            initial.entry("soak_temperature_degc").or_insert(ambient);
        }
        let scenario: Self = library::read(name, table)?;
        let settings = scenario.settings.loaded().map_err(|error| error.named_by(name))?;
        Ok(Self { climate_series, settings, ..scenario })
    }

    /// Checks that the members it names are those of a vehicle, or of a built-in architecture: scenarios are driven with cars
    /// that lack some of them.
    ///
    /// # Errors
    /// The first name that is neither.
    pub fn check_members(&self, layout: &Layout) -> Result<(), Violation> {
        let strategy = self.strategy.members.keys().map(|member| ("strategy", member.as_str()));
        let requests = self.heat_demand.constants_w.keys().map(|member| ("heat_demand", member.as_str()));
        strategy.chain(requests).try_for_each(|(key, member)| known_member(layout, key, member))?;
        self.initial.members().try_for_each(|mass| known(mass, "initial", &masses(layout), built_in_masses()))
    }
}

/// Takes the series of the climate out of a scenario's table and enters what it begins with.
fn take_climate_series(file: &str, table: &mut Table) -> PlantResult<Option<Arc<Trace>>> {
    let Some(Value::Table(climate)) = table.get_mut("climate") else { return Ok(None) };
    let Some(path) = climate.remove("series") else { return Ok(None) };
    let path: String = deserialized(file, "climate.series", path)?;
    let series = Trace::load(SERIES, &path).and_then(|series| {
        series.check_has_any(weather::QUANTITIES)?;
        Ok(series)
    });
    let series = series.map_err(|error| error.named_by(file))?;
    if let Some(ambient_degc) = series.values(Quantity::Ambient) {
        climate.insert("ambient_temperature_degc".into(), ambient_degc[0].into());
    }
    if let Some(humidity_pct) = series.values(Quantity::Humidity) {
        climate.insert("relative_humidity".into(), (humidity_pct[0] / 100.0).into());
    }
    Ok(Some(Arc::new(series)))
}

/// Checks that a member is one of a vehicle or of a built-in architecture.
///
/// # Errors
/// It is neither.
pub fn known_member(layout: &Layout, key: &str, member: &str) -> Result<(), Violation> {
    let names: Vec<&str> = layout.members.iter().map(|member| member.name.as_str()).collect();
    known(member, key, &names, built_in_members())
}

/// Checks that a name is one of a vehicle's or a built-in one.
fn known(name: &str, key: &str, own: &[&str], built_in: &[String]) -> Result<(), Violation> {
    if own.contains(&name) || built_in.iter().any(|other| other == name) {
        return Ok(());
    }
    Err(Violation::new(key, format!("for `{name}`"), among(own, name)))
}

impl Validate for ScenarioParameters {
    fn validate(&self) -> Result<(), Violation> {
        self.climate.validate().map_err(|violation| violation.within("climate"))?;
        self.settings.validate().map_err(|violation| violation.within("settings"))?;
        self.initial.validate().map_err(|violation| violation.within("initial"))?;
        self.heat_demand.validate().map_err(|violation| violation.within("heat_demand"))?;
        check_order("connection_schedule", self.connection_schedule.iter().map(|change| change.from_s))?;
        Ok(())
    }
}
