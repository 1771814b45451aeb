//! What an agent can do: selected rows of the actuator table, as levels or as continuous values.

use hp_plant::circuits::branches::{self, Branch};
use hp_plant::command::{
    ACTUATOR_COUNT, ACTUATORS, BLOWER, Command, Connection, MAXIMUM_REQUEST_W, Member, RECIRCULATION,
    REQUESTS, Scale,
};
use hp_plant::error::{PlantError, PlantResult};
use hp_plant::plant::{Disturbance, Plant};
use hp_plant::state::State;
use hp_trip::controllers::rule_based::CabinMode;
use hp_trip::experiment::Experiment;
use hp_trip::heat_demand_commander;

/// Rows that an agent controls by default: six connections, PTC, compressor.
pub const DEFAULT_ROWS: usize = 8;

/// Levels of a row that is not a choice; for the compressor the first of them is off.
pub const LEVELS: usize = 11;

/// Normalised compressor demand of the lowest level that runs.
const LOWEST_RUNNING: f64 = -0.9;

/// Selected rows of the actuator table.
#[derive(Debug, Clone, PartialEq)]
pub struct ActionTable {
    rows: Vec<usize>,
    selected: [bool; ACTUATOR_COUNT],
    option_counts: Vec<usize>,
    /// Normalised value of every option, row by row.
    values: Vec<[f32; LEVELS]>,
}

/// Number of options of a row.
#[must_use]
pub fn options(row: usize) -> usize {
    match ACTUATORS[row].scale {
        Scale::Choice(options) => options.len(),
        Scale::Linear | Scale::OffThenLogarithmic => LEVELS,
    }
}

/// Normalised value of an option of a row.
#[must_use]
pub fn option_value(row: usize, option: usize) -> f32 {
    let k = option as f64;
    let last = (LEVELS - 1) as f64;
    let value = match ACTUATORS[row].scale {
        Scale::Choice(options) => (2.0 * k + 1.0) / options.len() as f64 - 1.0,
        Scale::Linear => 2.0 * k / last - 1.0,
        Scale::OffThenLogarithmic if option == 0 => -1.0,
        Scale::OffThenLogarithmic => LOWEST_RUNNING + (1.0 - LOWEST_RUNNING) * (k - 1.0) / (last - 1.0),
    };
    value as f32
}

/// Option of a row that is nearest to a normalised value.
#[must_use]
pub fn nearest_option(row: usize, value: f32) -> usize {
    let x = f64::from(value);
    let last = (LEVELS - 1) as f64;
    let k = match ACTUATORS[row].scale {
        Scale::Choice(options) => (0.5 * (x + 1.0) * options.len() as f64).floor(),
        Scale::Linear => (0.5 * (x + 1.0) * last).round(),
        Scale::OffThenLogarithmic if x < LOWEST_RUNNING - 1e-6 => 0.0,
        Scale::OffThenLogarithmic => {
            1.0 + ((x - LOWEST_RUNNING) / (1.0 - LOWEST_RUNNING) * (last - 1.0)).round().max(0.0)
        }
    };
    (k.max(0.0) as usize).min(options(row) - 1)
}

impl ActionTable {
    /// Rows by name.
    ///
    /// # Errors
    /// An unknown name, one given twice, or none at all.
    pub fn new(names: &[String]) -> PlantResult<Self> {
        let mut table = Self {
            rows: Vec::with_capacity(names.len()),
            selected: [false; ACTUATOR_COUNT],
            option_counts: Vec::new(),
            values: Vec::new(),
        };
        for name in names {
            let row = ACTUATORS.iter().position(|actuator| actuator.name == name).ok_or_else(|| {
                let available = ACTUATORS.map(|actuator| actuator.name).join(", ");
                PlantError::Unknown { kind: "action", name: name.clone(), available }
            })?;
            if std::mem::replace(&mut table.selected[row], true) {
                return Err(PlantError::InvalidArgument {
                    what: "actions".into(),
                    value: format!("a list with `{name}` twice"),
                    allowed: "must name each action once".into(),
                });
            }
            table.rows.push(row);
            table.option_counts.push(options(row));
            table.values.push(std::array::from_fn(|option| option_value(row, option)));
        }
        if table.rows.is_empty() {
            return Err(PlantError::InvalidArgument {
                what: "actions".into(),
                value: "empty".into(),
                allowed: "must name at least one action".into(),
            });
        }
        Ok(table)
    }

