//! Pairs of values of a vehicle of which one must not pass the other; their ranges alone cannot tell.

use super::Violation;
use super::vehicle::VehicleParameters;

/// Two keys of one section whose values must be in order.
struct Pair {
    section: String,
    low: (&'static str, f64),
    high: (&'static str, f64),
}

/// Checks all pairs.
///
/// # Errors
/// The first value that passes the one it belongs to.
pub fn check(vehicle: &VehicleParameters) -> Result<(), Violation> {
    for Pair { section, low, high } in pairs(vehicle) {
        if low.1 > high.1 {
            let allowed = format!("must not exceed {} ({})", high.0, high.1);
            return Err(Violation::new(format!("{section}.{}", low.0), low.1, allowed));
        }
    }
    Ok(())
}

fn pairs(vehicle: &VehicleParameters) -> Vec<Pair> {
    let battery = &vehicle.battery;
    let mut pairs = vec![Pair {
        section: "battery".to_owned(),
        low: ("minimum_cell_voltage_v", battery.minimum_cell_voltage_v),
        high: ("maximum_cell_voltage_v", battery.maximum_cell_voltage_v),
    }];
    for (layout, cabin) in vehicle.layout.cabins.iter().zip(&vehicle.cabins) {
        pairs.push(Pair {
            section: vehicle.layout.members[layout.member].section.clone(),
            low: ("minimum_air_flow_kg_s", cabin.parameters.minimum_air_flow_kg_s),
            high: ("maximum_air_flow_kg_s", cabin.parameters.maximum_air_flow_kg_s),
        });
    }
    for (layout, parameters) in vehicle.layout.loops.iter().zip(&vehicle.loops) {
        let circuit = &parameters.circuit;
        pairs.push(Pair {
            section: format!("{}.circuit.pump", layout.name),
            low: ("minimum_flow_kg_s", circuit.pump.minimum_flow_kg_s),
            high: ("maximum_flow_kg_s", circuit.pump.maximum_flow_kg_s),
        });
        pairs.push(Pair {
            section: format!("{}.circuit", layout.name),
            low: ("valve_closed", circuit.valve_closed),
            high: ("valve_open", circuit.valve_open),
        });
    }
    if let Some(refrigeration) = &vehicle.refrigeration {
        let compressor = &refrigeration.compressor;
        let section = || "refrigeration.compressor".to_owned();
        pairs.push(Pair {
            section: section(),
            low: ("minimum_power_w", compressor.minimum_power_w),
            high: ("maximum_power_w", compressor.maximum_power_w),
        });
        pairs.push(Pair {
            section: section(),
            low: ("minimum_speed_rev_s", compressor.minimum_speed_rev_s),
            high: ("maximum_speed_rev_s", compressor.maximum_speed_rev_s),
        });
    }
    pairs
}
