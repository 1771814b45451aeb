//! Rows that agents of several vehicles share: actuators, signals and branches by name, in the order in which the vehicles
//! bring them.

use hp_plant::architecture::declaration::MemberKind;
use hp_plant::architecture::flaw::among;
use hp_plant::architecture::layout::Layout;
use hp_plant::command::{Purpose, Scale};
use hp_plant::error::{PlantError, PlantResult};
use hp_plant::signals::SignalTable;

/// What an agent can do with one actuator, whichever vehicle has it.
#[derive(Debug, Clone, PartialEq)]
pub struct ActionRow {
    /// Name.
    pub name: String,
    /// Unit of the physical value.
    pub unit: &'static str,
    /// How the normalised value is read; the options of a choice are those of all vehicles.
    pub scale: Scale,
    /// What it does.
    pub description: String,
    /// Agents control it unless they say otherwise.
    pub by_default: bool,
    /// It moves heat, not air.
    pub moves_heat: bool,
    /// Rule-based controllers move it.
    pub by_rules: bool,
}

/// What an agent can see of one signal, whichever vehicle has it.
#[derive(Debug, Clone, PartialEq)]
pub struct SignalRow {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// Meaning.
    pub description: String,
    /// Values that are shown as -1 and 1.
    pub bounds: (f64, f64),
    /// Whether agents see it unless they say otherwise, and before which others.
    pub default: Option<u8>,
}

/// Rows of one vehicle or of several together; of a row that several have the first one's bounds and texts hold.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RowSet {
    /// Actuators.
    pub actions: Vec<ActionRow>,
    /// Signals in column order.
    pub signals: Vec<SignalRow>,
    /// Names of connections that the plant grants: `<member>_on_<loop>`.
    pub branches: Vec<String>,
}

/// Name of the row that tells whether a branch is granted.
#[must_use]
pub fn branch_name(layout: &Layout, branch: usize) -> String {
    let branch = layout.branches[branch];
    format!("{}_on_{}", layout.members[branch.member].name, layout.loops[branch.circuit].name)
}

/// An error for a name that is not there.
#[must_use]
pub fn unknown(kind: &'static str, name: &str, names: &[&str]) -> PlantError {
    let hint = among(names, name);
    let nearest = hint.find(" (nearest: ").map_or("", |place| &hint[place..]);
    PlantError::Unknown { kind, name: name.to_owned(), available: format!("{}{nearest}", names.join(", ")) }
}

impl RowSet {
    /// Rows of vehicles with these layouts.
    ///
    /// # Errors
    /// Two of them mean different things by the same name of an actuator.
    pub fn of<'a>(layouts: impl IntoIterator<Item = &'a Layout>) -> PlantResult<Self> {
        let mut set = Self::default();
        for layout in layouts {
            set.add_actions(layout)?;
            set.add_signals(layout);
            for name in (0..layout.branches.len()).map(|branch| branch_name(layout, branch)) {
                if !set.branches.contains(&name) {
                    set.branches.push(name);
                }
            }
        }
        Ok(set)
    }

    /// Names of all actuators.
    #[must_use]
    pub fn action_names(&self) -> Vec<&str> {
        self.actions.iter().map(|row| row.name.as_str()).collect()
    }

    fn add_actions(&mut self, layout: &Layout) -> PlantResult<()> {
        for actuator in &layout.actuators {
            let Some(known) = self.actions.iter_mut().find(|row| row.name == actuator.name) else {
                self.actions.push(ActionRow {
                    name: actuator.name.clone(),
                    unit: actuator.unit,
                    scale: actuator.scale.clone(),
                    description: actuator.description.clone(),
                    by_default: actuator.by_default(),
                    moves_heat: actuator.moves_heat(),
                    by_rules: actuator.by_default() || ruled(layout, actuator.purpose),
                });
                continue;
            };
            match (&mut known.scale, &actuator.scale) {
                (Scale::Choice(options), Scale::Choice(others)) => {
                    for other in others {
                        if !options.contains(other) {
                            options.push(other.clone());
                        }
                    }
                }
                (scale, other) if scale == other => {}
                _ => {
                    return Err(PlantError::InvalidArgument {
                        what: "vehicles".into(),
                        value: format!("a set with two kinds of actuator `{}`", actuator.name),
                        allowed: "must mean the same by the same name".into(),
                    });
                }
            }
        }
        Ok(())
    }

    fn add_signals(&mut self, layout: &Layout) {
        for signal in SignalTable::of(layout).rows() {
            if !self.signals.iter().any(|row| row.name == signal.name) {
                self.signals.push(SignalRow {
                    name: signal.name.clone(),
                    unit: signal.unit,
                    description: signal.description.clone(),
                    bounds: signal.bounds,
                    default: signal.default,
                });
            }
        }
    }
}

/// Whether rule-based controllers move a row that is no choice: recirculation, and requests of battery, front-end
/// exchangers and cabins.
fn ruled(layout: &Layout, purpose: Purpose) -> bool {
    let Purpose::Request(member) = purpose else { return false };
    matches!(layout.members[member].kind, MemberKind::Battery | MemberKind::FrontEnd | MemberKind::Cabin)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use hp_plant::config::vehicle::architecture;

    /// Rows of built-in architectures.
    pub(crate) fn rows_of(names: &[&str]) -> RowSet {
        let layouts: Vec<Layout> = names.iter().map(|name| architecture(name).expect("built in")).collect();
        RowSet::of(&layouts).expect("the same by the same name")
    }

    #[test]
    fn rows_of_several_cars_are_those_of_each_in_order_of_appearance() {
        let (one, both) = (rows_of(&["jeffs2019"]), rows_of(&["jeffs2019", "three-loops"]));
        assert_eq!(both.action_names()[..one.actions.len()], one.action_names());
        let options = |set: &RowSet, name: &str| match &set
            .actions
            .iter()
            .find(|row| row.name == name)
            .map(|row| &row.scale)
        {
            Some(Scale::Choice(options)) => options.clone(),
            other => panic!("{name}: {other:?}"),
        };
        let (before, after) = (options(&one, "battery"), options(&both, "battery"));
        assert_eq!(after[..before.len()], before);
        assert!(after.len() > before.len(), "{after:?}");
    }

    #[test]
    fn an_unknown_name_comes_with_the_nearest() {
        let set = rows_of(&["jeffs2019"]);
        let error = unknown("action", "compresor_power", &set.action_names()).to_string();
        assert!(error.ends_with("(nearest: compressor_power)"), "{error}");
    }
}
