//! Thermal switches between components and loops: conductances under a PID that tracks the heat flow asked for (paper section
//! 2.3), and the temperature differences at which they may close (section 2.4).

use super::pid::{IncrementalPid, PidParameters};
use crate::architecture::layout::BRANCH_PLACES;
use crate::parameters;
use serde::{Deserialize, Serialize};

parameters! {
    /// Thermal switches between components and loops.
    pub struct SwitchParameters {
        /// Temperature difference needed to close a connection [K].
        closing_difference_k: f64 = 0.0 .. 20.0,
        /// Temperature difference below which it opens again [K].
        opening_difference_k: f64 = 0.0 .. 20.0,
        ;
        /// Controller on the heat flow, both normalised by what the exchanger could pass.
        pid: PidParameters,
    }
}

/// Smallest temperature difference used to normalise the error [K].
const SMALLEST_DIFFERENCE_K: f64 = 0.1;

/// Controllers of all switches, each number of theirs side by side.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ThermalSwitches {
    output: [f64; BRANCH_PLACES],
    last_error: [f64; BRANCH_PLACES],
    last_change: [f64; BRANCH_PLACES],
    started: [bool; BRANCH_PLACES],
}

impl ThermalSwitches {
    /// One control period of the first so many switches; returns their positions between 0 (isolated) and 1 (whole exchanger).
    ///
    /// Error and output are normalised by what the exchanger could pass, so that the closed loop has the same
    /// speed at any temperature difference. A switch whose exchanger can pass nothing forgets everything.
    #[must_use]
    #[inline(always)]
    #[allow(clippy::needless_range_loop, reason = "several arrays, side by side")]
    pub fn track(
        &mut self,
        gains: &PidParameters,
        requests_w: &[f64; BRANCH_PLACES],
        largest_w_k: &[f64; BRANCH_PLACES],
        differences_k: &[f64; BRANCH_PLACES],
        period_s: f64,
        places: usize,
    ) -> [f64; BRANCH_PLACES] {
        let places = places.min(BRANCH_PLACES);
        let mut started = [0.0; BRANCH_PLACES];
        for i in 0..places {
            started[i] = f64::from(u8::from(self.started[i]));
        }
        let mut capacities_w = [0.0; BRANCH_PLACES];
        // Number by number and without branches, so that several switches are worked out at once.
        for i in 0..places {
            let capacity_w = largest_w_k[i] * differences_k[i].max(SMALLEST_DIFFERENCE_K);
            let flow_w = self.output[i] * largest_w_k[i] * differences_k[i].max(0.0);
            let error = ((requests_w[i] - flow_w) / capacity_w).clamp(-1.0, 1.0);
            let (output, change) = IncrementalPid::moved(
                gains,
                (self.output[i], self.last_change[i]),
                (error, started[i] * (error - self.last_error[i])),
                period_s,
                (0.0, 1.0),
            );
            let works = capacity_w > 0.0;
            self.output[i] = if works { output } else { 0.0 };
            self.last_error[i] = if works { error } else { 0.0 };
            self.last_change[i] = if works { change } else { 0.0 };
            capacities_w[i] = capacity_w;
        }
        for i in 0..places {
            self.started[i] = capacities_w[i] > 0.0;
        }
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
                BRANCH_PLACES,
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
        let mut track = |largest_w_k: &[f64; BRANCH_PLACES]| {
            switches.track(
                &GAINS,
                &[700.0; BRANCH_PLACES],
                largest_w_k,
                &[20.0; BRANCH_PLACES],
                1.0,
                BRANCH_PLACES,
            )
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
