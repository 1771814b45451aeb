//! Compressor power in proportion to what the cabin lacks; everything else rests as connected.

use super::rule_based::{CabinMode, ConstantSettings, Presets, RuleBased};
use crate::roles::Roles;
use crate::settings::DriverSettings;
use crate::strategy::{ClimateControl, Strategy};
use hp_plant::architecture::layout::Layout;
use hp_plant::command::Demand;
use hp_plant::config::Celsius;
use hp_plant::parameters;
use hp_plant::plant::Plant;
use hp_plant::state::State;

parameters! {
    /// Proportional rules.
    pub struct ProportionalParameters {
        /// Cabin target [degC].
        cabin_set_point_degc: Celsius = 10.0 .. 30.0,
        /// Compressor power for each kelvin that the cabin lacks [W/K].
        power_w_k: f64 = 1.0 .. 5000.0,
        /// Coolant flow of all loops [kg/s].
        coolant_flow_kg_s: f64 = 0.001 .. 5.0,
    }
}

/// Proportional rules with what they found in the vehicle.
#[derive(Debug, Clone, PartialEq)]
pub struct Proportional {
    parameters: ProportionalParameters,
    strategy: Strategy,
    roles: Roles,
    presets: Presets,
}

fn constant_settings(parameters: &ProportionalParameters) -> ConstantSettings {
    ConstantSettings {
        cabin_set_point_degc: parameters.cabin_set_point_degc,
        htc_flow_kg_s: parameters.coolant_flow_kg_s,
        chiller_flow_kg_s: parameters.coolant_flow_kg_s,
        blower_level: 1.0,
        cooling_blower_level: 1.0,
        heating_recirculation: 0.0,
        cooling_recirculation: 0.7,
    }
}

impl RuleBased for Proportional {
    type Parameters = ProportionalParameters;
    type Memory = ();

    fn new(parameters: ProportionalParameters, strategy: Strategy, layout: &Layout) -> Self {
        let roles = Roles::of(layout, &strategy);
        let presets = Presets::of(&roles, &constant_settings(&parameters));
        Self { parameters, strategy, roles, presets }
    }

    fn roles(&self) -> &Roles {
        &self.roles
    }

    fn constant_settings(&self) -> ConstantSettings {
        constant_settings(&self.parameters)
    }

    fn awake(&self, _: &Plant, _: &State, _: &DriverSettings) {}

    fn demand(
        &self,
        _: &Plant,
        state: &State,
        settings: &DriverSettings,
        (): &mut (),
        demand: &mut Demand,
    ) {
        let target_k = settings.target_k(self.parameters.cabin_set_point_degc);
        let cabin_k = state.temperatures_k[self.roles.cabin_air.index()];
        let mode = match self.strategy.climate_control {
            ClimateControl::Heat => CabinMode::Heating,
            ClimateControl::Cool => CabinMode::Cooling,
            ClimateControl::Auto if cabin_k > target_k => CabinMode::Cooling,
            ClimateControl::Auto => CabinMode::Heating,
        };
        self.presets.enter(mode, demand);
        settings.enter(0.0, &self.roles, demand);
        self.roles.allow_heaters(false, demand);
        if let Some(row) = self.roles.compressor_row {
            demand[row] = self.parameters.power_w_k * mode.lack_k(target_k, cabin_k).max(0.0);
        }
        if mode == CabinMode::Cooling {
            self.roles.unlimit_rejection(demand);
        }
    }
}
