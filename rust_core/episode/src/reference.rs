//! The reference trip that attributable energy is measured against: the same cycle with battery, motor and oil
//! at 25 degC, pumps and blower at their lowest, no heating and no cooling.
//!
//! It depends on the scenario alone, never on the controller.

use hp_plant::components::battery::BatteryState;
use hp_plant::components::powertrain::Powertrain;
use hp_plant::config::Celsius;
use hp_plant::plant::{CONTROL_PERIOD_S, Disturbance, Plant};
use hp_trip::experiment::Experiment;
use serde::{Deserialize, Serialize};

/// Temperature of battery, motor and oil on the reference trip.
pub const REFERENCE_TEMPERATURE: Celsius = Celsius(25.0);

/// Reference trip in progress.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ReferenceTrip {
    battery: BatteryState,
}

/// What does not change during a reference trip.
#[derive(Debug, Clone)]
pub struct ReferenceConditions {
    base_load_w: f64,
    /// Spin loss of the transmission at 1 m/s, proportional to speed.
    spin_loss_w_s_m: f64,
}

impl ReferenceConditions {
    /// Conditions of a scenario.
    #[must_use]
    pub fn of(experiment: &Experiment) -> Self {
        let vehicle = &experiment.plant.vehicle;
        let pumps_w = vehicle.loops.iter().map(|circuit| {
            let pump = &circuit.circuit.pump;
            pump.power_w(pump.minimum_flow_kg_s)
        });
        let blowers_w =
            vehicle.cabins.iter().map(|cabin| cabin.parameters.ventilation(0.0, 0.0, 1.0).blower_power_w);
        Self {
            spin_loss_w_s_m: vehicle.transmission.spin_loss_w(REFERENCE_TEMPERATURE.kelvin(), 1.0),
            base_load_w: pumps_w
                .chain(blowers_w)
                .fold(vehicle.controls.auxiliary_power_w, |sum, power| sum + power),
        }
    }
}

impl ReferenceTrip {
    /// Before the first second.
    #[must_use]
    pub fn start(battery: BatteryState) -> Self {
        Self { battery }
    }

    /// Drives a second; returns the chemical energy drawn from the cells [J].
    pub fn step(
        &mut self,
        plant: &Plant,
        conditions: &ReferenceConditions,
        disturbance: &Disturbance,
    ) -> f64 {
        let vehicle = &plant.vehicle;
        let (start_m_s, end_m_s) = (disturbance.start_speed_m_s, disturbance.end_speed_m_s);
        let speed_m_s = 0.5 * (start_m_s + end_m_s);
        let temperature_k = REFERENCE_TEMPERATURE.kelvin();
        let road = vehicle.body.road_load(start_m_s, end_m_s, CONTROL_PERIOD_S, &disturbance.air);
        let wheel_w = road.wheel_power_w();
        let powertrain = Powertrain {
            motor: &vehicle.motor,
            transmission: &vehicle.transmission,
            regeneration: &vehicle.regeneration,
            speed_m_s,
            spin_loss_w: conditions.spin_loss_w_s_m * speed_m_s,
        };
        let circuit = plant.battery.during(&self.battery, temperature_k, CONTROL_PERIOD_S);
        let limits = circuit.power_limits();
        let traction = if wheel_w >= 0.0 {
            powertrain.drive(wheel_w)
        } else {
            powertrain.brake(-wheel_w, limits.charge_w + conditions.base_load_w)
        };
        let step =
            circuit.draw((traction.electrical_power_w + conditions.base_load_w).min(limits.discharge_w));
        self.battery = step.state;
        step.chemical_power_w * CONTROL_PERIOD_S
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hp_plant::flows::Flow;

    /// The definition itself: a vehicle with everything off whose battery, motor and oil are put back to 25 degC
    /// before every second.
    #[test]
    fn reference_trip_is_the_plant_with_everything_off_held_at_25_degc() {
        for scenario in ["jeffs2019/case1-1", "ours/hot-soak-plus35", "ours/commute-minus5"] {
            let experiment = Experiment::load(scenario, None, &[]).expect("built in");
            let plant = &experiment.plant;
            let layout = plant.layout();
            let mut off = plant.ranges.idle();
            layout.cabins.iter().for_each(|cabin| off[cabin.blower_row] = 0.0);
            layout.loops.iter().for_each(|circuit| off[circuit.flow_row] = 0.0);
            let command = plant.ranges.encode(&off);
            let mut state = experiment.start().state;
            let mut trip = ReferenceTrip::start(state.battery);
            let conditions = ReferenceConditions::of(&experiment);
            for step in 0..experiment.cycle.duration_s() {
                let disturbance = experiment.disturbance(step);
                for node in [layout.battery, layout.motor, layout.transmission] {
                    state.temperatures_k[node.index()] = REFERENCE_TEMPERATURE.kelvin();
                }
                let expected = plant.step(&mut state, &command, &disturbance).flows[Flow::CHEMICAL];
                let found = trip.step(plant, &conditions, &disturbance);
                assert!(
                    (found - expected).abs() < 1e-6,
                    "{scenario}, second {step}: {found} and {expected} J"
                );
            }
        }
    }
}
