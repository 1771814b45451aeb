//! What an agent can see: rows with bounds, scaled to `[-1, 1]`, and where they are read in one vehicle.

use crate::action::{ActionTable, FittedActions};
use crate::rows::{RowSet, branch_name, unknown};
use hp_plant::architecture::layout::BRANCH_PLACES;
use hp_plant::command::Command;
use hp_plant::config::ZERO_CELSIUS_K;
use hp_plant::error::{PlantError, PlantResult};
use hp_plant::flows::Flow;
use hp_plant::numerics::thermal_network::Node;
use hp_plant::plant::Plant;
use hp_plant::signals::{Reader, View};
use hp_trip::experiment::Experiment;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A row of an observation.
#[derive(Debug, Clone, PartialEq)]
pub struct Observed {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// Value that is shown as -1.
    pub low: f64,
    /// Value that is shown as 1.
    pub high: f64,
    /// Meaning.
    pub description: String,
    /// Seen by default.
    pub default: bool,
    source: Source,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Source {
    Signal,
    Solar,
    Occupants,
    Branch,
    /// Column of an action.
    Asked(usize),
    SpeedAhead(usize),
    TimeLeft,
    Behind,
}

/// Group of the rows seen by default, those of the previous action included.
pub const DEFAULT_GROUP: &str = "default";

/// Group of the rows that show the cycle ahead.
pub const PREVIEW_GROUP: &str = "preview";

/// How far ahead the preview looks [s].
const PREVIEW_S: [usize; 6] = [2, 5, 10, 20, 40, 80];

/// Longest time left that is told apart [s].
const LONGEST_TIME_LEFT_S: f64 = 7200.0;

/// Largest distance behind the cycle that is told apart [m].
const FURTHEST_BEHIND_M: f64 = 2000.0;

fn row(name: impl Into<String>, unit: &'static str, bounds: (f64, f64), source: Source) -> Observed {
    let name = name.into();
    Observed { name, unit, low: bounds.0, high: bounds.1, description: String::new(), default: true, source }
}

impl Observed {
    fn meaning(mut self, description: impl Into<String>) -> Self {
        self.description = description.into();
        self
    }

    fn hidden(mut self) -> Self {
        self.default = false;
        self
    }

    /// Blurred by sensor noise.
    fn measured(&self) -> bool {
        matches!(self.source, Source::Signal | Source::Solar)
    }
}

/// What a row is read from.
#[derive(Debug, Clone, Copy)]
pub struct Look<'a> {
    /// Vehicle, state, last step, surroundings.
    pub view: View<'a>,
    /// Trip.
    pub experiment: &'a Experiment,
    /// Last command.
    pub asked: &'a Command,
    /// Seconds driven.
    pub steps: usize,
    /// Distance that the vehicle is behind its cycle [m].
    pub behind_m: f64,
}

/// Every row there is, for an agent with these actions: signals that are seen by default in their order, surroundings,
/// granted connections, the previous action, then what is not seen by default.
#[must_use]
pub fn all(set: &RowSet, actions: &ActionTable) -> Vec<Observed> {
    let mut rows = Vec::with_capacity(160);
    let signal = |row_of: &crate::rows::SignalRow| {
        row(row_of.name.clone(), row_of.unit, row_of.bounds, Source::Signal)
            .meaning(row_of.description.clone())
    };
    let mut seen: Vec<_> = set.signals.iter().filter(|signal| signal.default.is_some()).collect();
    // The same rank stays in column order.
    seen.sort_by_key(|signal| signal.default);
    rows.extend(seen.into_iter().map(signal));
    rows.push(row("solar_gain_w", "W", (0.0, 1500.0), Source::Solar).meaning("solar heat into the cabin"));
    rows.push(row("occupants", "-", (0.0, 5.0), Source::Occupants).meaning("people in the cabin"));
    for name in &set.branches {
        rows.push(row(name.clone(), "-", (0.0, 1.0), Source::Branch).meaning("1 while the plant grants it"));
    }
    for (column, action) in actions.rows().iter().enumerate() {
        let name = format!("previous_{}", action.name);
        let meaning = "what was asked last, normalised";
        rows.push(row(name, "-", (-1.0, 1.0), Source::Asked(column)).meaning(meaning));
    }
    for seconds in PREVIEW_S {
        let preview = row(format!("speed_in_{seconds}_s"), "m/s", (0.0, 50.0), Source::SpeedAhead(seconds));
        rows.push(preview.meaning("speed on the cycle ahead").hidden());
    }
    let left = row("time_left_s", "s", (0.0, LONGEST_TIME_LEFT_S), Source::TimeLeft);
    rows.push(left.meaning("time to the end of the cycle").hidden());
    let behind = row("distance_behind_m", "m", (0.0, FURTHEST_BEHIND_M), Source::Behind);
    rows.push(behind.meaning("distance that the vehicle is behind its cycle").hidden());
    rows.extend(set.signals.iter().filter(|row| row.default.is_none()).map(|row| signal(row).hidden()));
    rows
}

