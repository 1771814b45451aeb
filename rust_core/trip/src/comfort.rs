//! How a cabin comes near comfort and stays there: what a trip is judged by (`hp_gym/comfort_standard.py`).

use crate::summary::COMFORT_TEMPERATURE_DEGC;
use hp_plant::plant::CONTROL_PERIOD_S;
use serde::{Deserialize, Serialize};

/// Distance from 22 degC within which a cabin is near comfort [K]: from 18 degC on in the cold, down to 26 degC in heat.
pub const NEAR_COMFORT_K: f64 = 4.0;

/// Carbon dioxide that a room with ventilation should not exceed (DIN 1946-2:1994) [ppm].
pub const CO2_HIGHEST_PPM: f64 = 1500.0;

/// Running totals of one reading of the cabin's temperature.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Course {
    first_near_s: f64,
    outside_k_s: f64,
    discomfort_afterwards_k_s: f64,
}

impl Default for Course {
    fn default() -> Self {
        Self { first_near_s: f64::NAN, outside_k_s: 0.0, discomfort_afterwards_k_s: 0.0 }
    }
}

impl Course {
    /// Adds a second that ended at a time and a temperature.
    #[inline]
    pub fn add(&mut self, time_s: f64, temperature_degc: f64) {
        let deviation_k = (temperature_degc - COMFORT_TEMPERATURE_DEGC).abs();
        self.outside_k_s += (deviation_k - NEAR_COMFORT_K).max(0.0) * CONTROL_PERIOD_S;
        if self.first_near_s.is_nan() {
            if deviation_k > NEAR_COMFORT_K {
                return;
            }
            self.first_near_s = time_s;
        }
        self.discomfort_afterwards_k_s += deviation_k * CONTROL_PERIOD_S;
    }

    /// Time until the cabin is first near comfort [s]; not a number if it never is.
    #[must_use]
    pub fn time_to_near_comfort_s(&self) -> f64 {
        self.first_near_s
    }

    /// Distance from near comfort over the whole trip, integrated [K s].
    #[must_use]
    pub fn outside_near_comfort_k_s(&self) -> f64 {
        self.outside_k_s
    }

    /// Mean distance from 22 degC until a time, from when the cabin was first near comfort, that second included [K]; not a
    /// number if it never was.
    #[must_use]
    pub fn discomfort_afterwards_k(&self, time_s: f64) -> f64 {
        self.discomfort_afterwards_k_s / (time_s - self.first_near_s + CONTROL_PERIOD_S)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(temperatures_degc: &[f64]) -> Course {
        let mut course = Course::default();
        let times_s = (1..).map(f64::from);
        times_s.zip(temperatures_degc).for_each(|(time_s, &degc)| course.add(time_s, degc));
        course
    }

    #[test]
    fn a_cold_cabin_is_near_comfort_from_18_degc_and_a_hot_one_from_26() {
        for temperatures_degc in [[10.0, 17.9, 18.0, 21.0], [34.0, 26.1, 26.0, 23.0]] {
            let found = course(&temperatures_degc);
            assert_eq!(found.time_to_near_comfort_s(), 3.0);
            assert!((found.outside_near_comfort_k_s() - 8.1).abs() < 1e-12);
            assert_eq!(found.discomfort_afterwards_k(4.0), 2.5);
        }
    }

    #[test]
    fn a_cabin_that_starts_near_comfort_is_there_after_the_first_second_and_what_it_loses_counts() {
        let found = course(&[20.0, 18.0, 16.0]);
        assert_eq!(found.time_to_near_comfort_s(), 1.0);
        assert_eq!(found.outside_near_comfort_k_s(), 2.0);
        assert_eq!(found.discomfort_afterwards_k(3.0), 4.0);
    }

    #[test]
    fn a_cabin_that_never_comes_near_comfort_has_no_time_and_no_afterwards() {
        let found = course(&[0.0, 10.0]);
        assert!(found.time_to_near_comfort_s().is_nan() && found.discomfort_afterwards_k(2.0).is_nan());
        assert_eq!(found.outside_near_comfort_k_s(), 26.0);
    }
}
