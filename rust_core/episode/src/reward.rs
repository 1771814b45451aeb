//! What a trip costs: one expression, the reward of an agent second by second and the KPI of a benchmark.

use crate::reference::{ReferenceConditions, ReferenceTrip};
use hp_plant::config::{Celsius, Validate, Violation, ZERO_CELSIUS_K};
use hp_plant::flows::Flow;
use hp_plant::numerics::thermal_network::NodeValues;
use hp_plant::parameters;
use hp_plant::plant::{CONTROL_PERIOD_S, Disturbance, Plant};
use hp_plant::state::State;
use hp_trip::experiment::Experiment;
use hp_trip::run::{EndReason, Run};
use hp_trip::summary::COMFORT_TEMPERATURE_DEGC;
use serde::{Deserialize, Serialize};
use std::ops::AddAssign;

const JOULE_PER_KWH: f64 = 3.6e6;
const SECONDS_PER_HOUR: f64 = 3600.0;

/// Stored heat counts in the battery up to this temperature.
const USEFUL_BATTERY: Celsius = Celsius(20.0);

parameters! {
    /// Weights of the terms, in points.
    pub struct RewardParameters {
        /// For a kWh of attributable energy.
        energy_per_kwh: f64 = 0.0 .. 1000.0,
        /// For an hour of 1 K between cabin and 22 degC.
        discomfort_per_k_h: f64 = 0.0 .. 1000.0,
        /// Share of the energy weight that a kWh of heat left at arrival is credited with [-].
        heat_left_credit: f64 = 0.0 .. 1.0,
        /// For an hour of 1 K between the battery and its window.
        battery_window_per_k_h: f64 = 0.0 .. 1000.0,
        /// Lower end of the window [degC].
        battery_window_low_degc: Celsius = -50.0 .. 60.0,
        /// Upper end of the window [degC].
        battery_window_high_degc: Celsius = -50.0 .. 80.0,
        /// For each stop of the compressor that a protection forces.
        protection_trip: f64 = 0.0 .. 1000.0,
        /// For a trip that ends before arrival. More than any trip can cost, or giving up would pay.
        stranded: f64 = 0.0 .. 1000000.0,
    }
}

/// What a trip costs, in physical units: additive over time.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Terms {
    /// Chemical energy drawn from the cells [kWh].
    pub chemical_energy_kwh: f64,
    /// The same on the reference trip [kWh].
    pub reference_energy_kwh: f64,
    /// Deviation of the cabin from 22 degC while occupied, integrated [K h].
    pub discomfort_k_h: f64,
    /// Time with somebody in the car [h].
    pub occupied_h: f64,
    /// Heat left at arrival relative to the start [kWh].
    pub heat_left_kwh: f64,
    /// Distance of the battery's temperature from its window, integrated [K h].
    pub battery_window_k_h: f64,
    /// Stops of the compressor that a protection forced.
    pub protection_trips: f64,
    /// 1 if the trip ended before arrival.
    pub stranded: f64,
}

impl AddAssign for Terms {
    fn add_assign(&mut self, other: Self) {
        self.chemical_energy_kwh += other.chemical_energy_kwh;
        self.reference_energy_kwh += other.reference_energy_kwh;
        self.discomfort_k_h += other.discomfort_k_h;
        self.occupied_h += other.occupied_h;
        self.heat_left_kwh += other.heat_left_kwh;
        self.battery_window_k_h += other.battery_window_k_h;
        self.protection_trips += other.protection_trips;
        self.stranded += other.stranded;
    }
}

/// Parts of a reward, in the order of [`PART_NAMES`].
pub type Parts = [f64; 4];

/// Names of the parts of a reward.
pub const PART_NAMES: [&str; 4] =
    ["reward_energy", "reward_discomfort", "reward_heat_left", "reward_penalties"];

impl Terms {
    /// Chemical energy beyond that of the reference trip [kWh].
    #[must_use]
    pub fn attributable_energy_kwh(&self) -> f64 {
        self.chemical_energy_kwh - self.reference_energy_kwh
    }

    /// The reward for these terms, part by part; their sum is the score of a trip.
    #[must_use]
    pub fn reward(&self, weights: &RewardParameters) -> Parts {
        [
            -weights.energy_per_kwh * self.attributable_energy_kwh(),
            -weights.discomfort_per_k_h * self.discomfort_k_h,
            weights.heat_left_credit * weights.energy_per_kwh * self.heat_left_kwh,
            -weights.battery_window_per_k_h * self.battery_window_k_h
                - weights.protection_trip * self.protection_trips
                - weights.stranded * self.stranded,
        ]
    }

    /// KPIs of a trip by name.
    #[must_use]
    pub fn kpis(&self, weights: &RewardParameters) -> [(&'static str, f64); 8] {
        let mean = if self.occupied_h > 0.0 { self.discomfort_k_h / self.occupied_h } else { 0.0 };
        [
            ("score", self.reward(weights).iter().sum()),
            ("attributable_energy_kwh", self.attributable_energy_kwh()),
            ("chemical_energy_kwh", self.chemical_energy_kwh),
            ("reference_energy_kwh", self.reference_energy_kwh),
            ("discomfort_k", mean),
            ("heat_left_kwh", self.heat_left_kwh),
            ("battery_window_k_h", self.battery_window_k_h),
            ("protection_trips", self.protection_trips),
        ]
    }
}

/// Adds up the terms of a trip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Meter {
    /// Terms so far.
    pub total: Terms,
    reference: ReferenceTrip,
    trips: u32,
}

impl Meter {
    /// Before the first second.
    #[must_use]
    pub fn start(state: &State) -> Self {
        Self {
            total: Terms::default(),
            reference: ReferenceTrip::start(state.battery),
            trips: state.refrigeration.compressor.protection_trips,
        }
    }