/// Selected rows, shared by all vehicles of an environment.
#[derive(Debug, Clone)]
pub struct ObservationTable {
    rows: Vec<Observed>,
    /// What is shown as -1.
    lows: Vec<f64>,
    /// How much of the scale a unit takes.
    gains: Vec<f64>,
}

/// As many rows as nearly all observations have: less to set to zero each second.
const USUAL_ROWS: usize = 64;

/// As many as one vehicle has, all told.
const MANY_ROWS: usize = 256;

fn refused(value: impl Into<String>, allowed: &str) -> PlantError {
    PlantError::InvalidArgument { what: "observations".into(), value: value.into(), allowed: allowed.into() }
}

fn replace_bounds(rows: &mut [Observed], name: &str, low: f64, high: f64) -> PlantResult<()> {
    let Some(place) = rows.iter().position(|row| row.name == name) else {
        let names: Vec<&str> = rows.iter().map(|row| row.name.as_str()).collect();
        return Err(unknown("observation", name, &names));
    };
    if !(low.is_finite() && high.is_finite() && low < high && (high - low).is_finite()) {
        return Err(PlantError::InvalidArgument {
            what: format!("observation_bounds of `{name}`"),
            value: format!("({low}, {high})"),
            allowed: "must be two finite numbers, the lower first".into(),
        });
    }
    (rows[place].low, rows[place].high) = (low, high);
    Ok(())
}

impl ObservationTable {
    /// Rows by name out of those that there are; a group stands for its rows. `bounds` replaces those of rows by name.
    ///
    /// # Errors
    /// An unknown name, a row given twice, or none at all; bounds of a row that is not selected, or that are none.
    pub fn new(
        names: &[String],
        set: &RowSet,
        actions: &ActionTable,
        bounds: &BTreeMap<String, (f64, f64)>,
    ) -> PlantResult<Self> {
        let all = all(set, actions);
        let mut rows: Vec<Observed> = Vec::new();
        for name in names {
            let selected: Vec<&Observed> = all
                .iter()
                .filter(|row| match name.as_str() {
                    DEFAULT_GROUP => row.default,
                    PREVIEW_GROUP => matches!(row.source, Source::SpeedAhead(_)),
                    _ => row.name == *name,
                })
                .collect();
            if selected.is_empty() {
                let names: Vec<&str> = all.iter().map(|row| row.name.as_str()).collect();
                return Err(unknown(
                    "observation",
                    name,
                    &[&[DEFAULT_GROUP, PREVIEW_GROUP], &names[..]].concat(),
                ));
            }
            for row in selected {
                if rows.iter().any(|other| other.name == row.name) {
                    let value = format!("a list with `{}` twice", row.name);
                    return Err(refused(value, "must name each row once"));
                }
                rows.push(row.clone());
            }
        }
        if rows.is_empty() {
            return Err(refused("empty", "must name at least one row"));
        }
        for (name, &(low, high)) in bounds {
            replace_bounds(&mut rows, name, low, high)?;
        }
        let lows = rows.iter().map(|row| row.low).collect();
        let gains = rows.iter().map(|row| 2.0 / (row.high - row.low)).collect();
        Ok(Self { rows, lows, gains })
    }

