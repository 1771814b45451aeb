//! Thermal switches: conductances under a PID that tracks the heat flow asked for (paper section 2.3).

use super::pid::IncrementalPid;
use crate::config::coolant::PidParameters;

/// Smallest temperature difference used to normalise the error [K].
const SMALLEST_DIFFERENCE_K: f64 = 0.1;

/// One control period of a switch; returns its position between 0 (isolated) and 1 (whole exchanger).
///
/// Error and output are normalised by what the exchanger could pass, so that the closed loop has the same
/// speed at any temperature difference.
pub fn track(
    switch: &mut IncrementalPid,
    gains: &PidParameters,
    request_w: f64,
    largest_conductance_w_k: f64,
    difference_k: f64,
    period_s: f64,
) -> f64 {
    let capacity_w = largest_conductance_w_k * difference_k.max(SMALLEST_DIFFERENCE_K);
    if capacity_w <= 0.0 {
        *switch = IncrementalPid::default();
        return 0.0;
    }
    let flow_w = switch.value() * largest_conductance_w_k * difference_k.max(0.0);
    let error = ((request_w - flow_w) / capacity_w).clamp(-1.0, 1.0);
    switch.update(gains, error, period_s, 0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GAINS: PidParameters = PidParameters { proportional: 0.1, integral: 0.2, derivative: 0.0 };

    proptest! {
        #[test]
        fn a_feasible_request_is_met_at_any_temperature_difference(
            difference in 0.5..80.0_f64, conductance in 5.0..500.0_f64, share in 0.05..0.95_f64,
        ) {
            let request = share * conductance * difference;
            let mut switch = IncrementalPid::default();
            for _ in 0..200 {
                track(&mut switch, &GAINS, request, conductance, difference, 1.0);
            }
            prop_assert!((switch.value() * conductance * difference - request).abs() < 1e-3 * request);
        }

        #[test]
        fn an_infeasible_request_opens_the_whole_exchanger(difference in 0.5..80.0_f64) {
            let mut switch = IncrementalPid::default();
            for _ in 0..50 {
                track(&mut switch, &GAINS, 1e6, 100.0, difference, 1.0);
            }
            prop_assert_eq!(switch.value(), 1.0);
        }
    }
}
