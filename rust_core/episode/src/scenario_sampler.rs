//! Distributions of episodes: which trips an agent trains on and is tested on.

use crate::garage::{Garage, Trip};
use crate::kinds::EPISODES;
use crate::random::Random;
use hp_plant::architecture::declaration::MemberKind;
use hp_plant::architecture::layout::Layout;
use hp_plant::config::initial::MEMBER_RANGE_DEGC;
use hp_plant::config::library;
use hp_plant::config::{Celsius, Validate, Violation, check_range};
use hp_plant::error::{PlantError, PlantResult};
use hp_plant::media::moist_air;
use hp_plant::parameters;
use hp_trip::experiment::Experiment;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A distribution of episodes as its file gives it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DistributionParameters {
    /// What it is for, in a sentence.
    pub description: String,
    /// Scenario that gives vehicle, controller, strategy and heat requests.
    pub scenario: String,
    /// Drive cycles, all equally likely; one may be there more than once.
    pub cycles: Vec<SampledCycle>,
    /// Ranges of what is drawn.
    pub ranges: SampledRanges,
}

/// A drive cycle of a distribution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a table with `name`, and `least_battery_temperature_degc` if needed"
)]
pub struct SampledCycle {
    /// Name or path.
    pub name: String,
    /// A colder battery could not give what the cycle asks for: the car was plugged in, and its battery kept at
    /// least this warm [degC].
    pub least_battery_temperature_degc: Option<Celsius>,
}

parameters! {
    /// Ranges; what has a low and a high end is drawn evenly between them.
    pub struct SampledRanges {
        /// Share of trips that are a whole cycle [-].
        whole_cycle_share: f64 = 0.0 .. 1.0,
        /// The others run from one standstill of the cycle to another, at least this long [s].
        shortest_trip_s: u32 = 10 .. 100000,
        /// Coldest ambient [degC].
        ambient_low_degc: Celsius = -40.0 .. 50.0,
        /// Hottest ambient [degC].
        ambient_high_degc: Celsius = -40.0 .. 50.0,
        /// Share of trips that start in a garage and not at ambient temperature [-].
        garage_share: f64 = 0.0 .. 1.0,
        /// Coldest garage [degC].
        garage_low_degc: Celsius = -40.0 .. 50.0,
        /// Hottest garage [degC].
        garage_high_degc: Celsius = -40.0 .. 50.0,
        /// Share of trips without sun [-].
        dark_share: f64 = 0.0 .. 1.0,
        /// Highest solar heat into the cabin, in the hottest ambient [W].
        solar_high_w: f64 = 0.0 .. 3000.0,
        /// Heating of a cabin that was parked in the sun [K/W].
        parked_cabin_k_w: f64 = 0.0 .. 0.1,
        /// Lowest state of charge [%].
        charge_low_pct: f64 = 1.0 .. 100.0,
        /// Highest state of charge [%].
        charge_high_pct: f64 = 1.0 .. 100.0,
        /// Largest number of people.
        occupants_high: u32 = 1 .. 9,
        /// Share of trips for which the car was plugged in and its battery kept at a temperature or above [-].
        plugged_in_share: f64 = 0.0 .. 1.0,
        /// Coldest temperature that is kept [degC].
        plugged_in_low_degc: Celsius = -40.0 .. 50.0,
        /// Hottest temperature that is kept [degC].
        plugged_in_high_degc: Celsius = -40.0 .. 50.0,
        /// Lowest relative humidity of ambient air [-]; dry where the file does not say.
        #[serde(default)]
        relative_humidity_low: f64 = 0.0 .. 1.0,
        /// Highest relative humidity of ambient air [-].
        #[serde(default)]
        relative_humidity_high: f64 = 0.0 .. 1.0,
    }
}