    /// Rows in the order of an observation.
    #[must_use]
    pub fn rows(&self) -> &[Observed] {
        &self.rows
    }

    /// Writes an observation and counts what was beyond the bounds; `blur`, where there is noise, gives that of each
    /// measured row.
    pub fn write(
        &self,
        fitted: &FittedObservations,
        look: &Look<'_>,
        blur: Option<impl FnMut() -> f64>,
        values: &mut [f32],
        clipped: &mut Clipped,
    ) {
        match self.rows.len() {
            count if count <= USUAL_ROWS => {
                self.write_through(fitted, look, blur, &mut [0.0; USUAL_ROWS], values, clipped)
            }
            count if count <= MANY_ROWS => {
                self.write_through(fitted, look, blur, &mut [0.0; MANY_ROWS], values, clipped)
            }
            count => {
                let mut zeros = vec![0.0; count.next_power_of_two()];
                self.write_through(fitted, look, blur, &mut zeros, values, clipped)
            }
        }
    }

    /// Through numbers in the rows' own units; there is room for a power of two, see [`enter`].
    #[inline(always)]
    fn write_through(
        &self,
        fitted: &FittedObservations,
        look: &Look<'_>,
        blur: Option<impl FnMut() -> f64>,
        zeros: &mut [f64],
        values: &mut [f32],
        clipped: &mut Clipped,
    ) {
        fitted.read(look, zeros);
        let numbers = &mut zeros[..self.rows.len()];
        if let Some(mut blur) = blur {
            // In units of half the range.
            for ((&measured, number), gain) in fitted.measured.iter().zip(numbers.iter_mut()).zip(&self.gains)
            {
                *number += if measured { blur() / gain } else { 0.0 };
            }
        }
        let mut beyond = false;
        for (((value, number), low), gain) in
            values.iter_mut().zip(&mut *numbers).zip(&self.lows).zip(&self.gains)
        {
            *number = (*number - low) * gain - 1.0;
            beyond |= number.abs() > BEYOND;
            *value = number.clamp(-1.0, 1.0) as f32;
        }
        clipped.observations += 1;
        if beyond {
            clipped.count(numbers);
        }
    }
}

/// From here on a scaled value counts as beyond its bounds; what lies nearer is rounding.
const BEYOND: f64 = 1.0 + 1e-6;

/// How often values of a trip's observations were beyond the bounds of their rows, and held there.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Clipped {
    observations: u64,
    /// Observations with any value beyond its bounds.
    any: u64,
    /// Row by row; empty while there was none.
    times: Vec<u64>,
}

impl Clipped {
    #[cold]
    fn count(&mut self, scaled: &[f64]) {
        self.any += 1;
        self.times.resize(scaled.len(), 0);
        for (times, value) in self.times.iter_mut().zip(scaled) {
            *times += u64::from(value.abs() > BEYOND);
        }
    }

    /// Whether these can be the counts of so many rows.
    #[must_use]
    pub fn fits(&self, rows: usize) -> bool {
        (self.times.is_empty() || self.times.len() == rows)
            && self.any <= self.observations
            && self.times.iter().all(|&times| times <= self.any)
    }

    /// Share of the observations in which any value was clipped.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.any as f64 / self.observations.max(1) as f64
    }

    /// Share of the observations in which each of so many rows was clipped.
    #[must_use]
    pub fn shares(&self, rows: usize) -> Vec<f64> {
        let share = |row| {
            let times = self.times.get(row).copied().unwrap_or_default();
            times as f64 / self.observations.max(1) as f64
        };
        (0..rows).map(share).collect()
    }
}

