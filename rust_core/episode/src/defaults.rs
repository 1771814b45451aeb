//! What rows do that the agent does not control: what the rule-based controller would ask of them.

use crate::action::{FittedActions, effective_recirculation};
use hp_plant::architecture::declaration::Level;
use hp_plant::architecture::layout::{
    CABIN_PLACES, EXCHANGER_PLACES, ExchangerSide, FRONT_END_PLACES, Layout,
};
use hp_plant::command::{Command, MAXIMUM_REQUEST_W, Purpose};
use hp_trip::controllers::rule_based::CabinMode;
use hp_trip::experiment::Experiment;

/// An option of a choice, found in a command as [`chosen`] finds it.
///
/// [`chosen`]: crate::action::chosen
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Ask {
    row: u8,
    /// Number of the last option.
    last: u8,
    option: u8,
}

impl Ask {
    fn of(layout: &Layout, row: usize, option: usize) -> Self {
        let last = layout.actuators[row].options().len() - 1;
        Self { row: row as u8, last: last as u8, option: option as u8 }
    }

    #[inline]
    fn is_in(self, command: &Command) -> bool {
        let last = f64::from(self.last);
        let place = 0.5 * (f64::from(command.0[usize::from(self.row)]) + 1.0) * (last + 1.0);
        place.floor().max(0.0).min(last) == f64::from(self.option)
    }
}

/// Most options that ask for air conditioning: the cooling core of each cabin, and evaporators.
const ASKS: usize = CABIN_PLACES + EXCHANGER_PLACES;

/// Recirculation and blower of a cabin, which follow what is asked for it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct CabinDefaults {
    recirculation_row: u8,
    blower_row: u8,
    /// Its first option among those that ask for air conditioning, and how many there are: the connection of its cooling core,
    /// valves of its evaporators.
    first: u8,
    count: u8,
    heating_recirculation: f32,
    cooling_recirculation: f32,
    heating_blower: f32,
    cooling_blower: f32,
    /// What of them is recirculated with the occupants that a trip has, while it is heated and cooled.
    effective: [f64; 2],
}

/// A front-end exchanger's request, which is unlimited while heat is to be rejected.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Rejection {
    rejects: Ask,
    request_row: u8,
    unlimited: f32,
}

/// What rows do that the agent does not control.
///
/// Flows, blower, set point and requested heat flows are those of scenario and controller. Two kinds of rows follow what
/// the agent asks for: while it asks to cool a cabin (cooling core connected, or a valve of one of its evaporators open), that
/// cabin's air is recirculated and blown as in air conditioning, and with a front-end exchanger on a hot loop its request is unlimited.
/// All of it but requests of schedules stands in place: to follow pointers took longer than the rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Defaults {
    command: Command,
    cabins: [CabinDefaults; CABIN_PLACES],
    cabin_count: u8,
    rejections: [Rejection; FRONT_END_PLACES],
    rejection_count: u8,
    asks: [Ask; ASKS],
    /// Rows of requests, where a schedule changes them.
    requests: Vec<usize>,
}

