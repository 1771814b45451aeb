//! Totals of a run.

use crate::comfort::{CO2_HIGHEST_PPM, Course};
use crate::pace::Pace;
use hp_plant::architecture::declaration::Side;
use hp_plant::architecture::layout::{LOOP_PLACES, Layout};
use hp_plant::components::cabin_air::CabinAir;
use hp_plant::components::equivalent_temperature::of_cabin;
use hp_plant::config::vehicle::VehicleParameters;
use hp_plant::config::{Celsius, ZERO_CELSIUS_K};
use hp_plant::flows::{Flow, Flows};
use hp_plant::plant::{CONTROL_PERIOD_S, Disturbance, Plant, StepRecord};
use hp_plant::state::State;
use serde::{Deserialize, Serialize};

/// Joule in a kilowatt-hour.
const JOULE_PER_KWH: f64 = 3.6e6;

/// Cabin temperature that comfort is measured against (paper section 2.2) [degC].
pub const COMFORT_TEMPERATURE_DEGC: f64 = 22.0;

/// Deviation within which the cabin counts as comfortable [K].
pub const COMFORT_BAND_K: f64 = 1.0;

/// Carbon dioxide above which air counts as bad: "hygienically conspicuous" (Umweltbundesamt 2008; Pettenkofer) [ppm].
pub const CO2_LIMIT_PPM: f64 = 1000.0;

/// Largest overshoot that counts as rounding and not as a breach.
const PRESSURE_TOLERANCE_BAR: f64 = 0.05;
const TEMPERATURE_TOLERANCE_K: f64 = 0.1;

/// Limits that a run of a vehicle is judged by, by name.
#[must_use]
pub fn limits(vehicle: &VehicleParameters) -> Vec<(String, f64)> {
    let mut limits = vec![
        ("cabin_lowest_degc".to_owned(), COMFORT_TEMPERATURE_DEGC - COMFORT_BAND_K),
        ("cabin_highest_degc".to_owned(), COMFORT_TEMPERATURE_DEGC + COMFORT_BAND_K),
    ];
    for (circuit, parameters) in vehicle.layout.loops.iter().zip(&vehicle.loops) {
        if let Some(highest) = parameters.maximum_supply_degc {
            limits.push((format!("{}_supply_highest_degc", circuit.name), highest.0));
        }
        if let Some(lowest) = parameters.minimum_supply_degc {
            limits.push((format!("{}_supply_lowest_degc", circuit.name), lowest.0));
        }
    }
    if let Some(refrigeration) = &vehicle.refrigeration {
        limits.push(("condensing_pressure_highest_bar".to_owned(), refrigeration.maximum_pressure_bar));
    }
    limits
}

/// Supply temperature of each loop [K].
#[must_use]
#[inline]
pub fn supplies_k(layout: &Layout, state: &State) -> [f64; LOOP_PLACES] {
    let mut supplies_k = [0.0; LOOP_PLACES];
    for (supply_k, circuit) in supplies_k.iter_mut().zip(&layout.loops) {
        *supply_k = state.temperatures_k[circuit.supply.index()];
    }
    supplies_k
}

/// Running totals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    energies_j: Flows,
    duration_s: f64,
    distance_m: f64,
    delay_s: f64,
    furthest_behind_m: f64,
    discomfort_k_s: f64,
    comfortable_s: f64,
    first_comfort_s: f64,
    /// Of the cabin's air, and of its equivalent temperature.
    air: Course,
    equivalent: Course,
    final_soc: f64,
    final_charge_soc: f64,
    highest_pressure_bar: f64,
    /// Highest and lowest supply of each loop.
    highest_supply_degc: [f64; LOOP_PLACES],
    lowest_supply_degc: [f64; LOOP_PLACES],
    limit_breaches: f64,
    worst_residual: f64,
    voltage_v_s: f64,
    compressor_starts: f64,
    protection_trips: f64,
    shed_s: f64,
    fog_s: f64,
    fog_k_s: f64,
    co2_above_limit_ppm_s: f64,
    co2_above_highest_s: f64,
    highest_co2_ppm: f64,
    worst_water_residual: f64,
}

impl Default for Summary {
    fn default() -> Self {
        Self {
            energies_j: Flows::default(),
            duration_s: 0.0,
            distance_m: 0.0,
            delay_s: 0.0,
            furthest_behind_m: 0.0,
            discomfort_k_s: 0.0,
            comfortable_s: 0.0,
            first_comfort_s: f64::NAN,
            air: Course::default(),
            equivalent: Course::default(),
            final_soc: f64::NAN,
            final_charge_soc: f64::NAN,
            highest_pressure_bar: 0.0,
            highest_supply_degc: [f64::NEG_INFINITY; LOOP_PLACES],
            lowest_supply_degc: [f64::INFINITY; LOOP_PLACES],
            limit_breaches: 0.0,
            worst_residual: 0.0,
            voltage_v_s: 0.0,
            compressor_starts: 0.0,
            protection_trips: 0.0,
            shed_s: 0.0,
            fog_s: 0.0,
            fog_k_s: 0.0,
            co2_above_limit_ppm_s: 0.0,
            co2_above_highest_s: 0.0,
            highest_co2_ppm: 0.0,
            worst_water_residual: 0.0,
        }
    }
}

