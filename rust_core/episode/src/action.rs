//! What an agent can do: rows of actuators, as levels or as continuous values, and what they are in one vehicle.

use crate::defaults::Defaults;
use crate::rows::{ActionRow, RowSet, unknown};
use hp_plant::architecture::layout::{ACTUATOR_PLACES, BranchSide, CABIN_PLACES, Layout};
use hp_plant::circuits::branches::BranchTemperatures;
use hp_plant::command::{Command, Purpose, Scale};
use hp_plant::error::{PlantError, PlantResult};
use hp_plant::numerics::thermal_network::Node;
use hp_plant::plant::{Disturbance, Plant};
use hp_plant::state::State;
use std::collections::BTreeMap;

/// Levels of a row that is not a choice; for the compressor the first of them is off.
pub const LEVELS: usize = 11;

/// Normalised compressor demand of the lowest level that runs.
const LOWEST_RUNNING: f64 = -0.9;

/// Sets of actuators by name: those that agents control by default, those of them that move heat and not air, those that
/// rule-based controllers move, all.
pub const GROUPS: [&str; 4] = ["default", "heat", "hpcu", "all"];

/// Number of options of a row.
#[must_use]
pub fn options(scale: &Scale) -> usize {
    match scale {
        Scale::Choice(options) => options.len(),
        Scale::Linear | Scale::OffThenLogarithmic => LEVELS,
    }
}

/// Normalised value of an option of a row.
#[must_use]
pub fn option_value(scale: &Scale, option: usize) -> f32 {
    let k = option as f64;
    let last = (LEVELS - 1) as f64;
    let value = match scale {
        Scale::Choice(options) => return choice_value(options.len(), option),
        Scale::Linear => 2.0 * k / last - 1.0,
        Scale::OffThenLogarithmic if option == 0 => -1.0,
        Scale::OffThenLogarithmic => LOWEST_RUNNING + (1.0 - LOWEST_RUNNING) * (k - 1.0) / (last - 1.0),
    };
    value as f32
}

/// Option of a row that is nearest to a normalised value.
#[must_use]
pub fn nearest_option(scale: &Scale, value: f32) -> usize {
    let x = f64::from(value);
    let last = (LEVELS - 1) as f64;
    let k = match scale {
        Scale::Choice(options) => return chosen(options.len(), value),
        Scale::Linear => (0.5 * (x + 1.0) * last).round(),
        Scale::OffThenLogarithmic if x < LOWEST_RUNNING - 1e-6 => 0.0,
        Scale::OffThenLogarithmic => {
            1.0 + ((x - LOWEST_RUNNING) / (1.0 - LOWEST_RUNNING) * (last - 1.0)).round().max(0.0)
        }
    };
    (k.max(0.0) as usize).min(options(scale) - 1)
}

/// Normalised value in the middle of one of several options.
fn choice_value(count: usize, option: usize) -> f32 {
    ((2.0 * option as f64 + 1.0) / count as f64 - 1.0) as f32
}

/// Which of several options a normalised value lies in, as [`ActuatorRanges::physical`] reads it.
///
/// [`ActuatorRanges::physical`]: hp_plant::command::ActuatorRanges::physical
#[must_use]
#[inline]
pub fn chosen(count: usize, value: f32) -> usize {
    let share = 0.5 * (f64::from(value) + 1.0);
    // The conversion rounds towards zero and holds what is below at zero.
    ((share * count as f64) as usize).min(count - 1)
}

/// Selected rows, shared by all vehicles of an environment.
#[derive(Debug, Clone, PartialEq)]
pub struct ActionTable {
    rows: Vec<ActionRow>,
    option_counts: Vec<usize>,
    /// Where the values of each row begin.
    starts: Vec<usize>,
    /// Normalised value of every option, row by row.
    values: Vec<f32>,
}

/// An error about the list of actions.
fn refused(value: impl Into<String>, allowed: &str) -> PlantError {
    PlantError::InvalidArgument { what: "actions".into(), value: value.into(), allowed: allowed.into() }
}

