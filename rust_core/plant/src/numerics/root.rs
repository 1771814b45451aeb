//! Bracketed root and maximum of functions of one variable.

/// A root of a continuous `function` with `function(low) <= 0 <= function(high)` or the reverse.
///
/// Illinois regula falsi with every third step a bisection, so the bracket shrinks whatever the function does.
/// Stops at `|f| <= tolerance` or when the bracket has closed to round-off.
pub fn bracketed_root(
    mut function: impl FnMut(f64) -> f64,
    (mut low, mut f_low): (f64, f64),
    (mut high, mut f_high): (f64, f64),
    tolerance: f64,
) -> f64 {
    let mut best = if f_low.abs() < f_high.abs() { (low, f_low) } else { (high, f_high) };
    for iteration in 0..200 {
        if best.1.abs() <= tolerance || (high - low).abs() <= 4.0 * f64::EPSILON * low.abs().max(high.abs()) {
            break;
        }
        let secant = low - f_low * (high - low) / (f_high - f_low);
        let inside = (secant - low) * (secant - high) < 0.0;
        let x = if iteration % 3 == 2 || !inside { 0.5 * (low + high) } else { secant };
        let f = function(x);
        if f.abs() < best.1.abs() {
            best = (x, f);
        }
        if (f <= 0.0) == (f_low <= 0.0) {
            (low, f_low) = (x, f);
            f_high *= 0.5;
        } else {
            (high, f_high) = (x, f);
            f_low *= 0.5;
        }
    }
    best.0
}

/// Where a function with a single maximum between `low` and `high` has it (golden section).
pub fn maximum(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    const GOLDEN_SHARE: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (high - GOLDEN_SHARE * (high - low), low + GOLDEN_SHARE * (high - low));
    let (mut f_a, mut f_b) = (function(a), function(b));
    for _ in 0..40 {
        if f_a > f_b {
            (high, b, f_b) = (b, a, f_a);
            a = high - GOLDEN_SHARE * (high - low);
            f_a = function(a);
        } else {
            (low, a, f_a) = (a, b, f_b);
            b = low + GOLDEN_SHARE * (high - low);
            f_b = function(b);
        }
    }
    0.5 * (low + high)
}

/// Walks from `from` in doubling steps until the function reports success; returns the place and its value.
pub fn expand(from: f64, first_step: f64, function: impl Fn(f64) -> (f64, bool)) -> (f64, f64) {
    let mut step = first_step;
    loop {
        let (value, done) = function(from + step);
        if done || step.abs() > 1e9 {
            return (from + step, value);
        }
        step *= 2.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn doubling_steps_reach_a_place_on_either_side() {
        for (step, beyond) in [(1.0, 100.0), (-1.0, -100.0)] {
            let (place, value) = expand(0.0, step, |x| (2.0 * x, x / beyond >= 1.0));
            assert!(place / beyond >= 1.0 && place / beyond <= 2.0, "{place}");
            assert_eq!(value, 2.0 * place);
        }
    }

    #[test]
    fn roots_are_found_for_rising_falling_and_kinked_functions() {
        type Case = (fn(f64) -> f64, f64);
        let cases: [Case; 4] = [
            (|x| x.powi(3) - 2.0, 2.0_f64.cbrt()),
            (|x| 1.0 - x, 1.0),
            (|x| if x < 1.5 { 1e3 * (x - 1.5) } else { 1e-3 * (x - 1.5) }, 1.5),
            (|x| x.powi(21) - 1e-3, 1e-3_f64.powf(1.0 / 21.0)),
        ];
        for (function, root) in cases {
            let found = bracketed_root(function, (0.0, function(0.0)), (10.0, function(10.0)), 0.0);
            assert!((found - root).abs() < 1e-12, "{found} {root}");
        }
    }

    #[test]
    fn maxima_are_found_inside_and_at_the_ends() {
        assert!((maximum(|x| -(x - 1.3).abs(), 0.0, 10.0) - 1.3).abs() < 1e-6);
        assert!((maximum(|x| x, 0.0, 10.0) - 10.0).abs() < 1e-6);
        assert!(maximum(|x| -x, 0.0, 10.0).abs() < 1e-6);
    }
}
