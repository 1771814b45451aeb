//! Effectiveness-NTU relations (Bergman et al., chapter 11).

use crate::numerics::elementary;

/// Conductance between the two inlet temperatures when one side is (nearly) isothermal [W/K].
///
/// `G = C (1 - exp(-UA / C))` with the capacity rate `C` of the flowing side; never above `C`.
#[must_use]
#[inline]
pub fn inlet_conductance_w_k(capacity_rate_w_k: f64, ua_w_k: f64) -> f64 {
    let conductance_w_k = -capacity_rate_w_k * elementary::exp_m1(-ua_w_k / capacity_rate_w_k);
    if capacity_rate_w_k <= 0.0 { 0.0 } else { conductance_w_k }
}

/// Conductance between the inlet temperatures of two flows in counterflow [W/K].
#[must_use]
#[inline]
pub fn counterflow_conductance_w_k(
    first_capacity_rate_w_k: f64,
    second_capacity_rate_w_k: f64,
    ua_w_k: f64,
) -> f64 {
    let small = first_capacity_rate_w_k.min(second_capacity_rate_w_k);
    let large = first_capacity_rate_w_k.max(second_capacity_rate_w_k);
    if small <= 0.0 {
        return 0.0;
    }
    let ratio = small / large;
    let transfer_units = ua_w_k / small;
    let effectiveness = if ratio > 1.0 - 1e-9 {
        transfer_units / (1.0 + transfer_units)
    } else {
        let decay = elementary::exp(-transfer_units * (1.0 - ratio));
        (1.0 - decay) / (1.0 - ratio * decay)
    };
    effectiveness * small
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn conductance_is_below_capacity_rate_and_below_ua(c in 1e-6..5000.0_f64, ua in 0.1..5000.0_f64) {
            let g = inlet_conductance_w_k(c, ua);
            prop_assert!(g >= 0.0 && g <= c * (1.0 + 1e-12) && g <= ua * (1.0 + 1e-12));
        }

        #[test]
        fn counterflow_is_symmetric_and_beats_nothing_it_cannot(
            a in 1.0..2000.0_f64, b in 1.0..2000.0_f64, ua in 0.1..5000.0_f64,
        ) {
            let g = counterflow_conductance_w_k(a, b, ua);
            prop_assert!((g - counterflow_conductance_w_k(b, a, ua)).abs() < 1e-9);
            prop_assert!(g <= a.min(b) * (1.0 + 1e-12));
            prop_assert!(g <= inlet_conductance_w_k(a.min(b), ua) * (1.0 + 1e-9));
        }
    }
}
