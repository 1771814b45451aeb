//! Which rows of an observation a vehicle can leave: its own limits beside the bounds that are shown.

use crate::observation::ObservationTable;
use hp_plant::config::vehicle::VehicleParameters;

/// A row whose bounds are narrower than what a vehicle can reach.
#[derive(Debug, Clone, PartialEq)]
pub struct Narrow {
    /// Vehicle by name or path.
    pub vehicle: String,
    /// Row.
    pub row: String,
    /// Its upper bound.
    pub high: f64,
    /// What the vehicle can reach.
    pub limit: f64,
}

/// Limits of a vehicle by the names of rows.
fn limits(vehicle: &VehicleParameters) -> Vec<(String, f64)> {
    let mut limits = Vec::new();
    if let Some(refrigeration) = &vehicle.refrigeration {
        let compressor = &refrigeration.compressor;
        limits.extend([
            ("compressor_power_w".to_owned(), compressor.maximum_power_w),
            ("compressor_speed_rev_s".to_owned(), compressor.maximum_speed_rev_s),
            ("discharge_temperature_degc".to_owned(), compressor.maximum_discharge_temperature_degc),
            ("condensing_pressure_bar".to_owned(), refrigeration.maximum_pressure_bar),
        ]);
    }
    for (place, heater) in vehicle.layout.heaters.iter().enumerate() {
        let column = vehicle.layout.flows.iter().find(|row| row.flow == heater.flow);
        limits.extend(column.map(|row| (row.column.clone(), vehicle.heaters[place].maximum_power_w)));
    }
    for (circuit, parameters) in vehicle.layout.loops.iter().zip(&vehicle.loops) {
        limits.push((format!("{}_flow_kg_s", circuit.name), parameters.circuit.pump.maximum_flow_kg_s));
    }
    limits
}

/// Rows that a vehicle can leave upwards.
#[must_use]
pub fn narrow(table: &ObservationTable, name: &str, vehicle: &VehicleParameters) -> Vec<Narrow> {
    let row_of = |name: &str| table.rows().iter().find(|row| row.name == name);
    limits(vehicle)
        .into_iter()
        .filter_map(|(row, limit)| {
            let high = row_of(&row)?.high;
            (limit > high).then(|| Narrow { vehicle: name.to_owned(), row, high, limit })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::{Origin, Settings, Setup};
    use hp_plant::config::kinds::VEHICLE;

    fn narrow_of(vehicle: &str, settings: &Settings) -> Vec<Narrow> {
        let origin = Origin {
            scenario: Some("jeffs2019/case1-1".to_owned()),
            vehicle: Some(vehicle.to_owned()),
            ..Origin::default()
        };
        Setup::new(settings, &[origin]).expect("built in").0.narrow.clone()
    }

    #[test]
    fn every_built_in_vehicle_stays_within_the_bounds() {
        for (name, _) in VEHICLE.files {
            assert_eq!(narrow_of(name, &Settings::default()), [], "{name}");
        }
    }

    #[test]
    fn a_wider_car_is_told_with_the_row_and_its_limit() {
        let wide = Settings {
            overrides: vec!["vehicle.refrigeration.compressor.maximum_power_w=9000".to_owned()],
            ..Settings::default()
        };
        let found = narrow_of("jeffs2019", &wide);
        assert_eq!(found.len(), 1);
        assert_eq!(
            (found[0].row.as_str(), found[0].high, found[0].limit),
            ("compressor_power_w", 8000.0, 9000.0)
        );
    }
}
