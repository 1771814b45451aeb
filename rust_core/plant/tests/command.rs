//! Commands: what is encoded is decoded.

use hp_plant::architecture::layout::ACTUATOR_PLACES;
use hp_plant::command::{ActuatorRanges, Command, Purpose, Scale};
use hp_plant::config::kinds::VEHICLE;
use hp_plant::config::library;
use hp_plant::config::vehicle::VehicleParameters;
use proptest::prelude::*;

fn vehicle(name: &str) -> VehicleParameters {
    VehicleParameters::load(name, &[]).expect("built-in vehicle")
}

fn ranges() -> ActuatorRanges {
    ActuatorRanges::of(&vehicle("jeffs2019"))
}

proptest! {
    #[test]
    fn any_command_means_the_same_after_decoding_and_encoding(
        values in prop::collection::vec(-1.0_f32..=1.0, ACTUATOR_PLACES),
    ) {
        let ranges = ranges();
        let mut command = Command::default();
        let count = ranges.count();
        command.0[..count].copy_from_slice(&values[..count]);
        let demand = ranges.decode(&command);
        let again = ranges.decode(&ranges.encode(&demand));
        for (row, actuator) in ranges.rows().iter().enumerate() {
            let (before, after) = (demand[row], again[row]);
            let allowed = match (&actuator.scale, actuator.purpose) {
                (Scale::Choice(_), _) => 0.0,
                (_, Purpose::Request(_)) => 0.01,
                _ => 1e-5 * (1.0 + before.abs()),
            };
            prop_assert!((before - after).abs() <= allowed, "{}: {} {}", actuator.name, before, after);
        }
        // What stands behind the last actuator is 0, whatever is in the command.
        prop_assert!(demand.0[count..].iter().all(|&value| value == 0.0));
        prop_assert!(ranges.encode(&demand).0[count..].iter().all(|&value| value == 0.0));
    }

    #[test]
    fn compressor_demand_is_off_or_within_its_range(value in -1.0_f32..=1.0) {
        let ranges = ranges();
        let row = ranges.row("compressor_power").expect("in the table");
        let (low, high) = ranges.range(row);
        let power = ranges.physical(row, value);
        prop_assert!(power == 0.0 || (power >= low * (1.0 - 1e-12) && power <= high * (1.0 + 1e-12)));
    }
}

/// Names of the default's actuators: agents, snapshots and files depend on their order.
#[test]
fn the_default_has_its_actuators_in_their_order() {
    let ranges = ranges();
    let names: Vec<&str> = ranges.rows().iter().map(|row| row.name.as_str()).collect();
    let members = ["battery", "motor", "transmission", "ambient", "thermal_battery", "cabin"];
    let mut expected: Vec<String> = members.map(str::to_owned).to_vec();
    expected.extend(
        ["ptc", "compressor_power", "recirculation", "blower_level", "htc_flow", "chiller_flow"]
            .map(str::to_owned),
    );
    expected.extend(members.map(|member| format!("{member}_request")));
    expected.extend(members.map(|member| format!("{member}_valve")));
    expected.extend(["cabin_set_point", "windscreen_share"].map(str::to_owned));
    assert_eq!(names, expected);
}

#[test]
fn options_of_every_connection_are_isolated_and_the_loops_of_its_branches() {
    for name in library::names(VEHICLE) {
        let vehicle = vehicle(name);
        let layout = &vehicle.layout;
        let ranges = ActuatorRanges::of(&vehicle);
        let mut connections = 0;
        for (row, actuator) in ranges.rows().iter().enumerate() {
            let Purpose::Connection(member) = actuator.purpose else { continue };
            connections += 1;
            let member = &layout.members[member];
            assert_eq!(member.connection_row, Some(row));
            let mut expected = vec!["isolated"];
            for (place, &branch) in member.options.iter().enumerate() {
                assert_eq!(layout.branches[branch].option, place + 1);
                expected.push(&layout.loops[layout.branches[branch].circuit].name);
            }
            assert_eq!(actuator.options(), expected, "{name}: {}", actuator.name);
            assert_eq!(ranges.range(row), (0.0, member.options.len() as f64));
        }
        let connectable = layout.members.iter().filter(|member| !member.options.is_empty()).count();
        assert_eq!(connections, connectable, "{name}");
    }
}
