//! What an agent can see: rows with bounds, read from the signal table, scaled to `[-1, 1]`.

use crate::action::ActionTable;
use hp_plant::circuits::branches::Branch;
use hp_plant::command::{ACTUATORS, Command};
use hp_plant::config::ZERO_CELSIUS_K;
use hp_plant::error::{PlantError, PlantResult};
use hp_plant::flows::Flow;
use hp_plant::numerics::thermal_network::Node;
use hp_plant::signals::{self, Signal, View};
use hp_plant::{UNROLLED, unrolled};
use hp_trip::experiment::Experiment;

/// A row of an observation.
#[derive(Debug, Clone)]
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

#[derive(Debug, Clone, Copy)]
enum Source {
    Signal(Signal),
    Solar,
    Occupants,
    Branch(Branch),
    Asked(usize),
    SpeedAhead(usize),
    TimeLeft,
}

/// Group of the rows seen by default, those of the previous action included.
pub const DEFAULT_GROUP: &str = "default";

/// Group of the rows that show the cycle ahead.
pub const PREVIEW_GROUP: &str = "preview";

/// How far ahead the preview looks [s].
const PREVIEW_S: [usize; 6] = [2, 5, 10, 20, 40, 80];

/// Longest time left that is told apart [s].
const LONGEST_TIME_LEFT_S: f64 = 3600.0;

/// Signals seen by default with their bounds.
const DEFAULT_SIGNALS: [(&str, f64, f64); 36] = [
    ("time_s", 0.0, 3600.0),
    ("speed_m_s", 0.0, 40.0),
    ("traction_power_w", -100_000.0, 100_000.0),
    ("ambient_temperature_degc", -40.0, 50.0),
    ("cabin_temperature_degc", -40.0, 80.0),
    ("battery_temperature_degc", -40.0, 60.0),
    ("motor_temperature_degc", -40.0, 120.0),
    ("transmission_temperature_degc", -40.0, 120.0),
    ("thermal_battery_temperature_degc", -40.0, 100.0),
    ("htc_supply_temperature_degc", -40.0, 100.0),
    ("htc_return_temperature_degc", -40.0, 100.0),
    ("chiller_supply_temperature_degc", -40.0, 60.0),
    ("chiller_return_temperature_degc", -40.0, 60.0),
    ("htc_flow_kg_s", 0.0, 0.5),
    ("chiller_flow_kg_s", 0.0, 0.5),
    ("condensing_pressure_bar", 0.0, 32.0),
    ("evaporating_pressure_bar", 0.0, 10.0),
    ("discharge_temperature_degc", -40.0, 140.0),
    ("compressor_speed_rev_s", 0.0, 150.0),
    ("soc", 0.0, 1.0),
    ("battery_charge_limit_w", 0.0, 150_000.0),
    ("battery_discharge_limit_w", 0.0, 250_000.0),
    ("battery_power_w", -100_000.0, 100_000.0),
    ("compressor_power_w", 0.0, 5000.0),
    ("ptc_power_w", 0.0, 6000.0),
    ("auxiliary_power_w", 0.0, 1500.0),
    ("condenser_heat_flow_w", 0.0, 15_000.0),
    ("evaporator_heat_flow_w", 0.0, 15_000.0),
    ("cabin_htc_heat_flow_w", -10_000.0, 10_000.0),
    ("cabin_chiller_heat_flow_w", -10_000.0, 10_000.0),
    ("battery_htc_heat_flow_w", -10_000.0, 10_000.0),
    ("battery_chiller_heat_flow_w", -10_000.0, 10_000.0),
    ("ambient_htc_heat_flow_w", -15_000.0, 15_000.0),
    ("ambient_chiller_heat_flow_w", -15_000.0, 15_000.0),
    ("motor_chiller_heat_flow_w", -10_000.0, 10_000.0),
    ("transmission_chiller_heat_flow_w", -10_000.0, 10_000.0),
];

/// The signals seen by default, found while compiling: to read them is a straight line of loads.
const DEFAULTS: [Signal; DEFAULT_SIGNALS.len()] = {
    let mut signals = [signals::TIME; DEFAULT_SIGNALS.len()];
    let mut place = 0;
    while place < signals.len() {
        signals[place] = signals::find(DEFAULT_SIGNALS[place].0).expect("a signal of this name");
        place += 1;
    }
    signals
};

