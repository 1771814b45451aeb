//! Climate that changes during a trip: what a series gives, second by second.

use crate::scenario::ClimateParameters;
use crate::trace::Trace;
use crate::trace::columns::Quantity;
use hp_plant::config::Celsius;
use hp_plant::media::air::{self, AirProperties};
use hp_plant::media::moist_air;
use hp_plant::plant::Disturbance;

/// Quantities that a series of the climate is read for.
pub const QUANTITIES: &[Quantity] =
    &[Quantity::Ambient, Quantity::Humidity, Quantity::Sun, Quantity::Headwind, Quantity::Occupants];

/// Climate during a second.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Second {
    air: AirProperties,
    humidity_ratio: f64,
    solar_gain_w: f64,
    occupants: f64,
    headwind_m_s: f64,
}

/// Climate of each second of a trip: what a series has at its beginning. After the last one, that stays.
#[derive(Debug, Clone, PartialEq)]
pub struct Weather {
    seconds: Box<[Second]>,
}

impl Weather {
    /// The climate of a series for a vehicle with an aperture for the sun, with constants for what the series does not have.
    #[must_use]
    pub fn of(series: &Trace, constants: &ClimateParameters, solar_aperture_m2: f64) -> Self {
        let second = |second: usize| {
            let at = |quantity: Quantity| series.values(quantity).map(|values| values[second]);
            let ambient = at(Quantity::Ambient).map_or(constants.ambient_temperature_degc, Celsius);
            let relative_humidity =
                at(Quantity::Humidity).map_or(constants.relative_humidity, |percent| percent / 100.0);
            Second {
                air: air::at_temperature(ambient.kelvin()),
                humidity_ratio: moist_air::humidity_ratio(relative_humidity, ambient.kelvin()),
                solar_gain_w: at(Quantity::Sun)
                    .map_or(constants.solar_gain_w, |sun_w_m2| sun_w_m2 * solar_aperture_m2),
                occupants: at(Quantity::Occupants).unwrap_or(f64::from(constants.occupants)),
                headwind_m_s: at(Quantity::Headwind).unwrap_or_default(),
            }
        };
        Self { seconds: (0..=series.duration_s()).map(second).collect() }
    }

    /// Enters the climate of a second.
    pub fn enter(&self, second: usize, disturbance: &mut Disturbance) {
        let now = &self.seconds[second.min(self.seconds.len() - 1)];
        disturbance.air = now.air;
        disturbance.ambient_humidity_ratio = now.humidity_ratio;
        disturbance.solar_gain_w = now.solar_gain_w;
        disturbance.occupants = now.occupants;
        disturbance.headwind_m_s = now.headwind_m_s;
    }
}