impl ActionTable {
    /// Rows by name out of those that there are; a name of [`GROUPS`] stands for its rows. `options` replaces those of
    /// choices by name, in the order given.
    ///
    /// # Errors
    /// An unknown name, one given twice, or none at all; options of what is no choice.
    pub fn new(names: &[String], set: &RowSet, options: &BTreeMap<String, Vec<String>>) -> PlantResult<Self> {
        let mut rows: Vec<ActionRow> = Vec::with_capacity(names.len());
        for name in names {
            let of_group: Option<fn(&ActionRow) -> bool> = match GROUPS.iter().position(|group| group == name)
            {
                Some(0) => Some(|row| row.by_default),
                Some(1) => Some(|row| row.moves_heat),
                Some(2) => Some(|row| row.by_rules),
                Some(_) => Some(|_| true),
                None => None,
            };
            let selected: Vec<&ActionRow> = match of_group {
                Some(fits) => set.actions.iter().filter(|row| fits(row)).collect(),
                None => set.actions.iter().filter(|row| row.name == *name).collect(),
            };
            if selected.is_empty() {
                return Err(unknown("action", name, &set.action_names()));
            }
            for row in selected {
                if rows.iter().any(|other| other.name == row.name) {
                    let value = format!("a list with `{}` twice", row.name);
                    return Err(refused(value, "must name each action once"));
                }
                rows.push(row.clone());
            }
        }
        if rows.is_empty() {
            return Err(refused("empty", "must name at least one action"));
        }
        for (name, options) in options {
            replace_options(&mut rows, name, options)?;
        }
        Ok(Self::of(rows))
    }

    fn of(rows: Vec<ActionRow>) -> Self {
        let option_counts: Vec<usize> = rows.iter().map(|row| options(&row.scale)).collect();
        let mut starts = Vec::with_capacity(rows.len());
        let mut values = Vec::new();
        for (row, &count) in rows.iter().zip(&option_counts) {
            starts.push(values.len());
            values.extend((0..count).map(|option| option_value(&row.scale, option)));
        }
        Self { rows, option_counts, starts, values }
    }

    /// Selected rows in the order of an action.
    #[must_use]
    pub fn rows(&self) -> &[ActionRow] {
        &self.rows
    }

    /// Normalised value of an option of the row in a column of an action.
    #[must_use]
    #[inline]
    pub fn value(&self, column: usize, option: usize) -> f32 {
        self.values[self.starts[column] + option]
    }

    /// Number of options of each selected row.
    #[must_use]
    pub fn option_counts(&self) -> &[usize] {
        &self.option_counts
    }

    /// Length of the mask: all options of all selected rows.
    #[must_use]
    pub fn mask_length(&self) -> usize {
        self.values.len()
    }
}

fn replace_options(rows: &mut [ActionRow], name: &str, options: &[String]) -> PlantResult<()> {
    let names: Vec<String> = rows.iter().map(|row| row.name.clone()).collect();
    let Some(row) = rows.iter_mut().find(|row| row.name == name) else {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        return Err(unknown("action", name, &names));
    };
    let Scale::Choice(known) = &row.scale else {
        let value = format!("a list with options for `{name}`");
        return Err(refused(value, "must name options of choices only"));
    };
    if options.first() != known.first() {
        let value = format!("a list with `{name}` that begins with {options:?}");
        return Err(refused(value, &format!("must begin with `{}`", known[0])));
    }
    row.scale = Scale::Choice(options.to_vec());
    Ok(())
}

/// How the options of a choice that are shared differ from a vehicle's own.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Translation {
    /// Own option for each shared one; none where the vehicle lacks it.
    own: Vec<Option<usize>>,
    /// Shared option for each own one; the first where it is not shared.
    shared: Vec<usize>,
}

/// A column of an action in one vehicle.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Column {
    /// Row of the command; none where the vehicle lacks it.
    row: Option<usize>,
    /// Only where the options are not the same.
    translation: Option<Translation>,
}

