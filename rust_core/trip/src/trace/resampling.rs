//! From rows at any times to full seconds.
//!
//! A trace that was sampled faster than once a second is averaged: the value of a full second is the mean of the trace,
//! straight between its rows, over the half second before it and the half second after it, at either end over the half
//! second that there is. The distance between the first and the last full second stays what it was. Any other trace is
//! interpolated.

use super::reading::median;
use hp_plant::numerics::interpolation::LinearTable;

/// Below this median interval a trace counts as sampled faster than once a second [s]; clocks of 1 Hz are that exact.
const FAST_S: f64 = 0.9;

/// By so much a last full second may be missed: large clock readings are rounded [s].
const CLOCK_TOLERANCE_S: f64 = 1e-3;

/// Full seconds of a trace.
pub(super) struct Seconds {
    last_s: usize,
    averages: bool,
}

impl Seconds {
    /// Those of times that rise from 0, at least two [s].
    pub fn of(times_s: &[f64]) -> Self {
        let intervals_s: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let end_s = times_s[times_s.len() - 1];
        Self { last_s: (end_s + CLOCK_TOLERANCE_S).floor() as usize, averages: median(&intervals_s) < FAST_S }
    }

    /// The last one [s].
    pub fn last_s(&self) -> usize {
        self.last_s
    }

    /// Values at full seconds of what has values at times.
    pub fn resampled(&self, times_s: &[f64], values: &[f64]) -> Vec<f64> {
        let table = LinearTable::new(times_s, values);
        if !self.averages {
            return (0..=self.last_s).map(|second| table.at(second as f64)).collect();
        }
        let last_s = self.last_s as f64;
        let mut first = 0;
        let around = |second: usize| {
            let (from_s, to_s) = ((second as f64 - 0.5).max(0.0), (second as f64 + 0.5).min(last_s));
            while times_s[first + 1] <= from_s && first + 2 < times_s.len() {
                first += 1;
            }
            mean(&table, &times_s[first + 1..], (from_s, to_s))
        };
        (0..=self.last_s).map(around).collect()
    }
}

/// Mean of a table between two times; `times_s` begins with its first point after the first of them.
fn mean(table: &LinearTable, times_s: &[f64], (from_s, to_s): (f64, f64)) -> f64 {
    let mut integral = 0.0;
    let (mut last_s, mut last) = (from_s, table.at(from_s));
    let inner = times_s.iter().copied().take_while(|&time_s| time_s < to_s).filter(|&time_s| time_s > from_s);
    for time_s in inner.chain([to_s]) {
        let value = table.at(time_s);
        integral += 0.5 * (last + value) * (time_s - last_s);
        (last_s, last) = (time_s, value);
    }
    integral / (to_s - from_s)
}
