//! A thermostat: full power on one side of a cabin temperature, none on the other. Untuned, to compare others with.

use super::options::Options;
use super::rule_based::{CabinMode, Comfort, ConstantSettings, Presets, RuleBased, constant_settings_of};
use crate::roles::Roles;
use crate::settings::DriverSettings;
use crate::strategy::{ClimateControl, Strategy};
use hp_plant::architecture::layout::Layout;
use hp_plant::command::Demand;
use hp_plant::config::Celsius;
use hp_plant::parameters;
use hp_plant::plant::Plant;
use hp_plant::state::State;
use serde::{Deserialize, Serialize};

parameters! {
    /// Thermostat.
    pub struct ThermostatParameters {
        /// Cabin target [degC].
        cabin_set_point_degc: Celsius = 10.0 .. 30.0,
        /// The heat pump heats below the cabin target less this, and cools above the target plus this [K].
        half_band_k: f64 = 0.1 .. 5.0,
        /// The PTC may help while the cabin is below [degC].
        ptc_below_degc: Celsius = -40.0 .. 30.0,
        /// Compressor power while it is on [W].
        compressor_power_w: f64 = 100.0 .. 20000.0,
        /// Constant flow demand for the HTC [kg/s].
        htc_flow_kg_s: f64 = 0.001 .. 5.0,
        /// Constant flow demand for the chiller circuit [kg/s].
        chiller_flow_kg_s: f64 = 0.001 .. 5.0,
        /// Constant blower level [-].
        blower_level: f64 = 0.0 .. 1.0,
        /// Blower level while cooling [-].
        cooling_blower_level: f64 = 0.0 .. 1.0,
        /// Recirculated share while heating [-].
        heating_recirculation: f64 = 0.0 .. 0.95,
        /// Recirculated share while cooling [-].
        cooling_recirculation: f64 = 0.0 .. 0.95,
        ;
        /// What today's cars have beyond simple rules; nothing where the file has no such table. The battery is isolated anyway.
        #[serde(default)]
        options: Options,
    }
}

/// Thermostat with its parameters and what it may use.
#[derive(Debug, Clone, PartialEq)]
pub struct Thermostat {
    parameters: ThermostatParameters,
    strategy: Strategy,
    roles: Roles,
    presets: Presets,
    /// How far below the cabin target the PTC's controller aims [K].
    heater_offset_k: f64,
}

/// Memory of a thermostat.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ThermostatMemory {
    mode: CabinMode,
}

impl Thermostat {
    fn comfort(&self, state: &State, settings: &DriverSettings) -> Comfort {
        Comfort {
            cabin_k: state.temperatures_k[self.roles.cabin_air.index()],
            target_k: settings.target_k(self.parameters.cabin_set_point_degc),
        }
    }

    /// Heating or cooling; in automatic climate control the other one as soon as that would switch on.
    fn mode(&self, comfort: &Comfort, last: CabinMode) -> CabinMode {
        match (self.strategy.climate_control, last) {
            (ClimateControl::Heat, _) => CabinMode::Heating,
            (ClimateControl::Cool, _) => CabinMode::Cooling,
            (ClimateControl::Auto, CabinMode::Heating) if self.switches_on(comfort, CabinMode::Cooling) => {
                CabinMode::Cooling
            }
            (ClimateControl::Auto, CabinMode::Cooling) if self.switches_on(comfort, CabinMode::Heating) => {
                CabinMode::Heating
            }
            (ClimateControl::Auto, last) => last,
        }
    }

    fn switches_on(&self, comfort: &Comfort, mode: CabinMode) -> bool {
        comfort.lack_k(mode) > self.parameters.half_band_k
    }
}

constant_settings_of!(ThermostatParameters);

impl RuleBased for Thermostat {
    type Parameters = ThermostatParameters;
    type Memory = ThermostatMemory;

    fn new(parameters: ThermostatParameters, strategy: Strategy, layout: &Layout) -> Self {
        let roles = Roles::of(layout, &strategy);
        let heater_offset_k = parameters.options.heater_offset_k(roles.heat_pump(&strategy));
        let mut settings = ConstantSettings::from(&parameters);
        settings.cabin_set_point_degc.0 -= heater_offset_k;
        let presets = Presets::of(&roles, &settings);
        Self { roles, presets, parameters, strategy, heater_offset_k }
    }

    fn roles(&self) -> &Roles {
        &self.roles
    }

    fn constant_settings(&self) -> ConstantSettings {
        ConstantSettings::from(&self.parameters)
    }

    fn awake(&self, _: &Plant, state: &State, settings: &DriverSettings) -> ThermostatMemory {
        let warm = self.comfort(state, settings).lack_k(CabinMode::Cooling) > 0.0;
        ThermostatMemory { mode: if warm { CabinMode::Cooling } else { CabinMode::Heating } }
    }

