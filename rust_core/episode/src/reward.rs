//! What a trip costs: one expression, the reward of an agent second by second and the KPI of a benchmark.
//!
//! A term is a row below: what it adds up, the KPI that tells it, and the weight that prices it. Terms, weights, parts of
//! rewards and KPIs follow from the rows.

use crate::reference::{ReferenceConditions, ReferenceTrip};
use hp_plant::architecture::declaration::MemberKind;
use hp_plant::config::{Celsius, Validate, Violation, ZERO_CELSIUS_K};
use hp_plant::flows::Flow;
use hp_plant::numerics::thermal_network::NodeValues;
use hp_plant::parameters;
use hp_plant::plant::{CONTROL_PERIOD_S, Disturbance, Plant};
use hp_plant::state::State;
use hp_trip::experiment::Experiment;
use hp_trip::run::{EndReason, Run};
use hp_trip::summary::{CO2_LIMIT_PPM, COMFORT_TEMPERATURE_DEGC};
use serde::{Deserialize, Serialize};
use std::ops::AddAssign;

const JOULE_PER_KWH: f64 = 3.6e6;
const SECONDS_PER_HOUR: f64 = 3600.0;
const HOURS: f64 = CONTROL_PERIOD_S / SECONDS_PER_HOUR;

/// Stored heat counts in the battery up to this temperature.
const USEFUL_BATTERY: Celsius = Celsius(20.0);

/// What the terms of a second are measured from.
struct Second<'a> {
    experiment: &'a Experiment,
    weights: &'a RewardParameters,
    before: &'a Meter,
    state: &'a State,
    chemical_w: f64,
    reference_j: f64,
    occupied: bool,
    /// Beyond the end of the cycle.
    late: bool,
    end: Option<EndReason>,
}