impl Defaults {
    /// Defaults of a scenario.
    #[must_use]
    pub fn of(experiment: &Experiment) -> Self {
        let (ranges, layout) = (&experiment.plant.ranges, experiment.plant.layout());
        let (settings, roles) = (experiment.rules.constant_settings(), experiment.rules.roles());
        let mut demand = experiment.commander.requested(0.0);
        settings.enter(CabinMode::Heating, roles, &mut demand);
        let command = ranges.encode(&demand);
        let (mut asks, mut asked) = ([Ask::default(); ASKS], 0);
        let mut cabins = [CabinDefaults::default(); CABIN_PLACES];
        for (place, cabin) in layout.cabins.iter().enumerate() {
            let own = cooling(layout, place);
            asks[asked..asked + own.len()].copy_from_slice(&own);
            let normalised = |share: f64| ranges.normalise(cabin.recirculation_row, share);
            let blower = |mode: CabinMode| ranges.normalise(cabin.blower_row, settings.blower_level(mode));
            let share_in = |mode: CabinMode| {
                let occupants = experiment.disturbance(0).occupants;
                let share = normalised(settings.recirculation(mode));
                effective_recirculation(&experiment.plant, occupants, place, blower(mode), share)
            };
            cabins[place] = CabinDefaults {
                recirculation_row: cabin.recirculation_row as u8,
                blower_row: cabin.blower_row as u8,
                first: asked as u8,
                count: own.len() as u8,
                heating_recirculation: normalised(settings.heating_recirculation),
                cooling_recirculation: normalised(settings.cooling_recirculation),
                heating_blower: blower(CabinMode::Heating),
                cooling_blower: blower(CabinMode::Cooling),
                effective: [CabinMode::Heating, CabinMode::Cooling].map(share_in),
            };
            asked += own.len();
        }
        let mut rejections = [Rejection::default(); FRONT_END_PLACES];
        let mut rejection_count = 0;
        for front_end in &roles.front_ends {
            let Some(rejects) = front_end.rejects else { continue };
            rejections[rejection_count] = Rejection {
                rejects: Ask::of(layout, front_end.row, rejects.option),
                request_row: front_end.request_row as u8,
                unlimited: ranges.normalise(front_end.request_row, MAXIMUM_REQUEST_W),
            };
            rejection_count += 1;
        }
        let requests =
            layout.actuators.iter().enumerate().filter(|(_, row)| matches!(row.purpose, Purpose::Request(_)));
        let changing = experiment.commander.requests_change();
        Self {
            command,
            cabins,
            cabin_count: layout.cabins.len() as u8,
            rejections,
            rejection_count: rejection_count as u8,
            asks,
            requests: requests.map(|(row, _)| row).filter(|_| changing).collect(),
        }
    }

    /// What is asked of rows that nobody controls.
    #[must_use]
    pub fn command(&self) -> &Command {
        &self.command
    }

    /// Normalised recirculated share of a cabin while it is cooled or not.
    #[must_use]
    pub fn recirculation(&self, cabin: usize, cooling: bool) -> f32 {
        let cabin = &self.cabins[cabin];
        if cooling { cabin.cooling_recirculation } else { cabin.heating_recirculation }
    }

    /// Normalised blower level of a cabin while it is cooled or not.
    #[must_use]
    pub fn blower(&self, cabin: usize, cooling: bool) -> f32 {
        let cabin = &self.cabins[cabin];
        if cooling { cabin.cooling_blower } else { cabin.heating_blower }
    }

    /// Share of a cabin's air that is recirculated while it is cooled or not, fresh air for its occupants held back.
    #[must_use]
    #[inline]
    pub fn effective_recirculation(&self, cabin: usize, cooling: bool) -> f64 {
        self.cabins[cabin].effective[usize::from(cooling)]
    }

    /// The whole command for values of the selected rows.
    #[must_use]
    pub fn complete(
        &self,
        actions: &FittedActions,
        values: &[f32],
        experiment: &Experiment,
        time_s: f64,
    ) -> Command {
        let mut command = Command::default();
        self.complete_into(actions, values, experiment, time_s, &mut command);
        command
    }

    /// [`Self::complete`] that writes the command to where it is kept.
    pub fn complete_into(
        &self,
        actions: &FittedActions,
        values: &[f32],
        experiment: &Experiment,
        time_s: f64,
        command: &mut Command,
    ) {
        *command = self.command;
        if !self.requests.is_empty() {
            let requested = experiment.commander.requested(time_s);
            for &row in &self.requests {
                command.0[row] = experiment.plant.ranges.normalise(row, requested[row]);
            }
        }
        actions.enter(values, command);
        for cabin in self.cabins.iter().take(usize::from(self.cabin_count)) {
            let (row, blower_row) = (usize::from(cabin.recirculation_row), usize::from(cabin.blower_row));
            if actions.selects(row) && actions.selects(blower_row) {
                continue;
            }
            let own = self.asks.iter().skip(usize::from(cabin.first)).take(usize::from(cabin.count));
            let cooling = own.fold(false, |cooling, ask| cooling | ask.is_in(command));
            if !actions.selects(row) {
                command.0[row] =
                    if cooling { cabin.cooling_recirculation } else { cabin.heating_recirculation };
            }
            if !actions.selects(blower_row) {
                command.0[blower_row] = if cooling { cabin.cooling_blower } else { cabin.heating_blower };
            }
        }
        for rejection in self.rejections.iter().take(usize::from(self.rejection_count)) {
            let row = usize::from(rejection.request_row);
            if !actions.selects(row) && rejection.rejects.is_in(command) {
                command.0[row] = rejection.unlimited;
            }
        }
    }
}

