//! The reference trip that attributable energy is measured against: the same cycle with battery, motor and oil
//! at 25 degC, pumps and blower at their lowest, no heating and no cooling.
//!
//! It depends on the scenario alone, never on the controller. Where motor or battery cannot follow the cycle, this trip falls
//! behind and drives the whole way too, so that energies are compared at equal distance.

use hp_plant::components::battery::BatteryState;
use hp_plant::components::body::RoadLoad;
use hp_plant::components::powertrain::Powertrain;
use hp_plant::components::reachable_speed::{TractionSupply, reachable_speed_m_s};
use hp_plant::config::Celsius;
use hp_plant::plant::{CONTROL_PERIOD_S, Disturbance, Plant};
use hp_trip::experiment::Experiment;
use hp_trip::pace::{LONGEST_DELAY_S, Pace};
use serde::{Deserialize, Serialize};

/// Temperature of battery, motor and oil on the reference trip.
pub const REFERENCE_TEMPERATURE: Celsius = Celsius(25.0);

/// Reference trip in progress.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ReferenceTrip {
    battery: BatteryState,
    pace: Pace,
    seconds: u32,
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
    pub fn start(experiment: &Experiment, battery: BatteryState) -> Self {
        Self { battery, pace: Pace::start(&experiment.cycle), seconds: 0 }
    }

    /// Drives a second, none once it has arrived; returns the chemical energy drawn from the cells [J].
    pub fn step(&mut self, experiment: &Experiment, conditions: &ReferenceConditions) -> f64 {
        let second = self.seconds as usize;
        if self.pace.arrived(&experiment.cycle, second) {
            return 0.0;
        }
        let disturbance = experiment.next_disturbance(second, &self.pace);
        let (energy_j, end_m_s) = self.drive(&experiment.plant, conditions, &disturbance);
        self.pace.drove(&experiment.cycle, second, disturbance.end_speed_m_s, end_m_s);
        self.seconds += 1;
        energy_j
    }

    /// Drives what is left of the way, for a trip that arrives before this one; returns as [`Self::step`] does.
    #[cold]
    pub fn finish(&mut self, experiment: &Experiment, conditions: &ReferenceConditions) -> f64 {
        let mut energy_j = 0.0;
        while self.seconds as usize <= experiment.cycle.duration_s() + LONGEST_DELAY_S
            && !self.pace.arrived(&experiment.cycle, self.seconds as usize)
        {
            energy_j += self.step(experiment, conditions);
        }
        energy_j
    }

    /// Whether the way is driven.
    #[must_use]
    pub fn arrived(&self, experiment: &Experiment) -> bool {
        self.pace.arrived(&experiment.cycle, self.seconds as usize)
    }

    /// A second on the road: chemical energy [J], and the speed at its end.
    fn drive(
        &mut self,
        plant: &Plant,
        conditions: &ReferenceConditions,
        disturbance: &Disturbance,
    ) -> (f64, f64) {
        let circuit = plant.battery.during(&self.battery, REFERENCE_TEMPERATURE.kelvin(), CONTROL_PERIOD_S);
        let limits = circuit.power_limits();
        let base_w = conditions.base_load_w;
        let mut end_m_s = disturbance.end_speed_m_s;
        let (mut road, mut powertrain) = pull(plant, conditions, disturbance, end_m_s);
        if road.wheel_power_w() >= 0.0 {
            let flow = powertrain.drive(road.wheel_power_w());
            let supply = TractionSupply {
                most_w: (limits.discharge_w - base_w).max(0.0),
                recovery_w: limits.charge_w + base_w,
            };
            if flow.electrical_power_w > supply.most_w
                || !powertrain.within_motor_limits(road.wheel_power_w(), &flow)
            {
                end_m_s = reachable_speed_m_s(end_m_s, supply, |end_m_s| {
                    let (road, powertrain) = pull(plant, conditions, disturbance, end_m_s);
                    (road.wheel_power_w(), powertrain)
                });
                (road, powertrain) = pull(plant, conditions, disturbance, end_m_s);
            }
        }
        let wheel_w = road.wheel_power_w();
        let traction = if wheel_w >= 0.0 {
            powertrain.drive(wheel_w)
        } else {
            powertrain.brake(-wheel_w, limits.charge_w + base_w)
        };
        let step = circuit.draw((traction.electrical_power_w + base_w).min(limits.discharge_w));
        self.battery = step.state;
        (step.chemical_power_w * CONTROL_PERIOD_S, end_m_s)
    }
}

