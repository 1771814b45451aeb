//! Largest C-rates of a battery in one direction: for pulses, for long, and what is allowed between.
//!
//! What limits a rate is a linear image of the electrode: an overpotential that follows the current at once, and one that
//! follows its first-order mean. So with `m` that mean, the rate `i` is allowed as long as `i / p + m (1/c - 1/p) <= 1`: for
//! long `c`, the continuous rate; right after a rest `p`, which is such that the pulse rate can be held for 10 s.

use crate::components::battery_tables::{check_axis, check_rows};
use crate::config::{Validate, Violation, ZERO_CELSIUS_K, check_range};
use crate::numerics::elementary;
use crate::numerics::interpolation::BilinearTable;
use serde::{Deserialize, Serialize};

/// How long the pulse rate can be held after a rest [s].
pub const PULSE_S: f64 = 10.0;

/// Largest rate of a table [1/h].
const LARGEST_RATE_PER_H: f64 = 100.0;

/// Largest C-rates of a cell in one direction, one row a temperature, one column a state of charge.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct RateLimitTable {
    /// Factor on all rates: from the cell that the table belongs to, to the vehicle's [-].
    pub rate_scale: f64,
    /// Temperatures of the rows, rising [degC].
    pub temperature_degc: Vec<f64>,
    /// States of charge of the columns, rising [-].
    pub state_of_charge: Vec<f64>,
    /// Rates that can be held for 10 s after a rest; none falls with temperature [1/h].
    pub pulse_rate_per_h: Vec<Vec<f64>>,
    /// Rates that can be held for long; none falls with temperature or exceeds that of pulses [1/h].
    pub continuous_rate_per_h: Vec<Vec<f64>>,
}

/// What the battery remembers of the recent current when a rate is asked for.
#[derive(Debug, Clone, Copy)]
pub struct Allowance {
    /// First-order mean of the rate in the direction of the limit [1/h].
    pub recent_per_h: f64,
    /// Share of it that is still remembered at the end of the step [-].
    pub remembered: f64,
}

/// A table ready for look-ups.
#[derive(Debug, Clone)]
pub struct RateLimit {
    /// Pulse and continuous rate.
    rates: BilinearTable<2>,
    /// Share of a rate that its mean reaches in a pulse after a rest.
    pulse_share: f64,
}

/// Share of a rate that its first-order mean reaches in a pulse.
fn pulse_share(memory_s: f64) -> f64 {
    -elementary::exp_m1(-PULSE_S / memory_s)
}

impl RateLimitTable {
    /// Checks the rates against the time constant of the memory: a pulse rate that is too large for it could not be
    /// held for 10 s whatever was allowed at first.
    ///
    /// # Errors
    /// The first pulse rate that is too large.
    pub fn check_memory(&self, memory_s: f64) -> Result<(), Violation> {
        let largest = pulse_share(memory_s).recip();
        for (i, (pulses, continuous)) in
            self.pulse_rate_per_h.iter().zip(&self.continuous_rate_per_h).enumerate()
        {
            for (j, (&pulse, &rate)) in pulses.iter().zip(continuous).enumerate() {
                if pulse > rate * largest {
                    let allowed = format!(
                        "must be at most {largest:.2} times the continuous rate ({rate}) with rate_memory_s {memory_s}"
                    );
                    return Err(Violation::new(format!("pulse_rate_per_h[{i}][{j}]"), pulse, allowed));
                }
            }
        }
        Ok(())
    }
}

impl Validate for RateLimitTable {
    fn validate(&self) -> Result<(), Violation> {
        check_range("rate_scale", self.rate_scale, 0.0, 10.0)?;
        check_axis("temperature_degc", &self.temperature_degc, -100.0, 150.0)?;
        check_axis("state_of_charge", &self.state_of_charge, 0.0, 1.0)?;
        let columns = self.state_of_charge.len();
        for (key, table) in [
            ("pulse_rate_per_h", &self.pulse_rate_per_h),
            ("continuous_rate_per_h", &self.continuous_rate_per_h),
        ] {
            check_rows(key, table, (self.temperature_degc.len(), columns), (0.0, LARGEST_RATE_PER_H))?;
            for (i, pair) in table.windows(2).enumerate() {
                if let Some(j) = (0..columns).find(|&j| pair[1][j] < pair[0][j]) {
                    let allowed = format!("must not be below the rate of the colder row ({})", pair[0][j]);
                    return Err(Violation::new(format!("{key}[{}][{j}]", i + 1), pair[1][j], allowed));
                }
            }
        }
        for (i, (pulses, continuous)) in
            self.pulse_rate_per_h.iter().zip(&self.continuous_rate_per_h).enumerate()
        {
            if let Some(j) = (0..columns).find(|&j| pulses[j] < continuous[j]) {
                let allowed = format!("must not be below the continuous rate ({})", continuous[j]);
                return Err(Violation::new(format!("pulse_rate_per_h[{i}][{j}]"), pulses[j], allowed));
            }
        }
        Ok(())
    }
}