impl Summary {
    /// Adds a step that began with these temperatures of the loops' supplies [K].
    pub fn add(
        &mut self,
        plant: &Plant,
        supplies_before_k: &[f64; LOOP_PLACES],
        after: &State,
        record: &StepRecord,
        disturbance: &Disturbance,
    ) {
        let layout = plant.layout();
        self.energies_j.accumulate(&record.flows, CONTROL_PERIOD_S);
        self.duration_s += CONTROL_PERIOD_S;
        self.distance_m += 0.5 * (disturbance.start_speed_m_s + record.end_speed_m_s) * CONTROL_PERIOD_S;
        let cabin_degc = after.temperatures_k[layout.cabins[0].air.index()] - ZERO_CELSIUS_K;
        let deviation_k = (cabin_degc - COMFORT_TEMPERATURE_DEGC).abs();
        self.discomfort_k_s += deviation_k * CONTROL_PERIOD_S;
        if deviation_k <= COMFORT_BAND_K {
            self.comfortable_s += CONTROL_PERIOD_S;
            if self.first_comfort_s.is_nan() {
                self.first_comfort_s = self.duration_s;
            }
        }
        self.air.add(self.duration_s, cabin_degc);
        let equivalent_degc = of_cabin(&layout.cabins[0], &after.temperatures_k, record.supply_air_kg_s);
        self.equivalent.add(self.duration_s, equivalent_degc);
        let battery_k = after.temperatures_k[layout.battery.index()];
        self.final_soc = plant.battery.usable_state_of_charge(&after.battery, battery_k);
        self.final_charge_soc = plant.battery.charge_left(&after.battery);
        self.voltage_v_s += record.battery_voltage_v * CONTROL_PERIOD_S;
        self.worst_residual = self.worst_residual.max(record.ledger.relative());
        self.compressor_starts = f64::from(after.refrigeration.compressor.starts);
        self.protection_trips = f64::from(after.refrigeration.compressor.protection_trips);
        self.shed_s += f64::from(u8::from(record.loads_shed)) * CONTROL_PERIOD_S;
        self.add_air(&after.cabin_air[0], record);
        self.check_limits(plant, supplies_before_k, after, record);
    }

    /// Takes down by how much the trip is late after a second, and how far the vehicle is behind.
    pub fn keep_pace(&mut self, delay_s: usize, pace: &Pace) {
        self.delay_s = delay_s as f64;
        self.furthest_behind_m = self.furthest_behind_m.max(pace.behind_m);
    }

    /// Fog on the windscreen and bad air in the cabin that counts for comfort.
    fn add_air(&mut self, air: &CabinAir, record: &StepRecord) {
        let fog_k = (-air.fog_margin_k()).max(0.0);
        self.fog_s += f64::from(u8::from(fog_k > 0.0)) * CONTROL_PERIOD_S;
        self.fog_k_s += fog_k * CONTROL_PERIOD_S;
        let co2_ppm = air.co2 * 1e6;
        self.co2_above_limit_ppm_s += (co2_ppm - CO2_LIMIT_PPM).max(0.0) * CONTROL_PERIOD_S;
        self.co2_above_highest_s += f64::from(u8::from(co2_ppm > CO2_HIGHEST_PPM)) * CONTROL_PERIOD_S;
        self.highest_co2_ppm = self.highest_co2_ppm.max(co2_ppm);
        self.worst_water_residual = self.worst_water_residual.max(record.water_ledger.relative());
    }