/// Selected rows as one vehicle has them.
///
/// What it lacks is ignored: of a row all, of a choice the option, which acts as the first: isolated, closed, off.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FittedActions {
    columns: Vec<Column>,
    selected: [bool; ACTUATOR_PLACES],
    /// Rows of the command where the vehicle has all columns and the same options; empty otherwise.
    rows: Vec<usize>,
    /// A mask but for what the checks say.
    always: Vec<bool>,
    /// Options that temperatures decide about; none where a check needs more than [`Check`] looks at.
    checks: Option<Vec<Check>>,
}

/// An option of a mask that the temperatures on both sides of a branch decide about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Check {
    /// Where it stands in the mask.
    place: usize,
    branch: usize,
    /// Coolant that it gets.
    inlet: Inlet,
    other: Other,
    out_of_loop: bool,
}

/// Coolant that a branch gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Inlet {
    Supply(Node),
    /// Behind the exchanger of a loop, where branches in series begin, with the node of its return.
    BehindExchanger {
        circuit: usize,
        back: Node,
    },
}

impl Inlet {
    #[inline]
    fn temperature_k(self, plant: &Plant, state: &State) -> f64 {
        match self {
            Self::Supply(node) => state.temperatures_k[node.index()],
            Self::BehindExchanger { circuit, back } => {
                let specific_heat_j_kg_k = plant.vehicle.loops[circuit].circuit.coolant_specific_heat_j_kg_k;
                let rate_w_k = state.pumps[circuit].flow_kg_s * specific_heat_j_kg_k;
                state.temperatures_k[back.index()] + state.entered_w[circuit] / rate_w_k
            }
        }
    }
}

/// What is on the other side of a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Other {
    Node(Node),
    Ambient,
    /// Air into a cabin's core, recirculated as in cooling or not.
    Core {
        cabin: usize,
        air: Node,
        cooling: bool,
    },
}

impl Check {
    /// The check of a branch; none where exchangers in one air or rows that the agent controls matter too.
    fn of(layout: &Layout, selected: &[bool], branch: usize, place: usize) -> Option<Self> {
        let row = layout.branches[branch];
        let other = match row.side {
            BranchSide::Mass(node) => Other::Node(node),
            BranchSide::Plate(from) => Other::Node(layout.loops[from].back),
            BranchSide::Ambient(_) => Other::Ambient,
            BranchSide::Core(cabin) => {
                Other::Core { cabin, air: layout.cabins[cabin].air, cooling: !row.out_of_loop }
            }
        };
        let controlled = match row.side {
            BranchSide::Core(cabin) => {
                let rows = &layout.cabins[cabin];
                selected[rows.recirculation_row] || selected[rows.blower_row]
            }
            BranchSide::Ambient(end) => layout.front_ends[end].stream.is_some(),
            _ => false,
        };
        let circuit = &layout.loops[row.circuit];
        let inlet = if row.series {
            Inlet::BehindExchanger { circuit: row.circuit, back: circuit.back }
        } else {
            Inlet::Supply(circuit.supply)
        };
        (!controlled).then_some(Self { place, branch, inlet, other, out_of_loop: row.out_of_loop })
    }
}

impl FittedActions {
    /// A table's rows in a vehicle.
    #[must_use]
    pub fn of(table: &ActionTable, layout: &Layout) -> Self {
        let mut selected = [false; ACTUATOR_PLACES];
        let columns: Vec<Column> = table
            .rows
            .iter()
            .map(|shared| {
                let Some(row) = layout.actuator(&shared.name) else {
                    return Column { row: None, translation: None };
                };
                selected[row] = true;
                Column {
                    row: Some(row),
                    translation: translation(&shared.scale, &layout.actuators[row].scale),
                }
            })
            .collect();
        let plain = columns.iter().all(|column| column.translation.is_none());
        let rows: Option<Vec<usize>> = columns.iter().map(|column| column.row).collect();
        let rows = rows.filter(|_| plain).unwrap_or_default();
        let (always, checks) = mask_plan(table, layout, &columns, &selected);
        Self { columns, selected, rows, always, checks }
    }

    /// Whether a row of the vehicle is selected.
    #[must_use]
    #[inline]
    pub fn selects(&self, row: usize) -> bool {
        self.selected[row]
    }