/// Bounds of hidden signals whose unit does not tell them.
const HIDDEN_BOUNDS: [(&str, f64, f64); 6] = [
    ("charge_soc", 0.0, 1.0),
    ("loads_shed", 0.0, 1.0),
    ("compressor_starts", 0.0, 100.0),
    ("protection_trips", 0.0, 100.0),
    ("refrigerant_flow_kg_s", 0.0, 0.1),
    ("battery_voltage_v", 250.0, 500.0),
];

/// Bounds of other hidden signals, by unit.
fn bounds_of_unit(unit: &str) -> (f64, f64) {
    match unit {
        "degC" => (-60.0, 140.0),
        "W" => (-50_000.0, 50_000.0),
        "A" => (-500.0, 500.0),
        "bar" => (0.0, 32.0),
        "kg/s" => (0.0, 0.5),
        _ => (0.0, 10.0),
    }
}

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
        matches!(self.source, Source::Signal(_) | Source::Solar)
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
}

/// Every row there is, for an agent with these actions.
#[must_use]
pub fn all(actions: &ActionTable) -> Vec<Observed> {
    let mut rows = Vec::with_capacity(160);
    for ((name, low, high), signal) in DEFAULT_SIGNALS.into_iter().zip(DEFAULTS) {
        rows.push(row(name, signal.unit, (low, high), Source::Signal(signal)).meaning(signal.description));
    }
    rows.push(row("solar_gain_w", "W", (0.0, 1500.0), Source::Solar).meaning("solar heat into the cabin"));
    rows.push(row("occupants", "-", (0.0, 5.0), Source::Occupants).meaning("people in the cabin"));
    for branch in Branch::ALL {
        let member = ACTUATORS[branch.member() as usize].name;
        let circuit = format!("{:?}", branch.connection()).to_lowercase();
        let name = format!("{member}_on_{circuit}");
        rows.push(row(name, "-", (0.0, 1.0), Source::Branch(branch)).meaning("1 while the plant grants it"));
    }
    for &actuator in actions.rows() {
        let name = format!("previous_{}", ACTUATORS[actuator].name);
        let meaning = "what was asked last, normalised";
        rows.push(row(name, "-", (-1.0, 1.0), Source::Asked(actuator)).meaning(meaning));
    }
    for seconds in PREVIEW_S {
        let preview = row(format!("speed_in_{seconds}_s"), "m/s", (0.0, 40.0), Source::SpeedAhead(seconds));
        rows.push(preview.meaning("speed on the cycle ahead").hidden());
    }
    let left = row("time_left_s", "s", (0.0, LONGEST_TIME_LEFT_S), Source::TimeLeft);
    rows.push(left.meaning("time to arrival").hidden());
    for signal in signals::all() {
        if DEFAULT_SIGNALS.iter().all(|(name, _, _)| *name != signal.name) {
            let known = HIDDEN_BOUNDS.iter().find(|(name, _, _)| *name == signal.name);
            let bounds = known.map_or_else(|| bounds_of_unit(signal.unit), |&(_, low, high)| (low, high));
            rows.push(
                row(signal.name, signal.unit, bounds, Source::Signal(signal))
                    .meaning(signal.description)
                    .hidden(),
            );
        }
    }
    rows
}

/// Places of an observation by where their values come from: read without asking each row what kind it is.
#[derive(Debug, Clone, Default)]
struct Places {
    /// The first rows are those of [`DEFAULTS`], which no other field repeats.
    defaults_first: bool,
    signals: Vec<(usize, Signal)>,
    temperatures: Vec<(usize, Node)>,
    flows: Vec<(usize, Flow)>,
    branches: Vec<(usize, Branch)>,
    asked: Vec<(usize, usize)>,
    speeds_ahead: Vec<(usize, usize)>,
    solar: Option<usize>,
    occupants: Option<usize>,
    time_left: Option<usize>,
}