    /// A breach is a limit passed while the heat pump runs and moves away from where the step began.
    fn check_limits(
        &mut self,
        plant: &Plant,
        before_k: &[f64; LOOP_PLACES],
        after: &State,
        record: &StepRecord,
    ) {
        let vehicle = &plant.vehicle;
        let running = record.refrigeration.running();
        let mut breached = false;
        for (place, circuit) in vehicle.layout.loops.iter().enumerate().take(LOOP_PLACES) {
            let supply_k = after.temperatures_k[circuit.supply.index()];
            let supply_degc = supply_k - ZERO_CELSIUS_K;
            self.highest_supply_degc[place] = self.highest_supply_degc[place].max(supply_degc);
            self.lowest_supply_degc[place] = self.lowest_supply_degc[place].min(supply_degc);
            let highest_k = vehicle.loops[place].maximum_supply_degc.map_or(f64::INFINITY, Celsius::kelvin);
            let lowest_k =
                vehicle.loops[place].minimum_supply_degc.map_or(f64::NEG_INFINITY, Celsius::kelvin);
            let too_hot = supply_k > highest_k + TEMPERATURE_TOLERANCE_K && supply_k > before_k[place];
            let too_cold = supply_k < lowest_k - TEMPERATURE_TOLERANCE_K && supply_k < before_k[place];
            breached |= circuit.exchanger.is_some() && (too_hot || too_cold);
        }
        let Some(refrigeration) = vehicle.refrigeration.as_ref().filter(|_| running) else { return };
        let pressure_bar = record.refrigeration.condensing_pressure_pa * 1e-5;
        self.highest_pressure_bar = self.highest_pressure_bar.max(pressure_bar);
        breached |= pressure_bar > refrigeration.maximum_pressure_bar + PRESSURE_TOLERANCE_BAR;
        let compressor = &refrigeration.compressor;
        let gas_k = record.refrigeration.discharge_temperature_k;
        let hottest_gas_k = compressor.maximum_discharge_temperature_degc + ZERO_CELSIUS_K;
        breached |= gas_k > hottest_gas_k + TEMPERATURE_TOLERANCE_K;
        breached |= record.refrigeration.speed_rev_s > compressor.maximum_speed_rev_s * 1.001;
        self.limit_breaches += f64::from(u8::from(breached));
    }

    /// What a trip's comfort is judged by.
    fn comfort(&self) -> [(&'static str, f64); 7] {
        let (air, equivalent) = (&self.air, &self.equivalent);
        [
            ("time_to_near_comfort_s", air.time_to_near_comfort_s()),
            ("outside_near_comfort_k_s", air.outside_near_comfort_k_s()),
            ("discomfort_afterwards_k", air.discomfort_afterwards_k(self.duration_s)),
            ("equivalent_time_to_near_comfort_s", equivalent.time_to_near_comfort_s()),
            ("equivalent_outside_near_comfort_k_s", equivalent.outside_near_comfort_k_s()),
            ("equivalent_discomfort_afterwards_k", equivalent.discomfort_afterwards_k(self.duration_s)),
            ("co2_above_1500_ppm_s", self.co2_above_highest_s),
        ]
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

    /// All totals by name, energies in kWh; none where a quantity does not exist, as energy per distance of a trip of 0 km.
    #[must_use]
    pub fn values(&self, layout: &Layout) -> Vec<(String, Option<f64>)> {
        let kwh = |flow: Flow| self.energies_j[flow] / JOULE_PER_KWH;
        let distance_km = self.distance_m / 1000.0;
        let mut values: Vec<(String, Option<f64>)> = Vec::new();
        let mut add = |rows: &[(&str, f64)]| {
            let there = |value: f64| value.is_finite().then_some(value);
            values.extend(rows.iter().map(|&(name, value)| (name.to_owned(), there(value))));
        };
        add(&[
            ("energy_kwh", kwh(Flow::BATTERY)),
            ("energy_kwh_per_100_km", 100.0 * kwh(Flow::BATTERY) / distance_km),
            ("final_soc_pct", 100.0 * self.final_soc),
            ("final_charge_soc_pct", 100.0 * self.final_charge_soc),
            ("duration_s", self.duration_s),
            ("distance_km", distance_km),
            ("delay_s", self.delay_s),
            ("furthest_behind_m", self.furthest_behind_m),
            ("discomfort_k", self.discomfort_k_s / self.duration_s),
            ("time_to_comfort_s", self.first_comfort_s),
            ("comfortable_share", self.comfortable_s / self.duration_s),
            ("mean_voltage_v", self.voltage_v_s / self.duration_s),
            ("heat_pump_cop", self.energies_j[Flow::CONDENSER] / self.energies_j[Flow::COMPRESSOR]),
            ("compressor_starts", self.compressor_starts),
            ("protection_trips", self.protection_trips),
            ("loads_shed_s", self.shed_s),
            ("highest_pressure_bar", self.highest_pressure_bar),
            ("fog_s", self.fog_s),
            ("fog_k_s", self.fog_k_s),
            ("co2_above_limit_ppm_s", self.co2_above_limit_ppm_s),
            ("highest_co2_ppm", self.highest_co2_ppm),
        ]);
        add(&self.comfort());
        for (place, circuit) in layout.loops.iter().enumerate() {
            let (ends, value) = match circuit.side {
                Side::Hot => ("highest", self.highest_supply_degc[place]),
                Side::Cold => ("lowest", self.lowest_supply_degc[place]),
            };
            add(&[(&format!("{ends}_{}_supply_degc", circuit.name), value)]);
        }
        add(&[("limit_breaches", self.limit_breaches), ("worst_relative_residual", self.worst_residual)]);
        add(&[("worst_relative_water_residual", self.worst_water_residual)]);
        for row in &layout.flows {
            add(&[(&row.energy_column(), kwh(row.flow))]);
        }
        values
    }
}
