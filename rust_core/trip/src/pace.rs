//! How far a vehicle is along its cycle, and the driver, who asks it for a speed each second.
//!
//! The driver asks for the cycle's speed. A vehicle that cannot deliver it falls behind and goes on: it accelerates as much as
//! it can until it has the cycle's speed again, and is never faster. What is missing where the cycle ends is driven afterwards,
//! so that every trip that arrives is as long as its cycle.

use crate::drive_cycle::DriveCycle;
use hp_plant::components::motor::STANDSTILL_SPEED_M_S;
use hp_plant::plant::CONTROL_PERIOD_S;
use serde::{Deserialize, Serialize};

/// Distance that a vehicle may be behind where it arrives [m].
pub const ARRIVAL_TOLERANCE_M: f64 = 1.0;

/// Longest time that a vehicle may take beyond its cycle [s]: a quarter of an hour.
pub const LONGEST_DELAY_S: usize = 900;

/// Longest time that a vehicle may stand while its driver wants to move [s].
pub const LONGEST_STANDSTILL_S: u32 = 300;

/// Acceleration and deceleration while the missing distance is driven [m/s2] (ours; comfortable: UDDS has at most 1.5).
const COMFORTABLE_M_S2: f64 = 1.0;

/// The missing distance is driven at the mean speed of so much of the cycle's end, standstills left out [s] (ours).
const LAST_PART_S: usize = 300;

/// A vehicle on its cycle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pace {
    /// Speed of the vehicle [m/s].
    pub speed_m_s: f64,
    /// Distance that it is behind its cycle [m].
    pub behind_m: f64,
    /// Time for which it has stood although the driver wanted to move [s].
    pub stuck_s: u32,
}

impl Pace {
    /// At the start of a cycle.
    #[must_use]
    pub fn start(cycle: &DriveCycle) -> Self {
        Self { speed_m_s: cycle.speeds_m_s()[0], behind_m: 0.0, stuck_s: 0 }
    }

    /// Speed that the driver asks for at the end of a second [m/s].
    #[must_use]
    #[inline]
    pub fn wanted_m_s(&self, cycle: &DriveCycle, second: usize) -> f64 {
        match cycle.speeds_m_s().get(second + 1) {
            Some(&speed_m_s) => speed_m_s,
            None => self.wanted_afterwards_m_s(cycle),
        }
    }

    /// A second at whose end the vehicle has a speed, and the driver had asked for another.
    #[inline]
    pub fn drove(&mut self, cycle: &DriveCycle, second: usize, wanted_m_s: f64, end_m_s: f64) {
        let way_m = |start_m_s: f64, end_m_s: f64| 0.5 * (start_m_s + end_m_s) * CONTROL_PERIOD_S;
        self.behind_m -= way_m(self.speed_m_s, end_m_s);
        if let [start_m_s, end_m_s, ..] = cycle.speeds_m_s()[second.min(cycle.duration_s())..] {
            self.behind_m += way_m(start_m_s, end_m_s);
        }
        let stands = self.speed_m_s.max(end_m_s) <= STANDSTILL_SPEED_M_S;
        self.stuck_s = if stands && wanted_m_s > STANDSTILL_SPEED_M_S { self.stuck_s + 1 } else { 0 };
        self.speed_m_s = end_m_s;
    }

    /// Whether the whole way of the cycle is driven after so many seconds.
    #[must_use]
    #[inline]
    pub fn arrived(&self, cycle: &DriveCycle, seconds: usize) -> bool {
        if seconds < cycle.duration_s() {
            return false;
        }
        if last_m_s(cycle) > STANDSTILL_SPEED_M_S {
            // Under way, half a second's way is as near as whole seconds come.
            return self.behind_m <= ARRIVAL_TOLERANCE_M.max(0.5 * self.speed_m_s * CONTROL_PERIOD_S);
        }
        self.behind_m <= ARRIVAL_TOLERANCE_M && self.speed_m_s <= STANDSTILL_SPEED_M_S
    }

    /// Speed asked for once the cycle is over: the mean of its last part, then a stop where its way ends. Where the cycle
    /// ends under way, its last speed, a little less if whole seconds then end where the way does.
    #[cold]
    fn wanted_afterwards_m_s(&self, cycle: &DriveCycle) -> f64 {
        let fastest_m_s = self.speed_m_s + COMFORTABLE_M_S2 * CONTROL_PERIOD_S;
        let last_m_s = last_m_s(cycle);
        let left_m = self.behind_m - 0.5 * self.speed_m_s * CONTROL_PERIOD_S;
        if last_m_s > STANDSTILL_SPEED_M_S {
            let seconds = (left_m / last_m_s + 0.5).ceil().max(1.0);
            return (left_m / (seconds - 0.5)).clamp(0.9 * last_m_s, last_m_s).min(fastest_m_s);
        }
        // From v at the end of this second a stop takes v/2 + v^2/(2 a) in all.
        let room = 0.25 + 2.0 * left_m / COMFORTABLE_M_S2;
        let to_stop_m_s = COMFORTABLE_M_S2 * (room.max(0.25).sqrt() - 0.5);
        cruising_m_s(cycle).min(fastest_m_s).min(to_stop_m_s)
    }
}

fn last_m_s(cycle: &DriveCycle) -> f64 {
    cycle.speeds_m_s()[cycle.duration_s()]
}

