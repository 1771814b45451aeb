//! PID controllers.

use crate::parameters;
use serde::{Deserialize, Serialize};

parameters! {
    /// PID gains; the derivative acts on the measurement. Units follow from the controller's use.
    pub struct PidParameters {
        /// Proportional gain [output unit per input unit].
        proportional: f64 = 0.0 .. 1000000.0,
        /// Integral gain [output unit per input unit and second].
        integral: f64 = 0.0 .. 1000000.0,
        /// Derivative gain [output unit seconds per input unit].
        derivative: f64 = 0.0 .. 1000000.0,
    }
}

/// Memory of a PID with external reset.
///
/// Its integral follows the output that was really applied (by this controller or by another one that won a
/// minimum selection), so it cannot wind up: Shinskey, Process Control Systems, section on external reset.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ResetPid {
    reset: f64,
    last_error: f64,
    started: bool,
}

/// Gains of a [`ResetPid`] at one period.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ResetGains {
    proportional: f64,
    /// Derivative gain over the period.
    derivative: f64,
    /// Share of the way to the applied output that the reset moves in a period.
    reset_share: f64,
}

impl ResetGains {
    /// Gains for a period [s].
    #[must_use]
    pub fn new(gains: &PidParameters, period_s: f64) -> Self {
        let resets = gains.proportional > 0.0;
        Self {
            proportional: gains.proportional,
            derivative: gains.derivative / period_s,
            reset_share: if resets {
                -(-period_s * gains.integral / gains.proportional).exp_m1()
            } else {
                0.0
            },
        }
    }
}

impl ResetPid {
    /// Output for an error, limited to `low..=high`.
    pub fn output(&mut self, gains: &ResetGains, error: f64, low: f64, high: f64) -> f64 {
        let change = if self.started { error - self.last_error } else { 0.0 };
        self.last_error = error;
        self.started = true;
        (gains.proportional * error + self.reset + gains.derivative * change).clamp(low, high)
    }

    /// Tells the controller which output was applied since.
    pub fn applied(&mut self, gains: &ResetGains, output: f64) {
        self.reset += gains.reset_share * (output - self.reset);
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

/// PID in incremental form: the output is the state, so its limits are its anti-windup.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct IncrementalPid {
    pub(crate) output: f64,
    pub(crate) last_error: f64,
    pub(crate) last_change: f64,
    pub(crate) started: bool,
}

impl IncrementalPid {
    /// A controller that starts from an output.
    #[must_use]
    pub fn at(output: f64) -> Self {
        Self { output, ..Self::default() }
    }

    /// Moves the output for an error and limits it to `low..=high`.
    pub fn update(&mut self, gains: &PidParameters, error: f64, period_s: f64, low: f64, high: f64) -> f64 {
        *self = self.updated(gains, error, period_s, low, high);
        self.output
    }

    /// The controller after an error, its output limited to `low..=high`.
    #[must_use]
    #[inline]
    pub fn updated(self, gains: &PidParameters, error: f64, period_s: f64, low: f64, high: f64) -> Self {
        let change = if self.started { error - self.last_error } else { 0.0 };
        let before = (self.output, self.last_change);
        let (output, change) = Self::moved(gains, before, (error, change), period_s, (low, high));
        Self { output, last_error: error, last_change: change, started: true }
    }

    /// Output, limited to a range, and change of the error, from those before, the error and its change.
    #[inline(always)]
    pub(crate) fn moved(
        gains: &PidParameters,
        (output, last_change): (f64, f64),
        (error, change): (f64, f64),
        period_s: f64,
        (low, high): (f64, f64),
    ) -> (f64, f64) {
        let bend = change - last_change;
        let step = gains.proportional * change
            + gains.integral * error * period_s
            + gains.derivative * bend / period_s;
        ((output + step).clamp(low, high), change)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAINS: PidParameters = PidParameters { proportional: 2.0, integral: 0.5, derivative: 0.0 };

    #[test]
    fn reset_pid_behind_a_minimum_selector_does_not_wind_up() {
        let (mut pid, gains) = (ResetPid::default(), ResetGains::new(&GAINS, 1.0));
        for _ in 0..10_000 {
            let _ = pid.output(&gains, 5.0, 0.0, 100.0);
            pid.applied(&gains, 3.0);
        }
        assert!((pid.output(&gains, 0.0, 0.0, 100.0) - 3.0).abs() < 1e-9);
    }

    #[test]
    fn reset_pid_removes_the_steady_error_of_a_first_order_lag() {
        let (mut pid, gains) = (ResetPid::default(), ResetGains::new(&GAINS, 1.0));
        let mut value = 0.0;
        for _ in 0..2000 {
            let output = pid.output(&gains, 7.0 - value, 0.0, 100.0);
            value += 0.05 * (output - value);
            pid.applied(&gains, output);
        }
        assert!((value - 7.0_f64).abs() < 1e-6);
    }

    #[test]
    fn incremental_pid_leaves_its_limit_as_soon_as_the_error_turns() {
        let gains = PidParameters { proportional: 0.0, integral: 0.5, derivative: 0.0 };
        let mut pid = IncrementalPid::default();
        for _ in 0..1000 {
            pid.update(&gains, 1.0, 1.0, 0.0, 1.0);
        }
        assert_eq!(pid.output, 1.0);
        assert_eq!(pid.update(&gains, -0.1, 1.0, 0.0, 1.0), 0.95);
    }

    #[test]
    fn derivative_opposes_a_fast_change() {
        let plain = PidParameters { proportional: 1.0, integral: 0.0, derivative: 0.0 };
        let damped = PidParameters { derivative: 4.0, ..plain.clone() };
        let run = |gains: &PidParameters| {
            let (mut pid, gains) = (ResetPid::default(), ResetGains::new(gains, 1.0));
            let _ = pid.output(&gains, 5.0, -100.0, 100.0);
            pid.output(&gains, 4.0, -100.0, 100.0)
        };
        assert_eq!(run(&plain) - run(&damped), 4.0);
    }
}