    /// Adds a second; returns what it added.
    pub fn add(
        &mut self,
        experiment: &Experiment,
        conditions: &ReferenceConditions,
        weights: &RewardParameters,
        run: &Run,
        disturbance: &Disturbance,
        end: Option<EndReason>,
    ) -> Terms {
        let after = &run.state;
        let chemical_w = run.record.map_or(0.0, |record| record.flows[Flow::Chemical]);
        let plant = &experiment.plant;
        let nodes = &plant.assembly.nodes;
        let degc = |index: usize| after.temperatures_k[index] - ZERO_CELSIUS_K;
        let hours = CONTROL_PERIOD_S / SECONDS_PER_HOUR;
        let occupied = disturbance.occupants > 0.0;
        let battery_degc = degc(nodes.battery.index());
        let (low, high) = (weights.battery_window_low_degc.0, weights.battery_window_high_degc.0);
        let trips = after.refrigeration.compressor.protection_trips;
        let reference_j = self.reference.step(plant, conditions, disturbance);
        let added = Terms {
            chemical_energy_kwh: chemical_w * CONTROL_PERIOD_S / JOULE_PER_KWH,
            reference_energy_kwh: reference_j / JOULE_PER_KWH,
            discomfort_k_h: if occupied {
                (degc(nodes.cabin.index()) - COMFORT_TEMPERATURE_DEGC).abs() * hours
            } else {
                0.0
            },
            occupied_h: if occupied { hours } else { 0.0 },
            heat_left_kwh: match end {
                Some(EndReason::Arrived) => {
                    let heating = experiment.climate.ambient_temperature_degc.0 < COMFORT_TEMPERATURE_DEGC;
                    let start = plant.parked(&experiment.initial);
                    useful_heat_j(plant, &start.temperatures_k, &after.temperatures_k, heating)
                        / JOULE_PER_KWH
                }
                _ => 0.0,
            },
            battery_window_k_h: ((low - battery_degc).max(0.0) + (battery_degc - high).max(0.0)) * hours,
            protection_trips: f64::from(trips - self.trips),
            stranded: f64::from(u8::from(end.is_some_and(|reason| reason != EndReason::Arrived))),
        };
        self.trips = trips;
        self.total += added;
        added
    }
}

/// Heat stored between two sets of temperatures that the next trip can use [J].
///
/// Cabin masses, coolant loops and thermal battery, and the battery up to 20 degC. In a climate that calls for
/// cooling, what is useful in cabin, loops and thermal battery is the heat that is gone.
fn useful_heat_j(plant: &Plant, start_k: &NodeValues, end_k: &NodeValues, heating: bool) -> f64 {
    let nodes = &plant.assembly.nodes;
    let counted = [
        nodes.cabin,
        nodes.exhaust,
        nodes.soft,
        nodes.hard,
        nodes.htc_supply,
        nodes.htc_return,
        nodes.chiller_supply,
        nodes.chiller_return,
        nodes.thermal_battery,
    ];
    let mut changed_k = *start_k;
    for node in counted {
        changed_k[node.index()] = end_k[node.index()];
    }
    let climate_j = plant.assembly.network.heat_gained_j(start_k, &changed_k);
    let battery = nodes.battery.index();
    let (mut before_k, mut after_k) = (NodeValues::default(), NodeValues::default());
    before_k[battery] = start_k[battery].min(USEFUL_BATTERY.kelvin());
    after_k[battery] = end_k[battery].min(USEFUL_BATTERY.kelvin());
    let battery_j = plant.assembly.network.heat_gained_j(&before_k, &after_k);
    battery_j + if heating { climate_j } else { -climate_j }
}

/// Checks what single ranges cannot.
///
/// # Errors
/// The battery's window is empty.
pub fn check(weights: &RewardParameters) -> Result<(), Violation> {
    weights.validate()?;
    if weights.battery_window_low_degc > weights.battery_window_high_degc {
        return Err(Violation::new(
            "battery_window_low_degc",
            weights.battery_window_low_degc.0,
            format!("must not exceed battery_window_high_degc ({})", weights.battery_window_high_degc.0),
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn warmed(nodes: &[usize], by_k: f64, start_degc: f64, heating: bool) -> f64 {
        let experiment = Experiment::load("jeffs2019/case1-1", None, &[]).expect("built in");
        let start = [start_degc + ZERO_CELSIUS_K; hp_plant::numerics::thermal_network::MAXIMUM_NODES];
        let mut end = start;
        for &node in nodes {
            end[node] += by_k;
        }
        useful_heat_j(&experiment.plant, &start, &end, heating)
    }

    fn battery_node() -> usize {
        let experiment = Experiment::load("jeffs2019/case1-1", None, &[]).expect("built in");
        experiment.plant.assembly.nodes.battery.index()
    }

    #[test]
    fn battery_heat_counts_up_to_20_degc_only() {
        let battery = battery_node();
        let to_20 = warmed(&[battery], 10.0, 10.0, true);
        assert!(to_20 > 0.0);
        assert_eq!(warmed(&[battery], 25.0, 10.0, true), to_20);
        assert_eq!(warmed(&[battery], 5.0, 20.0, true), 0.0);
    }

    #[test]
    fn cold_left_in_the_cabin_counts_where_cooling_is_called_for() {
        let experiment = Experiment::load("jeffs2019/case1-1", None, &[]).expect("built in");
        let cabin = experiment.plant.assembly.nodes.cabin.index();
        assert!(warmed(&[cabin], -10.0, 35.0, false) > 0.0);
        assert!(warmed(&[cabin], -10.0, 35.0, true) < 0.0);
    }
}