/// Terms by row. `adds` is what a second adds, `tells` the KPI by name, `costs` the points for the terms: part of the reward,
/// weight with its range.
macro_rules! terms {
    ($(
        #[doc = $doc:literal]
        $name:ident [$unit:literal]
            $(adds |$second:ident| $added:expr;)?
            $(tells $kpi:literal |$told:ident| $value:expr;)?
            $(costs $part:literal |$terms:ident, $weights:ident| $points:expr;
                $(#[$weight_meta:meta])* $weight:ident in $low:literal .. $high:literal;)?
    )*) => {
        terms! { @fields $( $( #[doc = $doc] #[doc = concat!(" [", $unit, "].")] $name |$second| $added; )? )* }

        parameters! {
            /// Weights of the terms, in points.
            pub struct RewardParameters {
                $($( $(#[$weight_meta])* $weight: f64 = $low .. $high, )?)*
                /// Lower end of the battery's window [degC].
                battery_window_low_degc: Celsius = -50.0 .. 60.0,
                /// Upper end of the battery's window [degC].
                battery_window_high_degc: Celsius = -50.0 .. 80.0,
            }
        }

        /// Parts of the reward, one entry a priced term.
        const PRICED_PARTS: &[&str] = &[$($( $part, )?)*];

        impl Terms {
            /// The reward for these terms, part by part; their sum is the score of a trip.
            #[must_use]
            #[inline]
            pub fn reward(&self, weights: &RewardParameters) -> Parts {
                let mut parts = [0.0; PART_NAMES.len()];
                $($(
                    const { assert!(place_of_part($part) < PART_NAMES.len()) };
                    parts[const { place_of_part($part) }] += {
                        let ($terms, $weights) = (self, weights);
                        $points
                    };
                )?)*
                parts
            }

            /// KPIs of a trip by name.
            #[must_use]
            pub fn kpis(&self, weights: &RewardParameters) -> Vec<(&'static str, f64)> {
                let mut kpis = vec![("score", self.reward(weights).iter().sum())];
                $($( kpis.push(($kpi, { let $told = self; $value })); )?)*
                kpis
            }
        }
    };
    (@fields $( $(#[doc = $doc:expr])* $name:ident |$second:ident| $added:expr; )*) => {
        /// What a trip costs, in physical units: additive over time.
        #[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
        pub struct Terms {
            $( $(#[doc = $doc])* pub $name: f64, )*
        }

        impl AddAssign for Terms {
            fn add_assign(&mut self, other: Self) {
                $( self.$name += other.$name; )*
            }
        }

        /// Names of the terms, in their order.
        pub const TERM_NAMES: &[&str] = &[$( stringify!($name), )*];

        impl Terms {
            /// Values of the terms, in the order of [`TERM_NAMES`].
            #[must_use]
            pub fn values(&self) -> [f64; TERM_NAMES.len()] {
                [$( self.$name, )*]
            }

            #[inline]
            fn of(second: &Second<'_>) -> Self {
                Self { $( $name: { let $second = second; $added }, )* }
            }
        }
    };
}

terms! {
    /// Chemical energy beyond that of the reference trip
    attributable_energy_kwh ["kWh"]
        tells "attributable_energy_kwh" |t| t.attributable_energy_kwh();
        costs "reward_energy" |t, w| -w.energy_per_kwh * t.attributable_energy_kwh();
        /// For a kWh of attributable energy.
        energy_per_kwh in 0.0 .. 1000.0;
    /// Chemical energy drawn from the cells
    chemical_energy_kwh ["kWh"]
        adds |s| s.chemical_w * CONTROL_PERIOD_S / JOULE_PER_KWH;
        tells "chemical_energy_kwh" |t| t.chemical_energy_kwh;
    /// The same on the reference trip
    reference_energy_kwh ["kWh"]
        adds |s| s.reference_j / JOULE_PER_KWH;
        tells "reference_energy_kwh" |t| t.reference_energy_kwh;
    /// Deviation of the cabin from 22 degC while occupied, integrated
    discomfort_k_h ["K h"]
        adds |s| if s.occupied { (s.cabin_degc() - COMFORT_TEMPERATURE_DEGC).abs() * HOURS } else { 0.0 };
        tells "discomfort_k" |t| if t.occupied_h > 0.0 { t.discomfort_k_h / t.occupied_h } else { 0.0 };
        costs "reward_discomfort" |t, w| -w.discomfort_per_k_h * t.discomfort_k_h;
        /// For an hour of 1 K between cabin and 22 degC.
        discomfort_per_k_h in 0.0 .. 1000.0;
    /// Time with somebody in the car
    occupied_h ["h"]
        adds |s| if s.occupied { HOURS } else { 0.0 };
    /// Heat left at arrival relative to the start
    heat_left_kwh ["kWh"]
        adds |s| if s.end == Some(EndReason::Arrived) { s.heat_left_j() / JOULE_PER_KWH } else { 0.0 };
        tells "heat_left_kwh" |t| t.heat_left_kwh;
        costs "reward_heat_left" |t, w| w.heat_left_credit * w.energy_per_kwh * t.heat_left_kwh;
        /// Share of the energy weight that a kWh of heat left at arrival is credited with [-].
        heat_left_credit in 0.0 .. 1.0;
    /// Distance of the battery's temperature from its window, integrated
    battery_window_k_h ["K h"]
        adds |s| s.outside_window_k() * HOURS;
        tells "battery_window_k_h" |t| t.battery_window_k_h;
        costs "reward_penalties" |t, w| -w.battery_window_per_k_h * t.battery_window_k_h;
        /// For an hour of 1 K between the battery and its window.
        battery_window_per_k_h in 0.0 .. 1000.0;
    /// Dew point of the cabin air above the windscreen's temperature while occupied, integrated
    fog_k_h ["K h"]
        adds |s| if s.occupied { (-s.state.cabin_air[0].fog_margin_k()).max(0.0) * HOURS } else { 0.0 };
        tells "fog_k_h" |t| t.fog_k_h;
        costs "reward_penalties" |t, w| -w.fog_per_k_h * t.fog_k_h;
        /// For an hour of fog 1 K deep on the windscreen.
        #[serde(default)]
        fog_per_k_h in 0.0 .. 1000.0;
    /// Time with fog on the windscreen while occupied
    fog_h ["h"]
        adds |s| if s.occupied && s.state.cabin_air[0].fog_margin_k() < 0.0 { HOURS } else { 0.0 };
        tells "fog_s" |t| t.fog_h * SECONDS_PER_HOUR;
        costs "reward_penalties" |t, w| -w.fog_per_h * t.fog_h;
        /// For an hour of any fog on the windscreen.
        #[serde(default)]
        fog_per_h in 0.0 .. 10000.0;
    /// Carbon dioxide of the cabin air above 1000 ppm while occupied, integrated
    bad_air_ppm_h ["ppm h"]
        adds |s| if s.occupied { (s.state.cabin_air[0].co2 * 1e6 - CO2_LIMIT_PPM).max(0.0) * HOURS } else { 0.0 };
        tells "bad_air_ppm_h" |t| t.bad_air_ppm_h;
        costs "reward_penalties" |t, w| -w.bad_air_per_ppm_h * t.bad_air_ppm_h;
        /// For an hour of 1 ppm of carbon dioxide above 1000.
        #[serde(default)]
        bad_air_per_ppm_h in 0.0 .. 10.0;
    /// Stops of the compressor that a protection forced
    protection_trips ["-"]
        adds |s| f64::from(s.state.refrigeration.compressor.protection_trips - s.before.trips);
        tells "protection_trips" |t| t.protection_trips;
        costs "reward_penalties" |t, w| -w.protection_trip * t.protection_trips;
        /// For each stop of the compressor that a protection forces.
        protection_trip in 0.0 .. 1000.0;
    /// Time beyond the end of the cycle
    delay_h ["h"]
        adds |s| if s.late { HOURS } else { 0.0 };
        tells "delay_s" |t| (t.delay_h * SECONDS_PER_HOUR).round();
        costs "reward_penalties" |t, w| -w.delay_per_h * t.delay_h;
        /// For an hour beyond the end of the cycle. More than what slower driving saves, or a weak battery would pay.
        delay_per_h in 0.0 .. 1000000.0;
    /// 1 if the trip ended before arrival
    stranded ["-"]
        adds |s| f64::from(u8::from(s.end.is_some_and(|reason| reason != EndReason::Arrived)));
        costs "reward_penalties" |t, w| -w.stranded * t.stranded;
        /// For a trip that ends before arrival. More than any trip can cost, or giving up would pay.
        stranded in 0.0 .. 1000000.0;
}

/// Whether two texts are the same, while compiling.
const fn same(one: &str, other: &str) -> bool {
    let (one, other) = (one.as_bytes(), other.as_bytes());
    let mut place = 0;
    while place < one.len() && place < other.len() && one[place] == other[place] {
        place += 1;
    }
    place == one.len() && place == other.len()
}

/// Place of the first priced term of the same part.
const fn first_of_part(part: &str) -> usize {
    let mut place = 0;
    while !same(PRICED_PARTS[place], part) {
        place += 1;
    }
    place
}

/// Place of a part among the parts.
const fn place_of_part(part: &str) -> usize {
    let (mut place, mut distinct) = (0, 0);
    while place < first_of_part(part) {
        distinct += (first_of_part(PRICED_PARTS[place]) == place) as usize;
        place += 1;
    }
    distinct
}

const PARTS: usize = place_of_part(PRICED_PARTS[PRICED_PARTS.len() - 1]) + 1;

/// Names of the parts of a reward, in the order of the rows.
pub const PART_NAMES: [&str; PARTS] = {
    let mut names = [""; PARTS];
    let mut place = 0;
    while place < PRICED_PARTS.len() {
        names[place_of_part(PRICED_PARTS[place])] = PRICED_PARTS[place];
        place += 1;
    }
    names
};

/// Parts of a reward, in the order of [`PART_NAMES`].
pub type Parts = [f64; PARTS];

impl Terms {
    /// Chemical energy beyond that of the reference trip [kWh].
    #[must_use]
    pub fn attributable_energy_kwh(&self) -> f64 {
        self.chemical_energy_kwh - self.reference_energy_kwh
    }

    /// What a safe agent is held to, whatever the weights: kelvin hours of discomfort and of the battery outside its window,
    /// and 1 for each stop of the compressor that a protection forced and for a trip that ended before arrival.
    #[must_use]
    #[inline]
    pub fn cost(&self) -> f64 {
        self.discomfort_k_h + self.battery_window_k_h + self.protection_trips + self.stranded
    }
}

impl Second<'_> {
    fn degc(&self, node: hp_plant::numerics::thermal_network::Node) -> f64 {
        self.state.temperatures_k[node.index()] - ZERO_CELSIUS_K
    }

    fn cabin_degc(&self) -> f64 {
        self.degc(self.experiment.plant.layout().cabins[0].air)
    }

    fn outside_window_k(&self) -> f64 {
        let battery_degc = self.degc(self.experiment.plant.layout().battery);
        let (low, high) = (self.weights.battery_window_low_degc.0, self.weights.battery_window_high_degc.0);
        (low - battery_degc).max(0.0) + (battery_degc - high).max(0.0)
    }

    fn heat_left_j(&self) -> f64 {
        let Experiment { climate, plant, initial, .. } = self.experiment;
        let heating = climate.ambient_temperature_degc.0 < COMFORT_TEMPERATURE_DEGC;
        useful_heat_j(plant, &plant.parked(initial).temperatures_k, &self.state.temperatures_k, heating)
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
    pub fn start(experiment: &Experiment, state: &State) -> Self {
        Self {
            total: Terms::default(),
            reference: ReferenceTrip::start(experiment, state.battery),
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
        let mut reference_j = self.reference.step(experiment, conditions);
        if end == Some(EndReason::Arrived) && !self.reference.arrived(experiment) {
            reference_j += self.reference.finish(experiment, conditions);
        }
        let added = Terms::of(&Second {
            experiment,
            weights,
            before: self,
            state: &run.state,
            chemical_w: run.record.as_ref().map_or(0.0, |record| record.flows[Flow::CHEMICAL]),
            reference_j,
            occupied: disturbance.occupants > 0.0,
            late: run.steps > experiment.cycle.duration_s(),
            end,
        });
        self.trips = run.state.refrigeration.compressor.protection_trips;
        self.total += added;
        added
    }
}

/// Heat stored between two sets of temperatures that the next trip can use [J].
///
/// Cabin masses, coolant loops and stores, and the battery up to 20 degC. In a climate that calls for cooling, what is
/// useful in cabins, loops and stores is the heat that is gone.
fn useful_heat_j(plant: &Plant, start_k: &NodeValues, end_k: &NodeValues, heating: bool) -> f64 {
    let layout = plant.layout();
    let cabins = layout.cabins.iter().flat_map(|cabin| [cabin.air, cabin.exhaust, cabin.soft, cabin.hard]);
    let loops = layout.loops.iter().flat_map(|circuit| [circuit.supply, circuit.back]);
    let stores = layout.masses.iter().filter(|mass| layout.members[mass.member].kind == MemberKind::Store);
    let mut changed_k = *start_k;
    for node in cabins.chain(loops).chain(stores.map(|mass| mass.node)) {
        changed_k[node.index()] = end_k[node.index()];
    }
    let climate_j = plant.network.heat_gained_j(start_k, &changed_k);
    let battery = layout.battery.index();
    let (mut before_k, mut after_k) = (NodeValues::default(), NodeValues::default());
    before_k[battery] = start_k[battery].min(USEFUL_BATTERY.kelvin());
    after_k[battery] = end_k[battery].min(USEFUL_BATTERY.kelvin());
    let battery_j = plant.network.heat_gained_j(&before_k, &after_k);
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

    fn experiment() -> Experiment {
        Experiment::load("jeffs2019/case1-1", None, &[]).expect("built in")
    }

    fn warmed(nodes: &[usize], by_k: f64, start_degc: f64, heating: bool) -> f64 {
        let start = [start_degc + ZERO_CELSIUS_K; hp_plant::numerics::thermal_network::MAXIMUM_NODES];
        let mut end = start;
        for &node in nodes {
            end[node] += by_k;
        }
        useful_heat_j(&experiment().plant, &start, &end, heating)
    }

    #[test]
    fn parts_are_those_of_the_terms_in_order() {
        assert_eq!(
            PART_NAMES,
            ["reward_energy", "reward_discomfort", "reward_heat_left", "reward_penalties"]
        );
        let terms = Terms {
            stranded: 1.0,
            delay_h: 0.1,
            protection_trips: 2.0,
            chemical_energy_kwh: 3.0,
            ..Terms::default()
        };
        let weights: RewardParameters =
            hp_plant::config::library::load(crate::kinds::REWARD, "durable", &[]).expect("built in");
        let expected = -weights.protection_trip * 2.0 - weights.delay_per_h * 0.1 - weights.stranded;
        assert_eq!(terms.reward(&weights), [-weights.energy_per_kwh * 3.0, 0.0, 0.0, expected]);
        let names: Vec<&str> = terms.kpis(&weights).into_iter().map(|(name, _)| name).collect();
        assert_eq!(
            names,
            [
                "score",
                "attributable_energy_kwh",
                "chemical_energy_kwh",
                "reference_energy_kwh",
                "discomfort_k",
                "heat_left_kwh",
                "battery_window_k_h",
                "fog_k_h",
                "fog_s",
                "bad_air_ppm_h",
                "protection_trips",
                "delay_s"
            ]
        );
    }

    #[test]
    fn battery_heat_counts_up_to_20_degc_only() {
        let battery = experiment().plant.layout().battery.index();
        let to_20 = warmed(&[battery], 10.0, 10.0, true);
        assert!(to_20 > 0.0);
        assert_eq!(warmed(&[battery], 25.0, 10.0, true), to_20);
        assert_eq!(warmed(&[battery], 5.0, 20.0, true), 0.0);
    }

    #[test]
    fn cold_left_in_the_cabin_counts_where_cooling_is_called_for() {
        let cabin = experiment().plant.layout().cabins[0].air.index();
        assert!(warmed(&[cabin], -10.0, 35.0, false) > 0.0);
        assert!(warmed(&[cabin], -10.0, 35.0, true) < 0.0);
    }
}