impl Validate for DistributionParameters {
    fn validate(&self) -> Result<(), Violation> {
        if self.cycles.is_empty() {
            return Err(Violation::new("cycles", "empty", "must name at least one drive cycle"));
        }
        for (index, cycle) in self.cycles.iter().enumerate() {
            if let Some(least) = cycle.least_battery_temperature_degc {
                let key = format!("cycles[{index}].least_battery_temperature_degc");
                check_range(&key, least.0, -40.0, 50.0)?;
            }
        }
        let ranges = &self.ranges;
        ranges.validate().map_err(|violation| violation.within("ranges"))?;
        for (key, low, high) in [
            ("ranges.ambient_low_degc", ranges.ambient_low_degc.0, ranges.ambient_high_degc.0),
            ("ranges.garage_low_degc", ranges.garage_low_degc.0, ranges.garage_high_degc.0),
            ("ranges.plugged_in_low_degc", ranges.plugged_in_low_degc.0, ranges.plugged_in_high_degc.0),
            ("ranges.charge_low_pct", ranges.charge_low_pct, ranges.charge_high_pct),
            ("ranges.relative_humidity_low", ranges.relative_humidity_low, ranges.relative_humidity_high),
        ] {
            check_range(key, low, f64::NEG_INFINITY, high)?;
        }
        // The one thing that is drawn as a sum: all others are within what a scenario may say because their ranges are.
        let hottest_cabin_degc = ranges.ambient_high_degc.0
            + ranges.parked_cabin_k_w * season(ranges, ranges.ambient_high_degc.0) * ranges.solar_high_w;
        if hottest_cabin_degc > MEMBER_RANGE_DEGC.1 {
            let allowed = format!(
                "must not let a cabin parked in {} W of sun at {} degC start at {hottest_cabin_degc} degC: at most {} is allowed",
                ranges.solar_high_w, ranges.ambient_high_degc.0, MEMBER_RANGE_DEGC.1
            );
            return Err(Violation::new("ranges.parked_cabin_k_w", ranges.parked_cabin_k_w, allowed));
        }
        Ok(())
    }
}

/// A distribution ready to draw from.
#[derive(Debug, Clone)]
pub struct Distribution {
    name: String,
    parameters: DistributionParameters,
    origin: Arc<str>,
    vehicle: Option<Arc<str>>,
    cycles: Vec<Arc<str>>,
    template: Arc<Experiment>,
    standstills: Vec<Vec<usize>>,
}

/// Sun rises from none at this ambient temperature to its highest at the hottest ambient [degC] (assumed).
const SUNLESS_DEGC: f64 = -20.0;

/// Share of the highest solar heat that there can be at an ambient temperature [-].
fn season(ranges: &SampledRanges, ambient_degc: f64) -> f64 {
    let span_k = ranges.ambient_high_degc.0 - SUNLESS_DEGC;
    if span_k > 0.0 { ((ambient_degc - SUNLESS_DEGC) / span_k).clamp(0.0, 1.0) } else { 0.0 }
}

/// Dew point that summers hardly exceed: sultry air [degC] (assumed).
const HIGHEST_DEW_POINT: Celsius = Celsius(22.0);

/// Relative humidity of air of that dew point [-].
fn sultry(ambient_degc: f64) -> f64 {
    let ratio = moist_air::saturation_ratio(HIGHEST_DEW_POINT.kelvin());
    moist_air::relative_humidity(ratio, Celsius(ambient_degc).kelvin())
}

/// Name of the member that is the battery.
fn battery_name(layout: &Layout) -> &str {
    let battery = layout.members.iter().find(|member| member.kind == MemberKind::Battery);
    battery.map_or("battery", |member| member.name.as_str())
}