    /// Selected rows in the order of an action.
    #[must_use]
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Normalised value of an option of the row in a column of an action.
    #[must_use]
    pub fn value(&self, column: usize, option: usize) -> f32 {
        self.values[column][option]
    }

    /// Whether a row is selected.
    #[must_use]
    pub fn selects(&self, row: usize) -> bool {
        self.selected[row]
    }

    /// Number of options of each selected row.
    #[must_use]
    pub fn option_counts(&self) -> &[usize] {
        &self.option_counts
    }

    /// Length of the mask: all options of all selected rows.
    #[must_use]
    pub fn mask_length(&self) -> usize {
        self.option_counts.iter().sum()
    }

    /// Which options the plant would grant in the coming second, row by row.
    ///
    /// The cabin's air inlet depends on recirculation: where an agent controls that or the blower, a connection counts as
    /// granted if some recirculated share makes it so.
    pub fn write_mask(
        &self,
        plant: &Plant,
        state: &State,
        disturbance: &Disturbance,
        defaults: &Defaults,
        mask: &mut [bool],
    ) {
        let mut place = 0;
        for &row in &self.rows {
            for option in 0..options(row) {
                mask[place] = match Member::ALL.get(row) {
                    Some(&member) => self.granted(plant, state, disturbance, defaults, member, option),
                    None => true,
                };
                place += 1;
            }
        }
    }

    fn granted(
        &self,
        plant: &Plant,
        state: &State,
        disturbance: &Disturbance,
        defaults: &Defaults,
        member: Member,
        option: usize,
    ) -> bool {
        let Some(branch) = Branch::of(member, member.options()[option]) else { return true };
        let at = |recirculation: f64| {
            let temperatures = plant.branch_temperatures(state, recirculation, disturbance.air.temperature_k);
            branches::allowed(&plant.vehicle, &temperatures, &state.connected)[branch as usize]
        };
        if member != Member::Cabin {
            return at(0.0);
        }
        // Some of it may be held back for the sake of fresh air.
        let effective = |blower: f32, recirculation: f32| {
            let (level, share) =
                (plant.ranges.physical(BLOWER, blower), plant.ranges.physical(RECIRCULATION, recirculation));
            plant.vehicle.cabin.ventilation(level, share, disturbance.occupants).recirculation
        };
        if self.selects(RECIRCULATION) || self.selects(BLOWER) {
            at(0.0) || at(effective(1.0, 1.0))
        } else {
            at(effective(defaults.command.0[BLOWER], defaults.recirculation(branch == Branch::CabinChiller)))
        }
    }
}

/// What rows do that the agent does not control: what the rule-based controller would ask of them.
///
/// Flows, blower, set point and requested heat flows are those of scenario and controller. Two rows follow what
/// the agent asks for: with the cabin on the chiller loop air is recirculated as in air conditioning, and with
/// the front-end exchanger on the HTC its request is unlimited.
#[derive(Debug, Clone, PartialEq)]
pub struct Defaults {
    command: Command,
    heating_recirculation: f32,
    cooling_recirculation: f32,
    unlimited_request: f32,
    requests_change: bool,
}

/// Row of the front-end exchanger's request.
const AMBIENT_REQUEST: usize = REQUESTS + Member::Ambient as usize;

impl Defaults {
    /// Defaults of a scenario.
    #[must_use]
    pub fn of(experiment: &Experiment) -> Self {
        let ranges = &experiment.plant.ranges;
        let settings = experiment.rules.constant_settings();
        let requests_w = heat_demand_commander::requests_w(&experiment.scenario.heat_demand, 0.0);
        let demand = settings.demand(CabinMode::Heating, &requests_w);
        Self {
            command: ranges.encode(&demand),
            heating_recirculation: ranges.normalise(RECIRCULATION, settings.heating_recirculation),
            cooling_recirculation: ranges.normalise(RECIRCULATION, settings.cooling_recirculation),
            unlimited_request: ranges.normalise(AMBIENT_REQUEST, MAXIMUM_REQUEST_W),
            requests_change: !experiment.scenario.heat_demand.schedule.is_empty(),
        }
    }