/// What a second that ends at a speed asks of the powertrain.
fn pull<'a>(
    plant: &'a Plant,
    conditions: &ReferenceConditions,
    disturbance: &Disturbance,
    end_m_s: f64,
) -> (RoadLoad, Powertrain<'a>) {
    let vehicle = &plant.vehicle;
    let start_m_s = disturbance.start_speed_m_s;
    let speed_m_s = 0.5 * (start_m_s + end_m_s);
    let powertrain = Powertrain {
        motor: &vehicle.motor,
        transmission: &vehicle.transmission,
        regeneration: &vehicle.regeneration,
        speed_m_s,
        spin_loss_w: conditions.spin_loss_w_s_m * speed_m_s,
        motor_share: vehicle.motor.available_share(REFERENCE_TEMPERATURE.kelvin()),
    };
    (vehicle.body.road_load(start_m_s, end_m_s, CONTROL_PERIOD_S, &disturbance.road()), powertrain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use hp_plant::config::library::Override;
    use hp_plant::flows::Flow;

    /// The definition itself: a vehicle with everything off whose battery, motor and oil are put back to 25 degC
    /// before every second.
    #[test]
    fn reference_trip_is_the_plant_with_everything_off_held_at_25_degc() {
        let weak = ["vehicle.motor.maximum_mechanical_power_w=30000.0"];
        for (scenario, overrides) in [
            ("jeffs2019/case1-1", &[][..]),
            ("ours/hot-soak-plus35", &[]),
            ("ours/commute-minus5", &[]),
            ("jeffs2019/case1-1", &weak),
        ] {
            let overrides: Vec<_> =
                overrides.iter().map(|text| Override::parse(text).expect("valid")).collect();
            let experiment = Experiment::load(scenario, None, &overrides).expect("built in");
            let plant = &experiment.plant;
            let layout = plant.layout();
            let mut off = plant.ranges.idle();
            layout.cabins.iter().for_each(|cabin| off[cabin.blower_row] = 0.0);
            layout.loops.iter().for_each(|circuit| off[circuit.flow_row] = 0.0);
            let command = plant.ranges.encode(&off);
            let mut state = experiment.start().state;
            let mut trip = ReferenceTrip::start(&experiment, state.battery);
            let conditions = ReferenceConditions::of(&experiment);
            let (mut pace, mut step) = (Pace::start(&experiment.cycle), 0);
            while !pace.arrived(&experiment.cycle, step) {
                assert!(!trip.arrived(&experiment));
                let disturbance = experiment.next_disturbance(step, &pace);
                for node in [layout.battery, layout.motor, layout.transmission] {
                    state.temperatures_k[node.index()] = REFERENCE_TEMPERATURE.kelvin();
                }
                let record = plant.step(&mut state, &command, &disturbance);
                pace.drove(&experiment.cycle, step, disturbance.end_speed_m_s, record.end_speed_m_s);
                step += 1;
                let (expected, found) = (record.flows[Flow::CHEMICAL], trip.step(&experiment, &conditions));
                assert!(
                    (found - expected).abs() < 1e-6,
                    "{scenario}, second {step}: {found} and {expected} J"
                );
            }
            assert!(trip.arrived(&experiment));
            assert_eq!(step > experiment.cycle.duration_s(), !overrides.is_empty(), "{scenario}");
            assert_eq!(
                (trip.step(&experiment, &conditions), trip.finish(&experiment, &conditions)),
                (0.0, 0.0)
            );
        }
    }
}
