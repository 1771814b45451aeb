//! Thermal switches: conductances under a PID that tracks the heat flow asked for (paper section 2.3).

use crate::circuits::branches::{BRANCH_PLACES, BranchValues};
use crate::components::pid::IncrementalPid;
use crate::components::pid::PidParameters;
use serde::{Deserialize, Serialize};
use std::array::from_fn;

/// Smallest temperature difference used to normalise the error [K].
const SMALLEST_DIFFERENCE_K: f64 = 0.1;

/// Controllers of all switches, each number of theirs side by side.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ThermalSwitches {
    output: BranchValues,
    last_error: BranchValues,
    last_change: BranchValues,
    started: [bool; BRANCH_PLACES],
}

impl ThermalSwitches {
    /// One control period; returns the positions between 0 (isolated) and 1 (whole exchanger).
    ///
    /// Error and output are normalised by what the exchanger could pass, so that the closed loop has the same
    /// speed at any temperature difference. A switch whose exchanger can pass nothing forgets everything.
    #[must_use]
    #[inline]
    pub fn track(
        &mut self,
        gains: &PidParameters,
        requests_w: &BranchValues,
        largest_w_k: &BranchValues,
        differences_k: &BranchValues,
        period_s: f64,
    ) -> BranchValues {
        // Number by number, so that several switches are worked out at once.
        let capacities_w: BranchValues =
            from_fn(|i| largest_w_k[i] * differences_k[i].max(SMALLEST_DIFFERENCE_K));
        let errors: BranchValues = from_fn(|i| {
            let flow_w = self.output[i] * largest_w_k[i] * differences_k[i].max(0.0);
            ((requests_w[i] - flow_w) / capacities_w[i]).clamp(-1.0, 1.0)
        });
        let before = *self;
        let after = |i: usize| {
            let pid = IncrementalPid {
                output: before.output[i],
                last_error: before.last_error[i],
                last_change: before.last_change[i],
                started: before.started[i],
            };
            pid.updated(gains, errors[i], period_s, 0.0, 1.0)
        };
        let kept = |i: usize, number: f64| if capacities_w[i] > 0.0 { number } else { 0.0 };
        *self = Self {
            output: from_fn(|i| kept(i, after(i).output)),
            last_error: from_fn(|i| kept(i, after(i).last_error)),
            last_change: from_fn(|i| kept(i, after(i).last_change)),
            started: capacities_w.map(|capacity_w| capacity_w > 0.0),
        };
        self.output
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GAINS: PidParameters = PidParameters { proportional: 0.1, integral: 0.2, derivative: 0.0 };

    /// Position of a switch after some seconds; all places hold the same.
    fn settled(request_w: f64, largest_w_k: f64, difference_k: f64, seconds: usize) -> f64 {
        let mut switches = ThermalSwitches::default();
        let mut position = 0.0;
        for _ in 0..seconds {
            let [first, others @ ..] = switches.track(
                &GAINS,
                &[request_w; BRANCH_PLACES],
                &[largest_w_k; BRANCH_PLACES],
                &[difference_k; BRANCH_PLACES],
                1.0,
            );
            assert!(others.iter().all(|&other| other == first));
            position = first;
        }
        position
    }

    proptest! {
        #[test]
        fn a_feasible_request_is_met_at_any_temperature_difference(
            difference in 0.5..80.0_f64, conductance in 5.0..500.0_f64, share in 0.05..0.95_f64,
        ) {
            let request = share * conductance * difference;
            let position = settled(request, conductance, difference, 200);
            prop_assert!((position * conductance * difference - request).abs() < 1e-3 * request);
        }

        #[test]
        fn an_infeasible_request_opens_the_whole_exchanger(difference in 0.5..80.0_f64) {
            prop_assert_eq!(settled(1e6, 100.0, difference, 50), 1.0);
        }
    }

    #[test]
    fn a_switch_that_can_pass_nothing_forgets_everything_and_leaves_the_others_alone() {
        let mut switches = ThermalSwitches::default();
        let mut largest_w_k = [100.0; BRANCH_PLACES];
        let mut track = |largest_w_k: &BranchValues| {
            switches.track(&GAINS, &[700.0; BRANCH_PLACES], largest_w_k, &[20.0; BRANCH_PLACES], 1.0)
        };
        let first = track(&largest_w_k);
        let second = track(&largest_w_k);
        largest_w_k[3] = 0.0;
        let third = track(&largest_w_k);
        assert_eq!(third[3], 0.0);
        assert!(third[2] > second[2]);
        largest_w_k[3] = 100.0;
        assert_eq!(track(&largest_w_k)[3], first[3]);
    }
}