impl Places {
    fn of(rows: &[Observed]) -> Self {
        let names = rows.iter().map(|row| row.name.as_str());
        let mut places = Self {
            defaults_first: names.clone().take(DEFAULTS.len()).eq(DEFAULTS.map(|s| s.name)),
            ..Self::default()
        };
        let known = if places.defaults_first { DEFAULTS.len() } else { 0 };
        for (place, row) in rows.iter().enumerate().skip(known) {
            match row.source {
                Source::Signal(signal) => match (signal.flow(), signal.node()) {
                    (Some(flow), _) => places.flows.push((place, flow)),
                    (_, Some(node)) => places.temperatures.push((place, node)),
                    (None, None) => places.signals.push((place, signal)),
                },
                Source::Solar => places.solar = Some(place),
                Source::Occupants => places.occupants = Some(place),
                Source::Branch(branch) => places.branches.push((place, branch)),
                Source::Asked(actuator) => places.asked.push((place, actuator)),
                Source::SpeedAhead(seconds) => places.speeds_ahead.push((place, seconds)),
                Source::TimeLeft => places.time_left = Some(place),
            }
        }
        places
    }

    /// Writes signal number `POSITION` of [`DEFAULTS`].
    #[inline(always)]
    fn read_default<const POSITION: usize>(view: &View<'_>, values: &mut [f64; DEFAULTS.len()]) {
        if POSITION < DEFAULTS.len() {
            values[POSITION] =
                const { DEFAULTS[if POSITION < DEFAULTS.len() { POSITION } else { 0 }] }.read(view);
        }
    }

    /// Writes the values of all rows, which are 0 before.
    fn read(&self, look: &Look<'_>, values: &mut [f64]) {
        const { assert!(DEFAULTS.len() <= UNROLLED, "more signals than are unrolled") };
        if self.defaults_first {
            let values = values.first_chunk_mut().expect("a place for each of them");
            unrolled!(read_default(&look.view, values));
        }
        for &(place, signal) in &self.signals {
            values[place] = signal.read(&look.view);
        }
        for &(place, node) in &self.temperatures {
            values[place] = look.view.state.temperatures_k[node.index()] - ZERO_CELSIUS_K;
        }
        if let Some(record) = look.view.record {
            for &(place, flow) in &self.flows {
                values[place] = record.flows[flow];
            }
        }
        for &(place, branch) in &self.branches {
            values[place] = f64::from(u8::from(look.view.state.connected[branch as usize]));
        }
        for &(place, actuator) in &self.asked {
            values[place] = f64::from(look.asked.0[actuator]);
        }
        let cycle = &look.experiment.cycle;
        for &(place, seconds) in &self.speeds_ahead {
            let speeds_m_s = cycle.speeds_m_s();
            values[place] = speeds_m_s[(look.steps + seconds).min(speeds_m_s.len() - 1)];
        }
        if let Some(place) = self.solar {
            values[place] = look.view.disturbance.solar_gain_w;
        }
        if let Some(place) = self.occupants {
            values[place] = look.view.disturbance.occupants;
        }
        if let Some(place) = self.time_left {
            values[place] = cycle.duration_s().saturating_sub(look.steps) as f64;
        }
    }
}

/// Selected rows.
#[derive(Debug, Clone)]
pub struct ObservationTable {
    rows: Vec<Observed>,
    /// What is shown as -1.
    lows: Vec<f64>,
    /// How much of the scale a unit takes.
    gains: Vec<f64>,
    places: Places,
}

/// More rows than there are; a test counts them.
const ROWS: usize = 192;

/// As many rows as nearly all observations have: less to set to zero each second.
const USUAL_ROWS: usize = 64;