    /// Normalised recirculated share while the cabin is on the chiller loop or not.
    #[must_use]
    pub fn recirculation(&self, cooling: bool) -> f32 {
        if cooling { self.cooling_recirculation } else { self.heating_recirculation }
    }

    /// The whole command for values of the selected rows.
    #[must_use]
    pub fn complete(
        &self,
        table: &ActionTable,
        values: &[f32],
        experiment: &Experiment,
        time_s: f64,
    ) -> Command {
        let mut command = self.command;
        if self.requests_change {
            let ranges = &experiment.plant.ranges;
            let requests_w = heat_demand_commander::requests_w(&experiment.scenario.heat_demand, time_s);
            for (i, request_w) in requests_w.into_iter().enumerate() {
                command.0[REQUESTS + i] = ranges.normalise(REQUESTS + i, request_w);
            }
        }
        for (&row, &value) in table.rows.iter().zip(values) {
            command.0[row] = value;
        }
        if !table.selects(RECIRCULATION) {
            let cooling = asked(&command, Member::Cabin) == Connection::Chiller;
            command.0[RECIRCULATION] = self.recirculation(cooling);
        }
        if !table.selects(AMBIENT_REQUEST) && asked(&command, Member::Ambient) == Connection::Htc {
            command.0[AMBIENT_REQUEST] = self.unlimited_request;
        }
        command
    }
}

/// Connection that a command asks for, as [`ActuatorRanges::physical`] reads it.
///
/// [`ActuatorRanges::physical`]: hp_plant::command::ActuatorRanges::physical
#[must_use]
pub fn asked(command: &Command, member: Member) -> Connection {
    let options = member.options();
    let share = 0.5 * (f64::from(command.0[member as usize]) + 1.0);
    // The conversion rounds towards zero and holds what is below at zero.
    options[((share * options.len() as f64) as usize).min(options.len() - 1)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use hp_plant::command::COMPRESSOR;

    #[test]
    fn every_option_is_the_nearest_to_its_own_value() {
        for (row, actuator) in ACTUATORS.iter().enumerate() {
            for option in 0..options(row) {
                assert_eq!(nearest_option(row, option_value(row, option)), option, "{}", actuator.name);
            }
        }
    }

    #[test]
    fn compressor_levels_are_off_and_ten_evenly_in_the_logarithm() {
        let experiment = Experiment::load("jeffs2019/case1-1", None, &[]).expect("built in");
        let ranges = &experiment.plant.ranges;
        let powers: Vec<f64> =
            (0..LEVELS).map(|k| ranges.physical(COMPRESSOR, option_value(COMPRESSOR, k))).collect();
        let (low, high) = ranges.range(COMPRESSOR);
        assert_eq!(powers[0], 0.0);
        assert!((powers[1] / low - 1.0).abs() < 1e-5 && (powers[10] / high - 1.0).abs() < 1e-5);
        let ratio = (high / low).powf(1.0 / 9.0);
        for pair in powers[1..].windows(2) {
            assert!((pair[1] / pair[0] / ratio - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn connections_asked_for_are_those_that_the_plant_reads() {
        let experiment = Experiment::load("jeffs2019/case1-1", None, &[]).expect("built in");
        let mut command = Command([0.0; ACTUATOR_COUNT]);
        for value in (-1000..=1000).map(|thousandth| thousandth as f32 / 1000.0) {
            command.0.fill(value);
            let demand = experiment.plant.ranges.decode(&command);
            for member in Member::ALL {
                assert_eq!(asked(&command, member), demand.connections[member as usize], "{value}");
            }
        }
    }

    #[test]
    fn unknown_doubled_and_no_actions_are_refused() {
        let table = |names: &[&str]| {
            ActionTable::new(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>())
                .expect_err("must be refused")
                .to_string()
        };
        assert!(table(&["heater"]).contains("unknown action `heater`; available: battery, motor"));
        assert!(table(&["ptc", "ptc"]).contains("`ptc` twice"));
        assert!(table(&[]).contains("at least one"));
    }
}
