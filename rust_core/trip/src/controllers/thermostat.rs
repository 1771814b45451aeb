//! A thermostat: full power on one side of a cabin temperature, none on the other. Untuned, to compare others with.

use super::rule_based::{CabinMode, ConstantSettings, RuleBased};
use crate::strategy::{ClimateControl, Strategy};
use hp_plant::circuits::assembly::NODES;
use hp_plant::command::{Connection, Demand, MAXIMUM_REQUEST_W, Member};
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
        /// Recirculated share while heating [-].
        heating_recirculation: f64 = 0.0 .. 0.95,
        /// Recirculated share while cooling [-].
        cooling_recirculation: f64 = 0.0 .. 0.95,
    }
}

/// Thermostat with its parameters and what it may use.
#[derive(Debug, Clone, PartialEq)]
pub struct Thermostat {
    parameters: ThermostatParameters,
    strategy: Strategy,
}

/// Memory of a thermostat.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ThermostatMemory {
    mode: CabinMode,
}

impl Thermostat {
    /// How far the cabin is beyond the target, counted in the direction that a mode works against [K].
    fn lack_k(&self, state: &State, mode: CabinMode) -> f64 {
        let below_k =
            self.parameters.cabin_set_point_degc.kelvin() - state.temperatures_k[NODES.cabin.index()];
        match mode {
            CabinMode::Heating => below_k,
            CabinMode::Cooling => -below_k,
        }
    }

    /// Heating or cooling; in automatic climate control the other one as soon as that would switch on.
    fn mode(&self, state: &State, last: CabinMode) -> CabinMode {
        match (self.strategy.climate_control, last) {
            (ClimateControl::Heat, _) => CabinMode::Heating,
            (ClimateControl::Cool, _) => CabinMode::Cooling,
            (ClimateControl::Auto, CabinMode::Heating) if self.switches_on(state, CabinMode::Cooling) => {
                CabinMode::Cooling
            }
            (ClimateControl::Auto, CabinMode::Cooling) if self.switches_on(state, CabinMode::Heating) => {
                CabinMode::Heating
            }
            (ClimateControl::Auto, last) => last,
        }
    }

    fn switches_on(&self, state: &State, mode: CabinMode) -> bool {
        self.lack_k(state, mode) > self.parameters.half_band_k
    }

    /// Cabin on the loop that serves it, sources on the chiller loop, battery and thermal battery isolated.
    fn connections(&self, mode: CabinMode) -> [Connection; 6] {
        let source = |allowed: bool| {
            if allowed && mode == CabinMode::Heating { Connection::Chiller } else { Connection::Isolated }
        };
        let (cabin, ambient) = match mode {
            CabinMode::Heating => (Connection::Htc, source(self.strategy.ambient)),
            // Air conditioning rejects its heat through the front-end exchanger.
            CabinMode::Cooling => (Connection::Chiller, Connection::Htc),
        };
        let mut connections = [Connection::Isolated; 6];
        for (member, connection) in [
            (Member::Motor, source(self.strategy.motor)),
            (Member::Transmission, source(self.strategy.transmission)),
            (Member::Ambient, ambient),
            (Member::Cabin, cabin),
        ] {
            connections[member as usize] = connection;
        }
        connections
    }
}

impl RuleBased for Thermostat {
    type Parameters = ThermostatParameters;
    type Memory = ThermostatMemory;

    fn new(parameters: ThermostatParameters, strategy: Strategy) -> Self {
        Self { parameters, strategy }
    }

    fn constant_settings(&self) -> ConstantSettings {
        let parameters = &self.parameters;
        ConstantSettings {
            cabin_set_point_degc: parameters.cabin_set_point_degc,
            htc_flow_kg_s: parameters.htc_flow_kg_s,
            chiller_flow_kg_s: parameters.chiller_flow_kg_s,
            blower_level: parameters.blower_level,
            heating_recirculation: parameters.heating_recirculation,
            cooling_recirculation: parameters.cooling_recirculation,
        }
    }

    fn awake(&self, _: &Plant, state: &State) -> ThermostatMemory {
        let warm = self.lack_k(state, CabinMode::Cooling) > 0.0;
        ThermostatMemory { mode: if warm { CabinMode::Cooling } else { CabinMode::Heating } }
    }

    fn demand(
        &self,
        _: &Plant,
        state: &State,
        memory: &mut ThermostatMemory,
        requests_w: &[f64; 6],
    ) -> Demand {
        memory.mode = self.mode(state, memory.mode);
        let mode = memory.mode;
        let cabin_k = state.temperatures_k[NODES.cabin.index()];
        let on = self.strategy.heat_pump && self.switches_on(state, mode);
        let mut demand = Demand {
            connections: self.connections(mode),
            ptc_allowed: self.strategy.ptc
                && mode == CabinMode::Heating
                && cabin_k < self.parameters.ptc_below_degc.kelvin(),
            compressor_power_w: if on { self.parameters.compressor_power_w } else { 0.0 },
            ..self.constant_settings().demand(mode, requests_w)
        };
        if mode == CabinMode::Cooling {
            demand.requests_w[Member::Ambient as usize] = MAXIMUM_REQUEST_W;
        }
        demand
    }
}

#[cfg(test)]
mod tests {
    use crate::experiment::Experiment;
    use hp_plant::circuits::assembly::NODES;
    use hp_plant::command::{Connection, Demand, Member};
    use hp_plant::config::Celsius;
    use hp_plant::config::library::Override;

    /// What the thermostat asks for with the cabin at a temperature.
    fn demand(scenario: &str, cabin_degc: f64) -> Demand {
        let everything = ["motor", "transmission", "ambient", "ptc"].map(|source| {
            Override::parse(&format!("scenario.strategy.{source}=true")).expect("an assignment")
        });
        let experiment = Experiment::load(scenario, Some("thermostat"), &everything).expect("built in");
        let mut run = experiment.start();
        run.state.temperatures_k[NODES.cabin.index()] = Celsius(cabin_degc).kelvin();
        experiment.rules.demand(&experiment.plant, &run.state, &mut run.memory, &[0.0; 6])
    }

    #[test]
    fn heats_below_its_band_and_rests_within_it() {
        let cold = demand("jeffs2019/case1-4", 5.0);
        assert!(cold.compressor_power_w > 0.0 && cold.ptc_allowed);
        assert_eq!(cold.connections[Member::Cabin as usize], Connection::Htc);
        assert_eq!(cold.connections[Member::Battery as usize], Connection::Isolated);
        for source in [Member::Ambient, Member::Motor, Member::Transmission] {
            assert_eq!(cold.connections[source as usize], Connection::Chiller);
        }
        let cool = demand("jeffs2019/case1-4", 20.9);
        assert!(cool.compressor_power_w > 0.0 && !cool.ptc_allowed);
        assert_eq!(demand("jeffs2019/case1-4", 21.1).compressor_power_w, 0.0);
    }

    #[test]
    fn cools_above_its_band_through_the_front_end_exchanger() {
        let hot = demand("ours/hot-soak-plus35", 40.0);
        assert!(hot.compressor_power_w > 0.0 && !hot.ptc_allowed);
        assert_eq!(hot.connections[Member::Cabin as usize], Connection::Chiller);
        assert_eq!(hot.connections[Member::Ambient as usize], Connection::Htc);
        assert_eq!(demand("ours/hot-soak-plus35", 22.9).compressor_power_w, 0.0);
    }
}