impl Distribution {
    /// Loads a distribution by name or path, with everything that its trips need; a vehicle replaces that of its scenario.
    ///
    /// # Errors
    /// Anything wrong in its file, or in the scenario and cycles that it names.
    pub fn load(name: &str, vehicle: Option<&str>, garage: &Garage) -> PlantResult<Self> {
        let parameters: DistributionParameters = library::load(EPISODES, name, &[])?;
        let named = |error: PlantError| error.named_by(name);
        let template = garage.experiment(&parameters.scenario, vehicle).map_err(named)?;
        let mut standstills = Vec::with_capacity(parameters.cycles.len());
        for cycle in &parameters.cycles {
            let speeds_m_s = garage.cycle(&cycle.name).map_err(named)?.speeds_m_s().to_vec();
            standstills.push((0..speeds_m_s.len()).filter(|&second| speeds_m_s[second] == 0.0).collect());
        }
        let origin = parameters.scenario.as_str().into();
        let cycles = parameters.cycles.iter().map(|cycle| cycle.name.as_str().into()).collect();
        Ok(Self {
            name: name.to_owned(),
            parameters,
            origin,
            vehicle: vehicle.map(Into::into),
            cycles,
            template,
            standstills,
        })
    }

    /// A trip that is like its trips in all that is not drawn.
    #[must_use]
    pub fn template(&self) -> &Arc<Experiment> {
        &self.template
    }

    /// Name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Draws a trip.
    pub fn draw(&self, random: &mut Random) -> Trip {
        let ranges = &self.parameters.ranges;
        let layout = self.template.plant.layout();
        let mut climate = self.template.climate.clone();
        let mut initial = self.template.initial.clone();
        let cycle = random.index(self.cycles.len());
        let window =
            if random.chance(ranges.whole_cycle_share) { None } else { self.draw_window(cycle, random) };

        let ambient_degc = random.between(ranges.ambient_low_degc.0, ranges.ambient_high_degc.0);
        let from_garage = random.chance(ranges.garage_share);
        let garage_degc = random.between(ranges.garage_low_degc.0, ranges.garage_high_degc.0);
        let soak_degc = if from_garage { garage_degc } else { ambient_degc };
        let dark = random.chance(ranges.dark_share);
        let sun_w = random.between(0.0, ranges.solar_high_w) * season(ranges, ambient_degc);
        climate.ambient_temperature_degc = Celsius(ambient_degc);
        climate.solar_gain_w = if dark { 0.0 } else { sun_w };
        climate.occupants = 1 + random.index(ranges.occupants_high as usize) as u32;
        initial.soak_temperature_degc = Celsius(soak_degc);
        initial.state_of_charge_pct = random.between(ranges.charge_low_pct, ranges.charge_high_pct);
        let parked_in_sun = !from_garage && !dark;
        let parked_degc = Celsius(soak_degc + ranges.parked_cabin_k_w * sun_w);
        for cabin in &layout.cabins {
            initial.set(&layout.members[cabin.member].name, parked_in_sun.then_some(parked_degc));
        }
        if let Some(kept_degc) = self.draw_kept_degc(cycle, random).filter(|&kept_degc| kept_degc > soak_degc)
        {
            initial.set(battery_name(layout), Some(Celsius(kept_degc)));
        }
        // Last, and drawn only where there is some, so that the trips of a file without humidity stay what they were.
        climate.relative_humidity = if ranges.relative_humidity_high > 0.0 {
            let drawn = random.between(ranges.relative_humidity_low, ranges.relative_humidity_high);
            drawn.min(sultry(ambient_degc))
        } else {
            0.0
        };
        Trip {
            origin: Arc::clone(&self.origin),
            vehicle: self.vehicle.clone(),
            cycle: Arc::clone(&self.cycles[cycle]),
            climate,
            initial,
            window,
        }
    }

    /// Temperature at or above which the battery was kept, if it was.
    fn draw_kept_degc(&self, cycle: usize, random: &mut Random) -> Option<f64> {
        let ranges = &self.parameters.ranges;
        let least_degc = self.parameters.cycles[cycle].least_battery_temperature_degc.map(|least| least.0);
        // Nothing is drawn where nothing depends on it.
        let plugged_in = ranges.plugged_in_share > 0.0 && random.chance(ranges.plugged_in_share);
        let chosen_degc =
            plugged_in.then(|| random.between(ranges.plugged_in_low_degc.0, ranges.plugged_in_high_degc.0));
        least_degc.into_iter().chain(chosen_degc).reduce(f64::max)
    }