impl RateLimit {
    /// Prepares a table; `memory_s` is the time constant with which a current is forgotten.
    #[must_use]
    pub fn new(table: &RateLimitTable, memory_s: f64) -> Self {
        let temperatures_k: Vec<f64> =
            table.temperature_degc.iter().map(|degc| degc + ZERO_CELSIUS_K).collect();
        let scaled = |rates: &[Vec<f64>]| -> Vec<Vec<f64>> {
            rates.iter().map(|row| row.iter().map(|rate| rate * table.rate_scale).collect()).collect()
        };
        let (pulse, continuous) = (scaled(&table.pulse_rate_per_h), scaled(&table.continuous_rate_per_h));
        Self {
            rates: BilinearTable::new(&temperatures_k, &table.state_of_charge, [&pulse, &continuous]),
            pulse_share: pulse_share(memory_s),
        }
    }

    /// Largest rate that may be held during a step [1/h]: the one that just meets the limit at its end.
    #[must_use]
    #[inline(always)]
    pub fn rate_per_h(&self, temperature_k: f64, state_of_charge: f64, allowance: &Allowance) -> f64 {
        let [pulse, continuous] = self.rates.at(temperature_k, state_of_charge);
        let excess = pulse - continuous;
        if excess <= 0.0 {
            return continuous;
        }
        let Allowance { recent_per_h, remembered } = *allowance;
        let at_rest = (1.0 - self.pulse_share) * pulse * continuous;
        let held = continuous - self.pulse_share * pulse + (1.0 - remembered) * excess;
        ((at_rest - recent_per_h * remembered * excess) / held).clamp(0.0, pulse)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const MEMORY_S: f64 = 60.0;
    const TEMPERATURE_K: f64 = 280.0;

    fn limit(pulse: f64, continuous: f64) -> RateLimit {
        let table = RateLimitTable {
            rate_scale: 1.0,
            temperature_degc: vec![0.0, 10.0],
            state_of_charge: vec![0.0, 1.0],
            pulse_rate_per_h: vec![vec![pulse; 2]; 2],
            continuous_rate_per_h: vec![vec![continuous; 2]; 2],
        };
        table.validate().and_then(|()| table.check_memory(MEMORY_S)).expect("a sound table");
        RateLimit::new(&table, MEMORY_S)
    }

    /// Charges with what is allowed, from rest; the rate of each step.
    fn charged_as_allowed(limit: &RateLimit, step_s: f64, steps: usize) -> Vec<f64> {
        let remembered = (-step_s / MEMORY_S).exp();
        let mut recent_per_h = 0.0;
        let step = |_| {
            let rate = limit.rate_per_h(TEMPERATURE_K, 0.5, &Allowance { recent_per_h, remembered });
            recent_per_h = rate + (recent_per_h - rate) * remembered;
            rate
        };
        (0..steps).map(step).collect()
    }

    #[test]
    fn the_pulse_rate_is_allowed_for_10_s_after_a_rest_and_the_continuous_one_for_ever() {
        for step_s in [1.0, 0.1] {
            let a_second = (1.0_f64 / step_s).round() as usize;
            let rates = charged_as_allowed(&limit(0.7, 0.48), step_s, 1800 * a_second);
            assert!(
                rates[..10 * a_second].iter().all(|&rate| (rate - 0.7).abs() < 1e-9),
                "{:?}",
                &rates[..10]
            );
            assert!(rates[11 * a_second] < 0.7);
            assert!(rates[10 * a_second..].windows(2).all(|pair| pair[1] <= pair[0] + 1e-12));
            assert!((rates[rates.len() - 1] - 0.48).abs() < 1e-9);
        }
    }

    #[test]
    fn equal_rates_remember_nothing() {
        let rates = charged_as_allowed(&limit(0.7, 0.7), 1.0, 600);
        assert!(rates.iter().all(|&rate| rate == 0.7));
        assert!(charged_as_allowed(&limit(0.0, 0.0), 1.0, 60).iter().all(|&rate| rate == 0.0));
    }

    proptest! {
        #[test]
        fn allowed_rates_stay_between_nothing_and_the_pulse_rate_and_rest_restores_them(
            continuous in 0.0..3.0_f64, ratio in 1.0..6.0_f64, recent in -5.0..5.0_f64, rest_s in 0.0..600.0_f64,
        ) {
            let limit = limit(continuous * ratio, continuous);
            let allowed = |recent_per_h| {
                limit.rate_per_h(TEMPERATURE_K, 0.5, &Allowance { recent_per_h, remembered: 0.98 })
            };
            let now = allowed(recent);
            prop_assert!((0.0..=continuous * ratio).contains(&now), "{now}");
            let rested = allowed(recent.max(0.0) * (-rest_s / MEMORY_S).exp());
            prop_assert!(rested >= allowed(recent.max(0.0)) - 1e-12);
        }
    }
}