/// Mean speed of a cycle's last part, or of the whole if it stands there, standstills left out [m/s].
fn cruising_m_s(cycle: &DriveCycle) -> f64 {
    let speeds_m_s = cycle.speeds_m_s();
    let mean_m_s = |part: &[f64]| {
        let moving = part.iter().filter(|&&speed_m_s| speed_m_s > STANDSTILL_SPEED_M_S);
        let (count, sum_m_s) =
            moving.fold((0.0, 0.0), |(count, sum), speed_m_s| (count + 1.0, sum + speed_m_s));
        (count > 0.0).then(|| sum_m_s / count)
    };
    let last = &speeds_m_s[speeds_m_s.len().saturating_sub(LAST_PART_S)..];
    mean_m_s(last).or_else(|| mean_m_s(speeds_m_s)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cycle(speeds_km_h: &[f64]) -> DriveCycle {
        let rows = speeds_km_h.iter().enumerate().map(|(second, speed)| format!("{second},{speed}\n"));
        DriveCycle::from_csv("test", &format!("time_s,speed_km_h\n{}", rows.collect::<String>()))
            .expect("a cycle")
    }

    /// Drives with a vehicle that reaches at most a share of each rise that it is asked for.
    fn drive(cycle: &DriveCycle, share: f64) -> (Pace, usize, f64) {
        let (mut pace, mut second, mut way_m) = (Pace::start(cycle), 0, 0.0);
        while !pace.arrived(cycle, second) && second < cycle.duration_s() + LONGEST_DELAY_S {
            let wanted_m_s = pace.wanted_m_s(cycle, second);
            let end_m_s = if wanted_m_s > pace.speed_m_s {
                pace.speed_m_s + share * (wanted_m_s - pace.speed_m_s)
            } else {
                wanted_m_s
            };
            way_m += 0.5 * (pace.speed_m_s + end_m_s);
            pace.drove(cycle, second, wanted_m_s, end_m_s);
            second += 1;
        }
        (pace, second, way_m)
    }

    proptest! {
        #[test]
        fn the_whole_way_is_driven_by_slow_vehicles_too(
            speeds in prop::collection::vec(0.0..130.0_f64, 20..200), share in 0.05..1.0_f64,
        ) {
            let mut speeds = speeds;
            speeds.push(0.0);
            let cycle = cycle(&speeds);
            let (pace, second, way_m) = drive(&cycle, share);
            prop_assert!(pace.arrived(&cycle, second), "{pace:?} after {second} s");
            prop_assert!((way_m - cycle.distance_m()).abs() <= ARRIVAL_TOLERANCE_M);
            prop_assert!((pace.behind_m - (cycle.distance_m() - way_m)).abs() < 1e-6);
        }

        #[test]
        fn a_cycle_that_ends_under_way_is_driven_to_half_a_second(
            speeds in prop::collection::vec(0.0..130.0_f64, 20..200), last in 10.0..130.0_f64, share in 0.1..1.0_f64,
        ) {
            let mut speeds = speeds;
            speeds.push(last);
            let cycle = cycle(&speeds);
            let (pace, second, way_m) = drive(&cycle, share);
            prop_assert!(pace.arrived(&cycle, second), "{pace:?} after {second} s");
            prop_assert!((way_m - cycle.distance_m()).abs() <= (0.5 * last / 3.6).max(ARRIVAL_TOLERANCE_M));
        }
    }

    #[test]
    fn a_vehicle_that_follows_is_never_behind_and_arrives_with_its_cycle() {
        let cycle = cycle(&[0.0, 13.7, 29.1, 51.3, 0.0, 0.0, 12.0, 0.0]);
        let (pace, second, way_m) = drive(&cycle, 1.0);
        assert_eq!((pace, second), (Pace { speed_m_s: 0.0, behind_m: 0.0, stuck_s: 0 }, 7));
        assert_eq!(way_m, cycle.distance_m());
    }

    #[test]
    fn what_is_missing_is_driven_at_the_mean_speed_of_the_end_within_comfort() {
        let mut speeds = vec![36.0; 400];
        speeds.extend([0.0; 50]);
        let cycle = cycle(&speeds);
        let mut pace = Pace { speed_m_s: 0.0, behind_m: 500.0, stuck_s: 0 };
        let mut driven_m_s = vec![0.0];
        let mut second = cycle.duration_s();
        while !pace.arrived(&cycle, second) {
            let wanted_m_s = pace.wanted_m_s(&cycle, second);
            pace.drove(&cycle, second, wanted_m_s, wanted_m_s);
            driven_m_s.push(wanted_m_s);
            second += 1;
        }
        let steps = driven_m_s.windows(2).map(|pair| pair[1] - pair[0]);
        assert!(steps.clone().all(|step| (-1.3..=1.0 + 1e-12).contains(&step)), "{driven_m_s:?}");
        assert!((driven_m_s.iter().copied().fold(0.0, f64::max) - 10.0).abs() < 1e-9);
        // 10 s to 10 m/s, 40 s there, 10 s to a stop.
        assert!((60..=63).contains(&(second - cycle.duration_s())), "{}", second - cycle.duration_s());
        assert!(pace.behind_m.abs() <= ARRIVAL_TOLERANCE_M);
    }

    #[test]
    fn time_stood_counts_only_while_the_driver_wants_to_move() {
        let cycle = cycle(&[0.0, 0.0, 10.0, 10.0, 10.0]);
        let mut pace = Pace::start(&cycle);
        let stuck: Vec<u32> = (0..4)
            .map(|second| {
                let wanted_m_s = pace.wanted_m_s(&cycle, second);
                pace.drove(&cycle, second, wanted_m_s, if second == 3 { 1.0 } else { 0.0 });
                pace.stuck_s
            })
            .collect();
        assert_eq!(stuck, [0, 1, 2, 0]);
    }
}
