//! What rows do that the agent does not control: what the rule-based controller would ask of them.

use crate::action::FittedActions;
use hp_plant::architecture::declaration::Level;
use hp_plant::architecture::layout::{ExchangerSide, Layout};
use hp_plant::command::{Command, MAXIMUM_REQUEST_W, Purpose};
use hp_trip::controllers::rule_based::CabinMode;
use hp_trip::experiment::Experiment;

/// An option of a choice, found in a command as [`chosen`] finds it: here by the part of the range that it has.
///
/// [`chosen`]: crate::action::chosen
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ask {
    row: usize,
    /// Number of options.
    count: f64,
    /// Where the option begins and ends, counted in options; the first and the last take what lies outside the range too.
    from: f64,
    to: f64,
}

impl Ask {
    fn of(layout: &Layout, row: usize, option: usize) -> Self {
        let count = layout.actuators[row].options().len();
        let from = if option == 0 { f64::NEG_INFINITY } else { option as f64 };
        let to = if option + 1 >= count { f64::INFINITY } else { (option + 1) as f64 };
        Self { row, count: count as f64, from, to }
    }

    #[inline]
    fn is_in(self, command: &Command) -> bool {
        let place = 0.5 * (f64::from(command.0[self.row]) + 1.0) * self.count;
        (place >= self.from) & (place < self.to)
    }
}

/// Recirculation of a cabin, which follows what is asked for it.
#[derive(Debug, Clone, PartialEq)]
struct CabinDefaults {
    recirculation_row: usize,
    /// Any of these asks for air conditioning: the connection of its cooling core, valves of its evaporators.
    cooling: Vec<Ask>,
    heating_recirculation: f32,
    cooling_recirculation: f32,
}

/// A front-end exchanger's request, which is unlimited while heat is to be rejected.
#[derive(Debug, Clone, PartialEq)]
struct Rejection {
    rejects: Ask,
    request_row: usize,
    unlimited: f32,
}

/// What rows do that the agent does not control.
///
/// Flows, blower, set point and requested heat flows are those of scenario and controller. Two kinds of rows follow what
/// the agent asks for: while it asks to cool a cabin (cooling core connected, or a valve of one of its evaporators open), that
/// cabin's air is recirculated as in air conditioning, and with a front-end exchanger on a hot loop its request is unlimited.
#[derive(Debug, Clone, PartialEq)]
pub struct Defaults {
    command: Command,
    cabins: Vec<CabinDefaults>,
    rejections: Vec<Rejection>,
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
        let cabins = layout.cabins.iter().enumerate().map(|(place, cabin)| CabinDefaults {
            recirculation_row: cabin.recirculation_row,
            cooling: cooling(layout, place),
            heating_recirculation: ranges.normalise(cabin.recirculation_row, settings.heating_recirculation),
            cooling_recirculation: ranges.normalise(cabin.recirculation_row, settings.cooling_recirculation),
        });
        let rejections = roles.front_ends.iter().filter_map(|front_end| {
            Some(Rejection {
                rejects: Ask::of(layout, front_end.row, front_end.rejects?.option),
                request_row: front_end.request_row,
                unlimited: ranges.normalise(front_end.request_row, MAXIMUM_REQUEST_W),
            })
        });
        let requests =
            layout.actuators.iter().enumerate().filter(|(_, row)| matches!(row.purpose, Purpose::Request(_)));
        let changing = experiment.commander.requests_change();
        Self {
            command: ranges.encode(&demand),
            cabins: cabins.collect(),
            rejections: rejections.collect(),
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
        for cabin in &self.cabins {
            if !actions.selects(cabin.recirculation_row) {
                let cooling = cabin.cooling.iter().any(|ask| ask.is_in(command));
                let share = if cooling { cabin.cooling_recirculation } else { cabin.heating_recirculation };
                command.0[cabin.recirculation_row] = share;
            }
        }
        for rejection in &self.rejections {
            if !actions.selects(rejection.request_row) && rejection.rejects.is_in(command) {
                command.0[rejection.request_row] = rejection.unlimited;
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

    /// The command for options by name of the default actions; the first of those that are not named.
    fn completed(experiment: &Experiment, asked: &[(&str, usize)]) -> Command {
        let layout = experiment.plant.layout();
        let set = RowSet::of([layout]).expect("one vehicle");
        let table = ActionTable::new(&["default".to_owned()], &set, &BTreeMap::new()).expect("built in");
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
        let names: Vec<&str> = asks.iter().map(|ask| layout.actuators[ask.row].name.as_str()).collect();
        assert_eq!((names, asks[0].from), (vec!["cabin_evaporator"], 1.0));
    }
}