/// What asks for air conditioning of a cabin.
fn cooling(layout: &Layout, cabin: usize) -> Vec<Ask> {
    let rows = &layout.cabins[cabin];
    let core = rows.cooler.and_then(|branch| {
        let row = layout.members[rows.member].connection_row?;
        Some(Ask::of(layout, row, layout.branches[branch].option))
    });
    let evaporators = layout
        .exchangers
        .iter()
        .filter(|exchanger| {
            exchanger.level == Level::Evaporating && exchanger.side == ExchangerSide::Cabin(cabin)
        })
        .filter_map(|exchanger| Some(Ask::of(layout, exchanger.valve_row?, 1)));
    core.into_iter().chain(evaporators).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::action::{ActionTable, chosen};
    use crate::rows::RowSet;
    use std::collections::BTreeMap;

    /// The command for options by name of the actions that move heat; the first of those that are not named.
    fn completed(experiment: &Experiment, asked: &[(&str, usize)]) -> Command {
        let layout = experiment.plant.layout();
        let set = RowSet::of([layout]).expect("one vehicle");
        let table = ActionTable::new(&["heat".to_owned()], &set, &BTreeMap::new()).expect("built in");
        let option = |name: &str| asked.iter().find(|(row, _)| *row == name).map_or(0, |&(_, option)| option);
        let rows = table.rows().iter().enumerate();
        let values: Vec<f32> = rows.map(|(column, row)| table.value(column, option(&row.name))).collect();
        Defaults::of(experiment).complete(&FittedActions::of(&table, layout), &values, experiment, 0.0)
    }

    #[test]
    fn air_is_recirculated_as_asked_and_rejection_is_unlimited() {
        let experiment = Experiment::load("ours/hot-soak-plus35", None, &[]).expect("built in");
        let ranges = &experiment.plant.ranges;
        let settings = experiment.rules.constant_settings();
        let at = |command: &Command, name: &str| {
            let row = ranges.row(name).expect("there");
            ranges.physical(row, command.0[row])
        };
        let heating = completed(&experiment, &[("cabin", 1), ("ambient", 1)]);
        let cooling = completed(&experiment, &[("cabin", 2), ("ambient", 2)]);
        assert!((at(&heating, "recirculation") - settings.heating_recirculation).abs() < 1e-6);
        assert!((at(&cooling, "recirculation") - settings.cooling_recirculation).abs() < 1e-6);
        assert_eq!(at(&cooling, "ambient_request"), MAXIMUM_REQUEST_W);
    }

    #[test]
    fn an_option_is_found_where_the_plant_finds_it() {
        let layout = hp_plant::config::vehicle::architecture("jeffs2019").expect("built in");
        let row = layout.actuator("ambient").expect("there");
        let count = layout.actuators[row].options().len();
        let mut command = Command::default();
        for step in -150..=150 {
            command.0[row] = step as f32 / 120.0;
            let found: Vec<usize> =
                (0..count).filter(|&option| Ask::of(&layout, row, option).is_in(&command)).collect();
            assert_eq!(found, [chosen(count, command.0[row])], "{}", command.0[row]);
        }
    }

    #[test]
    fn a_cabin_without_connection_is_cooled_by_the_valve_of_its_evaporator() {
        let layout = hp_plant::config::vehicle::architecture("direct").expect("built in");
        let asks = cooling(&layout, 0);
        let names: Vec<&str> =
            asks.iter().map(|ask| layout.actuators[usize::from(ask.row)].name.as_str()).collect();
        assert_eq!((names, asks[0].option), (vec!["cabin_evaporator"], 1));
    }
}