/// Where a row stands in an observation, and where its value is read.
#[derive(Debug, Clone, Copy)]
struct Entry<F> {
    row: u16,
    from: F,
}

/// An entry of a row and a position.
fn entry(row: usize, from: usize) -> Entry<u16> {
    Entry { row: row as u16, from: from as u16 }
}

/// So many entries are worked on at a time.
const TOGETHER: usize = 4;

/// Enters the values of some rows. The room is a power of two, so that a row is brought into it by masking: no branch for
/// each.
#[inline(always)]
fn enter<F: Copy>(entries: &[Entry<F>], numbers: &mut [f64], read: impl Fn(F) -> f64) {
    let last = numbers.len() - 1;
    let (groups, rest) = entries.as_chunks::<TOGETHER>();
    for group in groups {
        for Entry { row, from } in group {
            numbers[usize::from(*row) & last] = read(*from);
        }
    }
    for Entry { row, from } in rest {
        numbers[usize::from(*row) & last] = read(*from);
    }
}

/// A value of the plant.
type Read = fn(&View<'_>) -> f64;

/// Places of an observation in one vehicle by where their values come from: read without asking each row what kind it is.
///
/// A row that the vehicle lacks stands in no list: it reads as 0 in its own unit, held within its bounds, and without noise.
#[derive(Debug, Clone, Default)]
pub struct FittedObservations {
    functions: Vec<Entry<Read>>,
    readers: Vec<Entry<Reader>>,
    temperatures: Vec<Entry<Node>>,
    flows: Vec<Entry<Flow>>,
    branches: Vec<Entry<u16>>,
    /// Rows of the command.
    asked: Vec<Entry<u16>>,
    /// Columns of an action whose options are not the vehicle's own.
    translated: Vec<Entry<u16>>,
    actions: Option<FittedActions>,
    /// By seconds.
    speeds_ahead: Vec<Entry<u16>>,
    solar: Option<usize>,
    occupants: Option<usize>,
    time_left: Option<usize>,
    behind: Option<usize>,
    /// Whether each row is blurred by noise.
    measured: Vec<bool>,
}

impl FittedObservations {
    /// A table's rows in a vehicle whose actions are fitted already.
    #[must_use]
    pub fn of(table: &ObservationTable, plant: &Plant, actions: &FittedActions) -> Self {
        let layout = plant.layout();
        let branches: Vec<String> =
            (0..layout.branches.len()).map(|branch| branch_name(layout, branch)).collect();
        let mut places =
            Self { measured: table.rows.iter().map(Observed::measured).collect(), ..Self::default() };
        for (place, row) in table.rows.iter().enumerate() {
            let at = place as u16;
            match row.source {
                Source::Signal => match plant.signals.find(&row.name).map(|signal| signal.reader) {
                    Some(Reader::Function(from)) => places.functions.push(Entry { row: at, from }),
                    Some(Reader::Flow(from)) => places.flows.push(Entry { row: at, from }),
                    Some(Reader::Temperature(from)) => places.temperatures.push(Entry { row: at, from }),
                    Some(from) => places.readers.push(Entry { row: at, from }),
                    None => places.measured[place] = false,
                },
                Source::Solar => places.solar = Some(place),
                Source::Occupants => places.occupants = Some(place),
                Source::Branch => {
                    let branch = branches.iter().position(|name| *name == row.name);
                    places.branches.extend(branch.map(|branch| entry(place, branch)));
                }
                Source::Asked(column) => match actions.plain_row(column) {
                    Some(row) => places.asked.push(entry(place, row)),
                    None if actions.has(column) => places.translated.push(entry(place, column)),
                    None => {}
                },
                Source::SpeedAhead(seconds) => places.speeds_ahead.push(entry(place, seconds)),
                Source::TimeLeft => places.time_left = Some(place),
                Source::Behind => places.behind = Some(place),
            }
        }
        places.actions = Some(actions.clone()).filter(|_| !places.translated.is_empty());
        places
    }

    /// Writes the values of all rows, which are 0 before.
    #[inline(always)]
    fn read(&self, look: &Look<'_>, values: &mut [f64]) {
        let (state, asked) = (look.view.state, look.asked);
        enter(&self.functions, values, |read| read(&look.view));
        enter(&self.readers, values, |reader| reader.read(&look.view));
        enter(&self.temperatures, values, |node| state.temperatures_k[node.index()] - ZERO_CELSIUS_K);
        if let Some(record) = look.view.record {
            enter(&self.flows, values, |flow| record.flows[flow]);
        }
        enter(&self.branches, values, |branch| {
            f64::from(u8::from(state.connected[usize::from(branch) % BRANCH_PLACES]))
        });
        enter(&self.asked, values, |row| f64::from(asked.0[usize::from(row)]));
        if let Some(actions) = &self.actions {
            enter(&self.translated, values, |column| f64::from(actions.value(usize::from(column), asked)));
        }
        let cycle = &look.experiment.cycle;
        enter(&self.speeds_ahead, values, |seconds| {
            let speeds_m_s = cycle.speeds_m_s();
            speeds_m_s[(look.steps + usize::from(seconds)).min(speeds_m_s.len() - 1)]
        });
        if let Some(place) = self.solar {
            values[place] = look.view.disturbance.solar_gain_w;
        }
        if let Some(place) = self.occupants {
            values[place] = look.view.disturbance.occupants;
        }
        if let Some(place) = self.time_left {
            values[place] = cycle.duration_s().saturating_sub(look.steps) as f64;
        }
        if let Some(place) = self.behind {
            values[place] = look.behind_m;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::rows_of;
    use hp_plant::config::vehicle::architecture;
    use std::collections::BTreeMap;

    fn tables(architectures: &[&str], names: &[&str]) -> (ActionTable, ObservationTable) {
        let set = rows_of(architectures);
        let actions = ActionTable::new(&["default".to_owned()], &set, &BTreeMap::new()).expect("built in");
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        let observations = ObservationTable::new(&names, &set, &actions, &BTreeMap::new()).expect("built in");
        (actions, observations)
    }

    #[test]
    fn every_signal_has_a_row_and_every_row_has_bounds_and_a_meaning() {
        for name in ["jeffs2019", "direct", "three-loops"] {
            let (set, layout) = (rows_of(&[name]), architecture(name).expect("built in"));
            let actions = ActionTable::new(&["all".to_owned()], &set, &BTreeMap::new()).expect("built in");
            let rows = all(&set, &actions);
            for signal in hp_plant::signals::SignalTable::of(&layout).rows() {
                assert_eq!(rows.iter().filter(|row| row.name == signal.name).count(), 1, "{}", signal.name);
            }
            assert!(rows.iter().all(|row| row.low < row.high && !row.description.is_empty()));
            assert!(rows.len() <= MANY_ROWS, "{name}: {} rows", rows.len());
        }
    }

    #[test]
    fn rows_show_the_signals_of_their_names_in_any_order() {
        rows_show_their_signals(&["jeffs2019"], "default", &[DEFAULT_GROUP]);
    }

    /// More rows than [`USUAL_ROWS`], backwards, with those of cars whose members this one lacks.
    #[test]
    fn rows_show_their_signals_however_many_there_are() {
        let cars = ["three-loops", "cabin-condenser", "direct", "low-temperature-radiator", "jeffs2019"];
        let set = rows_of(&cars);
        let actions = ActionTable::new(&["all".to_owned()], &set, &BTreeMap::new()).expect("built in");
        let names: Vec<String> = all(&set, &actions).into_iter().rev().map(|row| row.name).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        assert!(names.len() > USUAL_ROWS, "{}", names.len());
        rows_show_their_signals(&cars, "all", &names);
    }

    fn rows_show_their_signals(architectures: &[&str], group: &str, names: &[&str]) {
        let set = rows_of(architectures);
        let actions = ActionTable::new(&[group.to_owned()], &set, &BTreeMap::new()).expect("built in");
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        let table = ObservationTable::new(&names, &set, &actions, &BTreeMap::new()).expect("built in");
        let experiment = Experiment::load("jeffs2019/case1-4", None, &[]).expect("built in");
        let fitted_actions = FittedActions::of(&actions, experiment.plant.layout());
        let fitted = FittedObservations::of(&table, &experiment.plant, &fitted_actions);
        let mut run = experiment.start();
        let mut signals = Vec::new();
        for _ in 0..600 {
            let disturbance = experiment.disturbance(run.steps.saturating_sub(1));
            let asked = experiment.rule_based_command(&mut run);
            let view = View {
                plant: &experiment.plant,
                state: &run.state,
                record: run.record.as_ref(),
                disturbance: &disturbance,
            };
            let look = Look {
                view,
                experiment: &experiment,
                asked: &asked,
                steps: run.steps,
                behind_m: run.pace.behind_m,
            };
            let mut shown = vec![0.0; table.rows().len()];
            table.write(&fitted, &look, None::<fn() -> f64>, &mut shown, &mut Clipped::default());
            signals.clear();
            experiment.look(&run, &mut signals);
            for (row, shown) in table.rows().iter().zip(shown) {
                let Some(column) = experiment.plant.signals.rows().iter().position(|s| s.name == row.name)
                else {
                    continue;
                };
                let gain = 2.0 / (row.high - row.low);
                let expected = ((signals[column] - row.low) * gain - 1.0).clamp(-1.0, 1.0) as f32;
                assert_eq!(shown, expected, "{}, second {}", row.name, run.steps);
            }
            experiment.step(&mut run, &asked);
        }
    }

    #[test]
    fn default_rows_do_not_look_ahead() {
        let (_, table) = tables(&["jeffs2019"], &[DEFAULT_GROUP]);
        let ahead = |row: &Observed| matches!(row.source, Source::SpeedAhead(_) | Source::TimeLeft);
        assert!(!table.rows().iter().any(ahead));
        assert_eq!(table.rows().len(), 63);
    }

    #[test]
    fn a_row_that_a_car_lacks_reads_as_zero_within_its_bounds() {
        let (actions, table) = tables(&["jeffs2019", "ptc-only"], &[DEFAULT_GROUP]);
        let vehicle = Some("jeffs2019-ptc-only");
        let experiment = Experiment::with_vehicle("jeffs2019/case1-4", vehicle, None, &[]).expect("built in");
        let fitted_actions = FittedActions::of(&actions, experiment.plant.layout());
        let fitted = FittedObservations::of(&table, &experiment.plant, &fitted_actions);
        let run = experiment.start();
        let disturbance = experiment.disturbance(0);
        let view =
            View { plant: &experiment.plant, state: &run.state, record: None, disturbance: &disturbance };
        let look = Look { view, experiment: &experiment, asked: &Command([0.5; _]), steps: 0, behind_m: 0.0 };
        let mut shown = vec![9.0; table.rows().len()];
        table.write(&fitted, &look, Some(|| 1.0), &mut shown, &mut Clipped::default());
        let lacking = |row: &&(&Observed, f32)| {
            row.0.source == Source::Signal && experiment.plant.signals.find(&row.0.name).is_none()
        };
        let rows: Vec<(&Observed, f32)> = table.rows().iter().zip(shown).collect();
        assert!(rows.iter().filter(lacking).count() > 10);
        for (row, shown) in rows.iter().filter(lacking) {
            let zero = 0.0_f64.clamp(row.low, row.high);
            let expected = 2.0 * (zero - row.low) / (row.high - row.low) - 1.0;
            assert!((f64::from(*shown) - expected).abs() < 1e-6, "{}", row.name);
        }
        let blurred = rows.iter().find(|(row, _)| row.name == "soc").expect("every car has it");
        assert_eq!(blurred.1, 1.0);
    }
}