    /// Enters values of the columns into a command.
    #[inline]
    pub fn enter(&self, values: &[f32], command: &mut Command) {
        if self.rows.is_empty() {
            self.enter_translated(values, command);
            return;
        }
        for (&row, &value) in self.rows.iter().zip(values) {
            command.0[row] = value;
        }
    }

    #[cold]
    fn enter_translated(&self, values: &[f32], command: &mut Command) {
        for (column, &value) in self.columns.iter().zip(values) {
            let Some(row) = column.row else { continue };
            command.0[row] = match &column.translation {
                None => value,
                Some(Translation { own, shared }) => {
                    choice_value(shared.len(), own[chosen(own.len(), value)].unwrap_or(0))
                }
            };
        }
    }

    /// Normalised value of a column in a command; 0 where the vehicle lacks it.
    #[must_use]
    pub fn value(&self, column: usize, command: &Command) -> f32 {
        let Column { row, translation } = &self.columns[column];
        let Some(row) = *row else { return 0.0 };
        match translation {
            None => command.0[row],
            Some(Translation { own, shared }) => {
                choice_value(own.len(), shared[chosen(shared.len(), command.0[row])])
            }
        }
    }

    /// Row of the command that a column is read from as it is; none where it is translated or lacking.
    #[must_use]
    pub fn plain_row(&self, column: usize) -> Option<usize> {
        let Column { row, translation } = &self.columns[column];
        row.filter(|_| translation.is_none())
    }

    /// Whether the vehicle has the row of a column.
    #[must_use]
    pub fn has(&self, column: usize) -> bool {
        self.columns[column].row.is_some()
    }

    /// Option of a column that is nearest to what a command has; the first where the vehicle lacks the row.
    #[must_use]
    pub fn level(&self, table: &ActionTable, column: usize, command: &Command) -> usize {
        if !self.has(column) {
            return 0;
        }
        nearest_option(&table.rows[column].scale, self.value(column, command))
    }

    /// Which options the plant would grant in the coming second, column by column.
    ///
    /// The cabin's air inlet depends on recirculation: where an agent controls that or the blower, a connection counts as
    /// granted if some recirculated share makes it so. Of what the vehicle lacks only the first option of a row is granted.
    pub fn write_mask(
        &self,
        table: &ActionTable,
        plant: &Plant,
        state: &State,
        disturbance: &Disturbance,
        defaults: &Defaults,
        mask: &mut [bool],
    ) {
        let Some(checks) = &self.checks else {
            return self.write_mask_of_any(table, plant, state, disturbance, defaults, mask);
        };
        mask.copy_from_slice(&self.always);
        let ambient_k = disturbance.air.temperature_k;
        for check in checks {
            let inlet_k = check.inlet.temperature_k(plant, state);
            let other_k = match check.other {
                Other::Node(node) => state.temperatures_k[node.index()],
                Other::Ambient => ambient_k,
                Other::Core { cabin, air, cooling } => {
                    let share = defaults.effective_recirculation(cabin, cooling);
                    (1.0 - share) * ambient_k + share * state.temperatures_k[air.index()]
                }
            };
            let difference_k = if check.out_of_loop { inlet_k - other_k } else { other_k - inlet_k };
            let connected = state.connected[check.branch];
            mask[check.place] = plant.branches.allows(check.branch, difference_k, ambient_k, connected);
        }
    }

    /// The same for any architecture and any rows.
    #[cold]
    fn write_mask_of_any(
        &self,
        table: &ActionTable,
        plant: &Plant,
        state: &State,
        disturbance: &Disturbance,
        defaults: &Defaults,
        mask: &mut [bool],
    ) {
        let temperatures = plant.branch_temperatures(state, &[0.0; CABIN_PLACES], disturbance);
        let asked = Asked { plant, state, disturbance, defaults, actions: self, temperatures };
        let mut place = 0;
        for (column, &count) in self.columns.iter().zip(&table.option_counts) {
            for option in 0..count {
                mask[place] = match (column.row, &column.translation) {
                    (None, _) => option == 0,
                    (Some(row), None) => asked.granted(row, option),
                    (Some(row), Some(translation)) => {
                        translation.own[option].is_some_and(|own| asked.granted(row, own))
                    }
                };
                place += 1;
            }
        }
    }
}