    /// Cabin on what heats or cools it, sources on the heat pump while it heats, battery and stores isolated.
    fn demand(
        &self,
        _: &Plant,
        state: &State,
        settings: &DriverSettings,
        memory: &mut ThermostatMemory,
        demand: &mut Demand,
    ) {
        let comfort = self.comfort(state, settings);
        memory.mode = self.mode(&comfort, memory.mode);
        let mode = memory.mode;
        self.presets.enter(mode, demand);
        let parameters = &self.parameters;
        let level = parameters.options.blower_level(
            mode,
            self.constant_settings().blower_level(mode),
            comfort.lack_k(mode),
        );
        self.roles.blow(level, demand);
        parameters.options.mind_air(&self.roles, state, demand);
        settings.enter(self.heater_offset_k, &self.roles, demand);
        let cold = comfort.cabin_k < self.parameters.ptc_below_degc.kelvin();
        self.roles.allow_heaters(self.strategy.ptc && mode == CabinMode::Heating && cold, demand);
        if let Some(row) = self.roles.compressor_row {
            let on = self.strategy.heat_pump && self.switches_on(&comfort, mode);
            demand[row] = if on { self.parameters.compressor_power_w } else { 0.0 };
        }
        if mode == CabinMode::Cooling {
            self.roles.unlimit_rejection(demand);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::experiment::Experiment;
    use hp_plant::config::Celsius;
    use hp_plant::config::library::Override;

    /// What the thermostat asks for with the cabin at a temperature: options by name, power of the compressor.
    fn demand(scenario: &str, cabin_degc: f64) -> impl Fn(&str) -> f64 {
        let everything = ["motor", "transmission", "ambient", "ptc"].map(|source| {
            Override::parse(&format!("scenario.strategy.{source}=true")).expect("an assignment")
        });
        let experiment = Experiment::load(scenario, Some("thermostat"), &everything).expect("built in");
        let mut run = experiment.start();
        run.state.temperatures_k[experiment.plant.layout().cabins[0].air.index()] =
            Celsius(cabin_degc).kelvin();
        let demand = experiment.demand(&mut run);
        move |name: &str| demand[experiment.plant.ranges.row(name).expect("an actuator")]
    }

    const HTC: f64 = 1.0;
    const CHILLER: f64 = 2.0;

    #[test]
    fn heats_below_its_band_and_rests_within_it() {
        let cold = demand("jeffs2019/case1-4", 5.0);
        assert!(cold("compressor_power") > 0.0 && cold("ptc") == 1.0);
        assert_eq!((cold("cabin"), cold("battery")), (HTC, 0.0));
        // Their first loop is the chiller.
        for source in ["ambient", "motor", "transmission"] {
            assert_eq!(cold(source), 1.0, "{source}");
        }
        let cool = demand("jeffs2019/case1-4", 20.9);
        assert!(cool("compressor_power") > 0.0 && cool("ptc") == 0.0);
        assert_eq!(demand("jeffs2019/case1-4", 21.1)("compressor_power"), 0.0);
    }

    #[test]
    fn blows_as_much_as_the_cabin_needs_where_its_file_says_so() {
        let change = Override::parse(
            "controller.options={ptc_below_target_k=0.5, battery_after_cabin_band_k=0.0, \
             battery_from_supply_degc=80.0, battery_supply_band_k=5.0, heating_blower_band_k=10.0, \
             cooling_blower_band_k=5.0, least_blower_level=0.3}",
        );
        let level = Override::parse("controller.blower_level=1.0").expect("an assignment");
        let experiment = Experiment::load(
            "jeffs2019/case1-4",
            Some("thermostat"),
            &[change.expect("an assignment"), level],
        )
        .expect("built in");
        let ranges = &experiment.plant.ranges;
        let row = |name: &str| ranges.row(name).expect("an actuator");
        for (cabin_degc, level) in [(5.0, 1.0), (17.0, 0.65), (22.0, 0.3)] {
            let mut run = experiment.start();
            run.state.temperatures_k[experiment.plant.layout().cabins[0].air.index()] =
                Celsius(cabin_degc).kelvin();
            let demand = experiment.demand(&mut run);
            assert!((demand[row("blower_level")] - level).abs() < 1e-9, "{cabin_degc}");
            assert!((demand[row("cabin_set_point")] - Celsius(21.5).kelvin()).abs() < 1e-9);
        }
    }

    #[test]
    fn cools_above_its_band_through_the_front_end_exchanger() {
        let hot = demand("ours/hot-soak-plus35", 40.0);
        assert!(hot("compressor_power") > 0.0 && hot("ptc") == 0.0);
        assert_eq!((hot("cabin"), hot("ambient")), (CHILLER, 2.0));
        assert_eq!(demand("ours/hot-soak-plus35", 22.9)("compressor_power"), 0.0);
    }
}