impl ObservationTable {
    /// Rows by name; a group stands for its rows.
    ///
    /// # Errors
    /// An unknown name, a row given twice, or none at all.
    pub fn new(names: &[String], actions: &ActionTable) -> PlantResult<Self> {
        let all = all(actions);
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
                let available = format!("{DEFAULT_GROUP}, {PREVIEW_GROUP}, {}", names.join(", "));
                return Err(PlantError::Unknown { kind: "observation", name: name.clone(), available });
            }
            for row in selected {
                if rows.iter().any(|other| other.name == row.name) {
                    return Err(PlantError::InvalidArgument {
                        what: "observations".into(),
                        value: format!("a list with `{}` twice", row.name),
                        allowed: "must name each row once".into(),
                    });
                }
                rows.push(row.clone());
            }
        }
        if rows.is_empty() {
            return Err(PlantError::InvalidArgument {
                what: "observations".into(),
                value: "empty".into(),
                allowed: "must name at least one row".into(),
            });
        }
        let lows = rows.iter().map(|row| row.low).collect();
        let gains = rows.iter().map(|row| 2.0 / (row.high - row.low)).collect();
        let places = Places::of(&rows);
        Ok(Self { rows, lows, gains, places })
    }

    /// Rows in the order of an observation.
    #[must_use]
    pub fn rows(&self) -> &[Observed] {
        &self.rows
    }

    /// Writes an observation; `blur`, where there is noise, gives that of each measured row.
    pub fn write(&self, look: &Look<'_>, blur: Option<impl FnMut() -> f64>, values: &mut [f32]) {
        if self.rows.len() <= USUAL_ROWS {
            self.write_through::<USUAL_ROWS>(look, blur, values);
        } else {
            self.write_through::<ROWS>(look, blur, values);
        }
    }

    fn write_through<const ROOM: usize>(
        &self,
        look: &Look<'_>,
        blur: Option<impl FnMut() -> f64>,
        values: &mut [f32],
    ) {
        let mut numbers = [0.0; ROOM];
        let numbers = &mut numbers[..self.rows.len()];
        self.places.read(look, numbers);
        if let Some(mut blur) = blur {
            // In units of half the range.
            for ((row, number), gain) in self.rows.iter().zip(numbers.iter_mut()).zip(&self.gains) {
                *number += if row.measured() { blur() / gain } else { 0.0 };
            }
        }
        for (((value, number), low), gain) in values.iter_mut().zip(numbers).zip(&self.lows).zip(&self.gains)
        {
            *value = ((*number - low) * gain - 1.0).clamp(-1.0, 1.0) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn default_actions() -> ActionTable {
        let names: Vec<String> = ACTUATORS[..crate::action::DEFAULT_ROWS]
            .iter()
            .map(|actuator| actuator.name.to_owned())
            .collect();
        ActionTable::new(&names).expect("built in")
    }

    #[test]
    fn every_signal_has_a_row_and_every_row_has_bounds_and_a_meaning() {
        let rows = all(&default_actions());
        for signal in signals::all() {
            assert_eq!(rows.iter().filter(|row| row.name == signal.name).count(), 1, "{}", signal.name);
        }
        assert!(rows.iter().all(|row| row.low < row.high && !row.description.is_empty()));
        assert!(rows.len() - crate::action::DEFAULT_ROWS + ACTUATORS.len() <= ROWS);
    }

    #[test]
    fn default_signals_show_the_same_read_in_one_line_and_one_by_one() {
        let actions = default_actions();
        let table = |names: Vec<String>| ObservationTable::new(&names, &actions).expect("built in");
        let straight = table(vec![DEFAULT_GROUP.to_owned()]);
        let names: Vec<String> = straight.rows().iter().rev().map(|row| row.name.clone()).collect();
        let one_by_one = table(names);
        assert!(straight.places.defaults_first && !one_by_one.places.defaults_first);
        let experiment = Experiment::load("jeffs2019/case1-4", None, &[]).expect("built in");
        let mut run = experiment.start();
        for _ in 0..600 {
            let disturbance = experiment.disturbance(run.steps.saturating_sub(1));
            let asked = experiment.rule_based_command(&mut run);
            let view = View {
                plant: &experiment.plant,
                state: &run.state,
                record: run.record.as_ref(),
                disturbance: &disturbance,
            };
            let look = Look { view, experiment: &experiment, asked: &asked, steps: run.steps };
            let mut rows = [vec![0.0; straight.rows().len()], vec![0.0; straight.rows().len()]];
            straight.write(&look, None::<fn() -> f64>, &mut rows[0]);
            one_by_one.write(&look, None::<fn() -> f64>, &mut rows[1]);
            rows[1].reverse();
            assert_eq!(rows[0], rows[1], "second {}", run.steps);
            experiment.step(&mut run, &asked);
        }
    }

    #[test]
    fn default_rows_do_not_look_ahead() {
        let table = ObservationTable::new(&[DEFAULT_GROUP.to_owned()], &default_actions()).expect("built in");
        let ahead = |row: &Observed| matches!(row.source, Source::SpeedAhead(_) | Source::TimeLeft);
        assert!(!table.rows().iter().any(ahead));
        assert_eq!(table.rows().len(), 56);
    }
}
