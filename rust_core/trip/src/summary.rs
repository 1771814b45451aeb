//! Totals of a run.

use hp_plant::config::ZERO_CELSIUS_K;
use hp_plant::config::vehicle::VehicleParameters;
use hp_plant::flows::{FLOW_COUNT, Flow, Flows};
use hp_plant::plant::{CONTROL_PERIOD_S, Disturbance, Plant, StepRecord};
use hp_plant::state::State;
use serde::{Deserialize, Serialize};

/// Joule in a kilowatt-hour.
const JOULE_PER_KWH: f64 = 3.6e6;

/// Cabin temperature that comfort is measured against (paper section 2.2) [degC].
pub const COMFORT_TEMPERATURE_DEGC: f64 = 22.0;

/// Deviation within which the cabin counts as comfortable [K].
pub const COMFORT_BAND_K: f64 = 1.0;

/// Largest overshoot that counts as rounding and not as a breach.
const PRESSURE_TOLERANCE_BAR: f64 = 0.05;
const TEMPERATURE_TOLERANCE_K: f64 = 0.1;

/// Limits that a run of a vehicle is judged by, by name.
#[must_use]
pub fn limits(vehicle: &VehicleParameters) -> [(&'static str, f64); 5] {
    [
        ("cabin_lowest_degc", COMFORT_TEMPERATURE_DEGC - COMFORT_BAND_K),
        ("cabin_highest_degc", COMFORT_TEMPERATURE_DEGC + COMFORT_BAND_K),
        ("htc_supply_highest_degc", vehicle.htc.maximum_supply_degc.0),
        ("chiller_supply_lowest_degc", vehicle.chiller.minimum_supply_degc.0),
        ("condensing_pressure_highest_bar", vehicle.refrigeration.maximum_pressure_bar),
    ]
}

/// Running totals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    energies_j: Flows,
    duration_s: f64,
    distance_m: f64,
    discomfort_k_s: f64,
    comfortable_s: f64,
    first_comfort_s: f64,
    final_soc: f64,
    final_charge_soc: f64,
    highest_pressure_bar: f64,
    highest_htc_supply_degc: f64,
    lowest_chiller_supply_degc: f64,
    limit_breaches: f64,
    worst_residual: f64,
    voltage_v_s: f64,
    compressor_starts: f64,
    protection_trips: f64,
    shed_s: f64,
}

impl Default for Summary {
    fn default() -> Self {
        Self {
            energies_j: Flows::default(),
            duration_s: 0.0,
            distance_m: 0.0,
            discomfort_k_s: 0.0,
            comfortable_s: 0.0,
            first_comfort_s: f64::NAN,
            final_soc: f64::NAN,
            final_charge_soc: f64::NAN,
            highest_pressure_bar: 0.0,
            highest_htc_supply_degc: f64::NEG_INFINITY,
            lowest_chiller_supply_degc: f64::INFINITY,
            limit_breaches: 0.0,
            worst_residual: 0.0,
            voltage_v_s: 0.0,
            compressor_starts: 0.0,
            protection_trips: 0.0,
            shed_s: 0.0,
        }
    }
}

impl Summary {
    /// Adds a step that began with these temperatures of HTC and chiller supply [K].
    pub fn add(
        &mut self,
        plant: &Plant,
        supplies_before_k: [f64; 2],
        after: &State,
        record: &StepRecord,
        disturbance: &Disturbance,
    ) {
        let nodes = &plant.assembly.nodes;
        let degc = |state: &State, node: hp_plant::numerics::thermal_network::Node| {
            state.temperatures_k[node.index()] - ZERO_CELSIUS_K
        };
        self.energies_j.accumulate(&record.flows, CONTROL_PERIOD_S);
        self.duration_s += CONTROL_PERIOD_S;
        self.distance_m += 0.5 * (disturbance.start_speed_m_s + disturbance.end_speed_m_s) * CONTROL_PERIOD_S;
        let deviation_k = (degc(after, nodes.cabin) - COMFORT_TEMPERATURE_DEGC).abs();
        self.discomfort_k_s += deviation_k * CONTROL_PERIOD_S;
        if deviation_k <= COMFORT_BAND_K {
            self.comfortable_s += CONTROL_PERIOD_S;
            if self.first_comfort_s.is_nan() {
                self.first_comfort_s = self.duration_s;
            }
        }
        self.final_soc =
            plant.battery.usable_state_of_charge(&after.battery, after.temperatures_k[nodes.battery.index()]);
        self.final_charge_soc = plant.battery.state_of_charge(&after.battery);
        self.voltage_v_s += record.battery_voltage_v * CONTROL_PERIOD_S;
        self.worst_residual = self.worst_residual.max(record.ledger.relative());
        self.compressor_starts = f64::from(after.refrigeration.compressor.starts);
        self.protection_trips = f64::from(after.refrigeration.compressor.protection_trips);
        self.shed_s += f64::from(u8::from(record.loads_shed)) * CONTROL_PERIOD_S;
        self.check_limits(plant, supplies_before_k, after, record);
    }

