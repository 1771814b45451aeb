//! From rows at any times to full seconds.
//!
//! A trace that was sampled faster than once a second is averaged: the value of a full second is the mean of the trace,
//! straight between its rows, over the half second before it and the half second after it, at either end over the half
//! second that there is. The distance between the first and the last full second stays what it was. Any other trace is
//! interpolated.

use super::reading::median;

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
        let line = Line { times_s, values };
        if !self.averages {
            return (0..=self.last_s).map(|second| line.at(second as f64)).collect();
        }
        let last_s = self.last_s as f64;
        let mut first = 0;
        let around = |second: usize| {
            let (from_s, to_s) = ((second as f64 - 0.5).max(0.0), (second as f64 + 0.5).min(last_s));
            while times_s[first + 1] <= from_s && first + 2 < times_s.len() {
                first += 1;
            }
            mean(&line, &times_s[first + 1..], (from_s, to_s))
        };
        (0..=self.last_s).map(around).collect()
    }
}

/// A quantity straight between its rows. Tables of the plant compare with every point, which suits a few; a log has many rows.
struct Line<'a> {
    times_s: &'a [f64],
    values: &'a [f64],
}

impl Line<'_> {
    /// Value at a time; before the first row its value, after the last one likewise.
    fn at(&self, time_s: f64) -> f64 {
        let next = self.times_s.partition_point(|&row_s| row_s <= time_s);
        let row = next.saturating_sub(1);
        if next == 0 || next == self.times_s.len() {
            return self.values[row];
        }
        let slope = (self.values[next] - self.values[row]) / (self.times_s[next] - self.times_s[row]);
        self.values[row] + slope * (time_s - self.times_s[row])
    }
}

/// Mean of a trace between two times; `times_s` begins with its first row after the first of them.
fn mean(line: &Line<'_>, times_s: &[f64], (from_s, to_s): (f64, f64)) -> f64 {
    let mut integral = 0.0;
    let (mut last_s, mut last) = (from_s, line.at(from_s));
    let inner = times_s.iter().copied().take_while(|&time_s| time_s < to_s).filter(|&time_s| time_s > from_s);
    for time_s in inner.chain([to_s]) {
        let value = line.at(time_s);
        integral += 0.5 * (last + value) * (time_s - last_s);
        (last_s, last) = (time_s, value);
    }
    integral / (to_s - from_s)
}