/// The branch that an option of a row of the command connects, if it is one.
fn branch_of(layout: &Layout, row: usize, option: usize) -> Option<usize> {
    let Purpose::Connection(member) = layout.actuators[row].purpose else { return None };
    layout.members[member].options.get(option.checked_sub(1)?).copied()
}

/// What is always granted, and the checks of what is not; see [`FittedActions`].
fn mask_plan(
    table: &ActionTable,
    layout: &Layout,
    columns: &[Column],
    selected: &[bool],
) -> (Vec<bool>, Option<Vec<Check>>) {
    let (mut always, mut checks) = (Vec::new(), Some(Vec::new()));
    for (column, &count) in columns.iter().zip(&table.option_counts) {
        for option in 0..count {
            let own = match (column.row, &column.translation) {
                (None, _) => None,
                (Some(_), None) => Some(option),
                (Some(_), Some(translation)) => translation.own[option],
            };
            let branch = column.row.zip(own).and_then(|(row, own)| branch_of(layout, row, own));
            if let Some(branch) = branch {
                let check = Check::of(layout, selected, branch, always.len());
                checks = checks.zip(check).map(|(mut all, check)| {
                    all.push(check);
                    all
                });
            }
            always.push(own.is_some() || (column.row.is_none() && option == 0));
        }
    }
    (always, checks)
}

/// How shared options differ from own ones, if they do.
fn translation(shared: &Scale, own: &Scale) -> Option<Translation> {
    let (Scale::Choice(shared), Scale::Choice(own)) = (shared, own) else { return None };
    if shared == own {
        return None;
    }
    Some(Translation {
        own: shared.iter().map(|option| own.iter().position(|other| other == option)).collect(),
        shared: own
            .iter()
            .map(|option| shared.iter().position(|other| other == option).unwrap_or(0))
            .collect(),
    })
}

/// What a mask is worked out for.
struct Asked<'a> {
    plant: &'a Plant,
    state: &'a State,
    disturbance: &'a Disturbance,
    defaults: &'a Defaults,
    actions: &'a FittedActions,
    /// Those that drive each branch, with fresh air for the cabins.
    temperatures: BranchTemperatures,
}

impl Asked<'_> {
    fn granted(&self, row: usize, option: usize) -> bool {
        let layout = self.plant.layout();
        let Some(branch) = branch_of(layout, row, option) else { return true };
        let BranchSide::Core(cabin) = layout.branches[branch].side else {
            return self.allowed(branch, &self.temperatures);
        };
        let at = |share: f64| {
            let mut temperatures = self.temperatures;
            let (outside_k, inside_k) =
                (self.disturbance.air.temperature_k, temperatures.nodes_k[layout.cabins[cabin].air.index()]);
            temperatures.core_inlet_k[cabin] = (1.0 - share) * outside_k + share * inside_k;
            self.allowed(branch, &temperatures)
        };
        let cabin_rows = &layout.cabins[cabin];
        if self.actions.selects(cabin_rows.recirculation_row) || self.actions.selects(cabin_rows.blower_row) {
            at(0.0) || at(self.effective(cabin, 1.0, 1.0))
        } else {
            let cooling = !layout.branches[branch].out_of_loop;
            let blower = self.defaults.blower(cabin, cooling);
            at(self.effective(cabin, blower, self.defaults.recirculation(cabin, cooling)))
        }
    }

    fn allowed(&self, branch: usize, temperatures: &BranchTemperatures) -> bool {
        let difference_k = self.plant.branch_difference_k(temperatures, branch);
        let ambient_k = self.disturbance.air.temperature_k;
        self.plant.branches.allows(branch, difference_k, ambient_k, self.state.connected[branch])
    }

    fn effective(&self, cabin: usize, blower: f32, recirculation: f32) -> f64 {
        effective_recirculation(self.plant, self.disturbance.occupants, cabin, blower, recirculation)
    }
}