    /// Part of a cycle between two standstills; none if the cycle has no such part.
    fn draw_window(&self, cycle: usize, random: &mut Random) -> Option<(usize, usize)> {
        let shortest = self.parameters.ranges.shortest_trip_s as usize;
        let stops = &self.standstills[cycle];
        let last_stop = *stops.last()?;
        let starts = stops.partition_point(|&second| second + shortest <= last_stop);
        if starts == 0 {
            return None;
        }
        let first = stops[random.index(starts)];
        let ends = &stops[stops.partition_point(|&second| second < first + shortest)..];
        Some((first, ends[random.index(ends.len())]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hp_trip::scenario::ScenarioParameters;

    fn drawn(name: &str) -> Vec<Trip> {
        let distribution = Distribution::load(name, None, &Garage::default()).expect("built in");
        let mut random = Random::seeded(3);
        (0..2000).map(|_| distribution.draw(&mut random)).collect()
    }

    #[test]
    fn every_drawn_scenario_passes_the_checks_of_a_scenario_file() {
        for name in ["train-v1", "test-v0"] {
            let garage = Garage::default();
            for trip in drawn(name) {
                let origin = garage.experiment(&trip.origin, None).expect("built in");
                let mut scenario = ScenarioParameters::clone(&origin.scenario);
                (scenario.climate, scenario.initial) = (trip.climate, trip.initial);
                scenario.validate().unwrap_or_else(|violation| panic!("{name}: {violation:?}"));
            }
        }
    }

    #[test]
    fn a_distribution_that_could_draw_what_no_scenario_may_say_is_refused() {
        let built_in = library::text(EPISODES, "train-v1").expect("built in");
        let told = |changes: &[(&str, f64)]| {
            let mut table = hp_plant::config::bounded::toml(&built_in).expect("built in");
            let ranges = table["ranges"].as_table_mut().expect("a section");
            for &(key, value) in changes {
                ranges.insert(key.to_owned(), value.into());
            }
            library::read::<DistributionParameters>("mine.toml", table).map_err(|error| error.to_string())
        };
        let hot = [("ambient_high_degc", 45.0), ("parked_cabin_k_w", 0.09), ("solar_high_w", 3000.0)];
        let message = told(&hot).expect_err("315 degC");
        assert!(
            message.contains("ranges.parked_cabin_k_w` is 0.09") && message.contains("315 degC"),
            "{message}"
        );
        assert!(
            told(&[("ambient_high_degc", 45.0), ("parked_cabin_k_w", 0.018), ("solar_high_w", 3000.0)])
                .is_ok()
        );
        // Where it is always too cold for the sun, there is none.
        let dark = told(&[("ambient_low_degc", -20.0), ("ambient_high_degc", -20.0)]).expect("cold");
        assert_eq!(season(&dark.ranges, -20.0), 0.0);
    }

    #[test]
    fn training_trips_differ_in_length_and_cover_cold_and_heat() {
        let trips = drawn("train-v1");
        let ambient = |trip: &Trip| trip.climate.ambient_temperature_degc.0;
        assert!(
            trips.iter().any(|trip| ambient(trip) < -19.0) && trips.iter().any(|trip| ambient(trip) > 39.0)
        );
        let garage = Garage::default();
        let mut lengths: Vec<usize> = trips
            .iter()
            .take(200)
            .map(|trip| garage.build(trip.clone()).expect("built in").cycle.duration_s())
            .collect();
        lengths.sort_unstable();
        lengths.dedup();
        assert!(lengths.len() > 50 && lengths[0] >= 300, "{} lengths from {} s", lengths.len(), lengths[0]);
    }

    #[test]
    fn trips_are_dry_or_as_humid_as_their_file_says_and_never_beyond_sultry() {
        assert!(drawn("train-v1").iter().all(|trip| trip.climate.relative_humidity == 0.0));
        let trips = drawn("train-v2");
        let humidity = |trip: &Trip| trip.climate.relative_humidity;
        assert!(trips.iter().all(|trip| humidity(trip) <= 0.95 && humidity(trip) > 0.1));
        assert!(trips.iter().any(|trip| humidity(trip) > 0.9));
        for trip in &trips {
            let ratio = trip.climate.humidity_ratio();
            assert!(moist_air::dew_point_k(ratio) <= HIGHEST_DEW_POINT.kelvin() + 1e-6, "{trip:?}");
        }
        // The same trips but for their humidity.
        let dry = drawn("train-v1");
        assert_eq!(dry[0].climate.ambient_temperature_degc, trips[0].climate.ambient_temperature_degc);
    }

    #[test]
    fn batteries_of_fast_cycles_are_warm_enough_and_some_others_were_kept_warm() {
        let trips = drawn("train-v1");
        let battery_degc =
            |trip: &Trip| trip.initial.of("battery").unwrap_or(trip.initial.soak_temperature_degc).0;
        let on = |name: &'static str| trips.iter().filter(move |trip| &*trip.cycle == name);
        assert!(on("wmtc-part3-twice").count() > 200 && on("artemis-urban").count() > 200);
        assert!(on("wmtc-part3-twice").all(|trip| battery_degc(trip) >= -5.0));
        assert!(on("artemis-urban").any(|trip| battery_degc(trip) < -19.0));
        let cold = on("artemis-urban").filter(|trip| trip.initial.soak_temperature_degc.0 < -10.0).count();
        let kept = on("artemis-urban")
            .filter(|trip| trip.initial.soak_temperature_degc.0 < -10.0 && battery_degc(trip) >= -10.0)
            .count();
        let share = kept as f64 / cold as f64;
        assert!((0.15..0.45).contains(&share), "{kept} of {cold}");
        // Keeping it warm never cools it.
        assert!(trips.iter().all(|trip| battery_degc(trip) >= trip.initial.soak_temperature_degc.0));
    }

    #[test]
    fn test_trips_use_no_training_cycle() {
        let cycles = |name: &str| {
            let mut cycles: Vec<Arc<str>> = drawn(name).into_iter().map(|trip| trip.cycle).collect();
            cycles.sort_unstable();
            cycles.dedup();
            cycles
        };
        let training = cycles("train-v1");
        assert!(cycles("test-v0").iter().all(|cycle| !training.contains(cycle)));
    }

    #[test]
    fn files_named_by_a_distribution_are_looked_for_beside_it() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let write = |name: &str, text: &str| {
            std::fs::write(folder.path().join(name), text).expect("written");
            folder.path().join(name).to_str().expect("plain name").to_owned()
        };
        let cycle = write("stop-and-go.csv", "time_s,speed_km_h\n0,0\n200,50\n400,0\n");
        let scenario = write("cold.toml", "base = \"jeffs2019/case1-1\"\ncycle = \"stop-and-go.csv\"\n");
        let built_in = library::text(EPISODES, "train-v1").expect("built in");
        let section = |head: &str| built_in.find(head).expect("a section");
        let ranges = &built_in[section("[ranges]")..section("[[cycles]]")];
        let head = "description = \"one cycle\"\nscenario = \"cold.toml\"\n\
                    cycles = [{ name = \"stop-and-go.csv\" }, { name = \"nedc\" }]\n";
        let episodes = write("mine.toml", &format!("{head}{ranges}"));
        let garage = Garage::default();
        let distribution = Distribution::load(&episodes, None, &garage).expect("beside it");
        let mut random = Random::seeded(5);
        let trips: Vec<Trip> = (0..50).map(|_| distribution.draw(&mut random)).collect();
        assert!(trips.iter().all(|trip| *trip.origin == *scenario));
        assert!(trips.iter().any(|trip| *trip.cycle == *cycle));
        assert!(trips.iter().any(|trip| &*trip.cycle == "nedc"));
        assert_eq!(garage.experiment(&scenario, None).expect("loaded").cycle.duration_s(), 400);
    }
}
