//! Commands: what is encoded is decoded.

use hp_plant::command::{ACTUATOR_COUNT, ACTUATORS, ActuatorRanges, Command, Member, Scale};
use hp_plant::config::kinds::VEHICLE;
use hp_plant::config::library;
use proptest::prelude::*;

fn ranges() -> ActuatorRanges {
    ActuatorRanges::of(&library::load(VEHICLE, "jeffs2019", &[]).expect("built-in vehicle"))
}

proptest! {
    #[test]
    fn any_command_means_the_same_after_decoding_and_encoding(values in prop::array::uniform25(-1.0_f32..=1.0)) {
        let ranges = ranges();
        let demand = ranges.decode(&Command(values));
        let again = ranges.decode(&ranges.encode(&demand));
        prop_assert_eq!(demand.connections, again.connections);
        prop_assert_eq!(demand.ptc_allowed, again.ptc_allowed);
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-5 * (1.0 + a.abs());
        prop_assert!(close(demand.compressor_power_w, again.compressor_power_w));
        prop_assert!(close(demand.htc_flow_kg_s, again.htc_flow_kg_s));
        prop_assert!(demand.requests_w.iter().zip(again.requests_w).all(|(&a, b)| (a - b).abs() < 0.01));
        prop_assert!(close(demand.cabin_set_point_k, again.cabin_set_point_k));
    }

    #[test]
    fn compressor_demand_is_off_or_within_its_range(value in -1.0_f32..=1.0) {
        let ranges = ranges();
        let row = ACTUATORS.iter().position(|a| a.name == "compressor_power").expect("in the table");
        let (low, high) = ranges.range(row);
        let power = ranges.physical(row, value);
        prop_assert!(power == 0.0 || (power >= low * (1.0 - 1e-12) && power <= high * (1.0 + 1e-12)));
    }
}

#[test]
fn options_of_members_agree_with_the_actuator_table() {
    for (row, member) in Member::ALL.into_iter().enumerate() {
        let Scale::Choice(options) = ACTUATORS[row].scale else { panic!("{member:?} is no choice") };
        let names: Vec<String> = member.options().iter().map(|o| format!("{o:?}").to_lowercase()).collect();
        assert_eq!(names, options);
    }
    assert_eq!(ACTUATORS.len(), ACTUATOR_COUNT);
}