    /// A breach is a limit passed while the heat pump runs and moves away from where the step began.
    fn check_limits(
        &mut self,
        plant: &Plant,
        supplies_before_k: [f64; 2],
        after: &State,
        record: &StepRecord,
    ) {
        let nodes = &plant.assembly.nodes;
        let vehicle = &plant.vehicle;
        let htc = (supplies_before_k[0], after.temperatures_k[nodes.htc_supply.index()]);
        let chiller = (supplies_before_k[1], after.temperatures_k[nodes.chiller_supply.index()]);
        self.highest_htc_supply_degc = self.highest_htc_supply_degc.max(htc.1 - ZERO_CELSIUS_K);
        self.lowest_chiller_supply_degc = self.lowest_chiller_supply_degc.min(chiller.1 - ZERO_CELSIUS_K);
        if !record.refrigeration.running() {
            return;
        }
        let pressure_bar = record.refrigeration.condensing_pressure_pa * 1e-5;
        self.highest_pressure_bar = self.highest_pressure_bar.max(pressure_bar);
        let too_high = pressure_bar > vehicle.refrigeration.maximum_pressure_bar + PRESSURE_TOLERANCE_BAR;
        let too_hot =
            htc.1 > vehicle.htc.maximum_supply_degc.kelvin() + TEMPERATURE_TOLERANCE_K && htc.1 > htc.0;
        let too_cold = chiller.1 < vehicle.chiller.minimum_supply_degc.kelvin() - TEMPERATURE_TOLERANCE_K
            && chiller.1 < chiller.0;
        let compressor = &vehicle.refrigeration.compressor;
        let gas_k = record.refrigeration.discharge_temperature_k;
        let gas_too_hot =
            gas_k > compressor.maximum_discharge_temperature_degc + ZERO_CELSIUS_K + TEMPERATURE_TOLERANCE_K;
        let too_fast = record.refrigeration.speed_rev_s > compressor.maximum_speed_rev_s * 1.001;
        let breached = too_high || too_hot || too_cold || gas_too_hot || too_fast;
        self.limit_breaches += f64::from(u8::from(breached));
    }

    /// State of charge of equation (6) at the end of the last step [-].
    #[must_use]
    pub fn final_soc(&self) -> f64 {
        self.final_soc
    }

    /// Energy of a flow so far [J].
    #[must_use]
    pub fn energy_j(&self, flow: Flow) -> f64 {
        self.energies_j[flow]
    }

    /// All totals by name; energies in kWh.
    #[must_use]
    pub fn values(&self) -> Vec<(String, f64)> {
        let kwh = |flow: Flow| self.energies_j[flow] / JOULE_PER_KWH;
        let distance_km = self.distance_m / 1000.0;
        let mut values: Vec<(String, f64)> = [
            ("energy_kwh", kwh(Flow::Battery)),
            ("energy_kwh_per_100_km", 100.0 * kwh(Flow::Battery) / distance_km),
            ("final_soc_pct", 100.0 * self.final_soc),
            ("final_charge_soc_pct", 100.0 * self.final_charge_soc),
            ("duration_s", self.duration_s),
            ("distance_km", distance_km),
            ("discomfort_k", self.discomfort_k_s / self.duration_s),
            ("time_to_comfort_s", self.first_comfort_s),
            ("comfortable_share", self.comfortable_s / self.duration_s),
            ("mean_voltage_v", self.voltage_v_s / self.duration_s),
            ("heat_pump_cop", self.energies_j[Flow::Condenser] / self.energies_j[Flow::Compressor]),
            ("compressor_starts", self.compressor_starts),
            ("protection_trips", self.protection_trips),
            ("loads_shed_s", self.shed_s),
            ("highest_pressure_bar", self.highest_pressure_bar),
            ("highest_htc_supply_degc", self.highest_htc_supply_degc),
            ("lowest_chiller_supply_degc", self.lowest_chiller_supply_degc),
            ("limit_breaches", self.limit_breaches),
            ("worst_relative_residual", self.worst_residual),
        ]
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect();
        for &flow in &Flow::ALL[..FLOW_COUNT] {
            let stem = flow
                .column()
                .trim_end_matches("_w")
                .trim_end_matches("_power")
                .trim_end_matches("_heat_flow");
            values.push((format!("{stem}_energy_kwh"), kwh(flow)));
        }
        values
    }
}