/// Recirculated share; some of it may be held back for the sake of fresh air.
#[inline]
pub(crate) fn effective_recirculation(
    plant: &Plant,
    occupants: f64,
    cabin: usize,
    blower: f32,
    recirculation: f32,
) -> f64 {
    let (ranges, rows) = (&plant.ranges, &plant.layout().cabins[cabin]);
    let level = ranges.physical(rows.blower_row, blower);
    let share = ranges.physical(rows.recirculation_row, recirculation);
    let cabin = &plant.vehicle.cabins[cabin];
    cabin.parameters.ventilation(level, share, occupants * cabin.occupant_share).recirculation
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::tests::rows_of;
    use hp_plant::config::vehicle::architecture;
    use hp_trip::experiment::Experiment;

    fn table(names: &[&str], set: &RowSet) -> PlantResult<ActionTable> {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        ActionTable::new(&names, set, &BTreeMap::new())
    }

    #[test]
    fn every_option_is_the_nearest_to_its_own_value() {
        for row in rows_of(&["jeffs2019", "direct"]).actions {
            for option in 0..options(&row.scale) {
                assert_eq!(
                    nearest_option(&row.scale, option_value(&row.scale, option)),
                    option,
                    "{}",
                    row.name
                );
            }
        }
    }

    #[test]
    fn default_actions_of_the_paper_are_six_connections_ptc_compressor_and_the_cabin_s_air() {
        let set = rows_of(&["jeffs2019"]);
        let heat = [
            "battery",
            "motor",
            "transmission",
            "ambient",
            "thermal_battery",
            "cabin",
            "ptc",
            "compressor_power",
        ];
        let air = ["recirculation", "blower_level", "windscreen_share"];
        let names = |group: &str| {
            let table = table(&[group], &set).expect("built in");
            table.rows().iter().map(|row| row.name.clone()).collect::<Vec<_>>()
        };
        assert_eq!(names("heat"), heat);
        assert_eq!(names("default"), [heat.as_slice(), &air].concat());
        let table = table(&["default"], &set).expect("built in");
        assert_eq!(table.option_counts(), [3, 2, 2, 3, 3, 3, 2, 11, 11, 11, 11]);
    }

    #[test]
    fn compressor_levels_are_off_and_ten_evenly_in_the_logarithm() {
        let experiment = Experiment::load("jeffs2019/case1-1", None, &[]).expect("built in");
        let ranges = &experiment.plant.ranges;
        let row = ranges.row("compressor_power").expect("built in");
        let scale = &ranges.rows()[row].scale;
        let powers: Vec<f64> = (0..LEVELS).map(|k| ranges.physical(row, option_value(scale, k))).collect();
        let (low, high) = ranges.range(row);
        assert_eq!(powers[0], 0.0);
        assert!((powers[1] / low - 1.0).abs() < 1e-5 && (powers[10] / high - 1.0).abs() < 1e-5);
        let ratio = (high / low).powf(1.0 / 9.0);
        for pair in powers[1..].windows(2) {
            assert!((pair[1] / pair[0] / ratio - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn options_asked_for_are_those_that_the_plant_reads() {
        let experiment = Experiment::load("jeffs2019/case1-1", None, &[]).expect("built in");
        let ranges = &experiment.plant.ranges;
        let mut command = Command::default();
        for value in (-1000..=1000).map(|thousandth| thousandth as f32 / 1000.0) {
            command.0.fill(value);
            let demand = ranges.decode(&command);
            for (row, actuator) in ranges.rows().iter().enumerate() {
                if let Scale::Choice(options) = &actuator.scale {
                    assert_eq!(chosen(options.len(), value) as f64, demand[row], "{value}");
                }
            }
        }
    }

    #[test]
    fn unknown_doubled_and_no_actions_are_refused() {
        let set = rows_of(&["jeffs2019"]);
        let message = |names: &[&str]| table(names, &set).expect_err("must be refused").to_string();
        assert!(message(&["heater"]).contains("unknown action `heater`; available: battery, motor"));
        assert!(message(&["ptc", "ptc"]).contains("`ptc` twice"));
        assert!(message(&["ptc", "default"]).contains("`ptc` twice"));
        assert!(message(&[]).contains("at least one"));
    }

    #[test]
    fn a_car_with_other_options_gets_its_own_by_name() {
        let set = rows_of(&["jeffs2019", "three-loops"]);
        let table = table(&["all"], &set).expect("built in");
        for name in ["jeffs2019", "three-loops"] {
            let layout = architecture(name).expect("built in");
            let actions = FittedActions::of(&table, &layout);
            for (column, shared) in table.rows().iter().enumerate() {
                let Some(row) = layout.actuator(&shared.name) else {
                    assert!(!actions.has(column));
                    continue;
                };
                let own = &layout.actuators[row];
                for option in 0..table.option_counts()[column] {
                    let mut values = vec![0.0; table.rows().len()];
                    values[column] = table.value(column, option);
                    let mut command = Command::default();
                    actions.enter(&values, &mut command);
                    let entered = nearest_option(&own.scale, command.0[row]);
                    let Scale::Choice(options) = &shared.scale else {
                        assert_eq!((entered, actions.level(&table, column, &command)), (option, option));
                        continue;
                    };
                    let wanted = own.options().iter().position(|other| *other == options[option]);
                    assert_eq!(entered, wanted.unwrap_or(0), "{name}: {} {}", shared.name, options[option]);
                    let back = actions.level(&table, column, &command);
                    assert_eq!(back, if wanted.is_some() { option } else { 0 });
                }
            }
        }
    }

    #[test]
    fn a_mask_is_the_same_by_checks_and_by_all_temperatures() {
        // Rows of another car too, so that some are lacking and options are translated.
        let shared = architecture("three-loops").expect("built in");
        let mut with_checks = 0;
        for vehicle in
            ["jeffs2019", "jeffs2019-three-loops", "jeffs2019-direct", "jeffs2019-no-thermal-battery"]
        {
            for scenario in ["jeffs2019/case1-4", "ours/hot-soak-plus35"] {
                let experiment =
                    Experiment::with_vehicle(scenario, Some(vehicle), None, &[]).expect("built in");
                let layout = experiment.plant.layout();
                let set = RowSet::of([layout, &shared]).expect("the same by the same name");
                let table = table(&["heat"], &set).expect("built in");
                let actions = FittedActions::of(&table, layout);
                with_checks += usize::from(actions.checks.is_some());
                let defaults = Defaults::of(&experiment);
                let mut run = experiment.start();
                for _ in 0..900 {
                    let disturbance = experiment.disturbance(run.steps);
                    let (mut one, mut other) =
                        (vec![false; table.mask_length()], vec![false; table.mask_length()]);
                    let (plant, state) = (&experiment.plant, &run.state);
                    actions.write_mask(&table, plant, state, &disturbance, &defaults, &mut one);
                    actions.write_mask_of_any(&table, plant, state, &disturbance, &defaults, &mut other);
                    assert_eq!(one, other, "{vehicle}, {scenario}, {}", run.steps);
                    let command = experiment.rule_based_command(&mut run);
                    experiment.step(&mut run, &command);
                }
            }
        }
        assert!(with_checks >= 4, "{with_checks}");
    }

    #[test]
    fn options_can_be_given_in_another_order() {
        let set = rows_of(&["jeffs2019"]);
        let names = vec!["battery".to_owned()];
        let given = |options: &[&str]| {
            let options = options.iter().map(|option| (*option).to_owned()).collect();
            ActionTable::new(&names, &set, &BTreeMap::from([("battery".to_owned(), options)]))
        };
        let table = given(&["isolated", "chiller", "htc"]).expect("begins with the first");
        let layout = architecture("jeffs2019").expect("built in");
        let mut command = Command::default();
        FittedActions::of(&table, &layout).enter(&[table.value(0, 1)], &mut command);
        assert_eq!(chosen(3, command.0[layout.actuator("battery").expect("there")]), 2);
        assert!(given(&["chiller"]).is_err());
    }
}
