//! Moist air at ambient pressure: an ideal mixture of dry air and water vapour.
//!
//! Saturation pressure after Buck 1981 in his form of 1996: over water from 0 degC up, over ice below. One exponential function,
//! here the same at 0 degC from both sides, and its inverse is exact. The gases are ideal: CoolProp's real air holds 0.4 to 0.5 %
//! more water at saturation.

use crate::config::ZERO_CELSIUS_K;
use crate::media::air::AMBIENT_PRESSURE_PA;
use crate::numerics::elementary::{exp, ln};

/// Gas constant of dry air over that of water vapour [-].
pub const MASS_RATIO: f64 = 0.621_945;

/// Saturation pressure at 0 degC [Pa]; Buck has 611.21 over water and 611.15 over ice.
const AT_ZERO_PA: f64 = 611.2;

/// Largest share of ambient pressure that vapour is given, so that air near boiling keeps a humidity ratio [-].
const LARGEST_SHARE: f64 = 0.9;

/// Buck's form: `exp((slope - t / curvature) t / (offset + t))` with `t` in degC.
struct Buck {
    slope: f64,
    per_curvature_k: f64,
    offset_k: f64,
}

const WATER: Buck = Buck { slope: 18.678, per_curvature_k: 1.0 / 234.5, offset_k: 257.14 };
const ICE: Buck = Buck { slope: 23.036, per_curvature_k: 1.0 / 333.7, offset_k: 279.82 };

impl Buck {
    #[inline]
    fn over(water: bool) -> &'static Self {
        if water { &WATER } else { &ICE }
    }
}

/// Pressure of saturated vapour [Pa]: over water at and above 0 degC, over ice below.
#[must_use]
#[inline]
pub fn saturation_pressure_pa(temperature_k: f64) -> f64 {
    let t = temperature_k - ZERO_CELSIUS_K;
    let Buck { slope, per_curvature_k, offset_k } = Buck::over(t >= 0.0);
    AT_ZERO_PA * exp((slope - t * per_curvature_k) * t / (offset_k + t))
}

/// Water in a kilogram of dry air of a relative humidity [kg/kg]; held where vapour would be nine tenths of the pressure.
#[must_use]
#[inline]
pub fn humidity_ratio(relative_humidity: f64, temperature_k: f64) -> f64 {
    let vapour_pa = relative_humidity * saturation_pressure_pa(temperature_k);
    let vapour_pa = vapour_pa.min(LARGEST_SHARE * AMBIENT_PRESSURE_PA);
    MASS_RATIO * vapour_pa / (AMBIENT_PRESSURE_PA - vapour_pa)
}

/// Water in a kilogram of saturated dry air [kg/kg].
#[must_use]
#[inline]
pub fn saturation_ratio(temperature_k: f64) -> f64 {
    humidity_ratio(1.0, temperature_k)
}

/// Pressure of the vapour in air of a humidity ratio [Pa].
#[must_use]
#[inline]
pub fn vapour_pressure_pa(humidity_ratio: f64) -> f64 {
    AMBIENT_PRESSURE_PA * humidity_ratio / (MASS_RATIO + humidity_ratio)
}

/// Relative humidity of air of a humidity ratio [-], against water from 0 degC up and ice below; above 1 where it is
/// supersaturated.
#[must_use]
#[inline]
pub fn relative_humidity(humidity_ratio: f64, temperature_k: f64) -> f64 {
    vapour_pressure_pa(humidity_ratio) / saturation_pressure_pa(temperature_k)
}

/// Temperature at which air of a humidity ratio is saturated [K]; below 0 degC it is the frost point. The driest air that is
/// told apart has 1e-9 kg/kg.
#[must_use]
#[inline]
pub fn dew_point_k(humidity_ratio: f64) -> f64 {
    let logarithm = ln(vapour_pressure_pa(humidity_ratio.max(1e-9)) / AT_ZERO_PA);
    let Buck { slope, per_curvature_k, offset_k } = Buck::over(logarithm >= 0.0);
    // The smaller root of a quadratic equation, in the form that loses no digits near 0 degC.
    let half = 0.5 * (slope - logarithm);
    let root = (half * half - per_curvature_k * offset_k * logarithm).max(0.0).sqrt();
    ZERO_CELSIUS_K + offset_k * logarithm / (half + root)
}

/// Heat that a kilogram of vapour gives off when it becomes water [J/kg]: 2501 kJ at 0 degC, 2442 at 25 degC (IAPWS).
#[must_use]
#[inline]
pub fn latent_heat_j_kg(temperature_k: f64) -> f64 {
    2.501e6 - 2370.0 * (temperature_k - ZERO_CELSIUS_K)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn kelvin(degc: f64) -> f64 {
        degc + ZERO_CELSIUS_K
    }

    /// `psychrolib.GetSatVapPres(t)` of PsychroLib 2.5.0 (ASHRAE's, which are Hyland and Wexler's) in SI units.
    #[test]
    fn saturation_pressures_are_those_of_psychrolib() {
        for (degc, published_pa, tolerance) in [
            (-40.0, 12.845_249, 0.003),
            (-20.0, 103.260_379, 0.001),
            (-10.0, 259.902_865, 0.001),
            (0.0, 611.153_571, 0.0005),
            (0.01, 611.657_024, 0.0005),
            (10.0, 1_227.995_275, 0.001),
            (20.0, 2_338.803_70, 0.001),
            (25.0, 3_169.216_47, 0.001),
            (35.0, 5_627.819_45, 0.001),
            (50.0, 12_349.856_5, 0.001),
            (70.0, 31_197.895_3, 0.001),
        ] {
            let found_pa = saturation_pressure_pa(kelvin(degc));
            assert!((found_pa / published_pa - 1.0).abs() < tolerance, "{found_pa} at {degc} degC");
        }
    }

    /// `psychrolib.GetHumRatioFromRelHum(t, r, 101325)` and `GetTDewPointFromRelHum(t, r)`; CoolProp 8.0.0's
    /// `HAPropsSI("W", "T", t + 273.15, "P", 101325, "R", r)` and `"D"`, whose air is a real gas.
    #[test]
    fn humidity_ratios_and_dew_points_are_those_of_psychrolib_and_coolprop() {
        for (degc, relative, ratio, real_ratio, dew_degc, real_dew_degc) in [
            (20.0, 0.5, 0.007_261_737, 0.007_293_698, 9.272_392, 9.274_426),
            (35.0, 0.4, 0.014_131_654, 0.014_200_454, 19.384_649, 19.391_367),
            (-5.0, 0.8, 0.001_979_139, 0.001_987_462, -7.585_268, -7.585_435),
            (22.0, 0.3, 0.004_908_581, 0.004_930_286, 3.645_498, 3.648_817),
        ] {
            let found = humidity_ratio(relative, kelvin(degc));
            assert!((found / ratio - 1.0).abs() < 0.001, "{found} at {degc} degC");
            assert!((found / real_ratio - 1.0).abs() < 0.006, "{found} at {degc} degC");
            let found_degc = dew_point_k(found) - ZERO_CELSIUS_K;
            assert!((found_degc - dew_degc).abs() < 0.03, "{found_degc} at {degc} degC");
            assert!((found_degc - real_dew_degc).abs() < 0.03, "{found_degc} at {degc} degC");
        }
    }

    /// `CoolProp.PropsSI("H", "T", t, "Q", 1, "Water")` less the same at `"Q", 0`, CoolProp 8.0.0.
    #[test]
    fn heat_of_condensation_is_that_of_coolprop() {
        for (degc, published) in [(0.01, 2.500_92e6), (25.0, 2.441_68e6), (50.0, 2.381_95e6)] {
            let found = latent_heat_j_kg(kelvin(degc));
            assert!((found / published - 1.0).abs() < 0.001, "{found} at {degc} degC");
        }
    }

    proptest! {
        #[test]
        fn each_is_the_inverse_of_the_other(degc in -50.0..70.0_f64, relative in 0.01..1.0_f64) {
            let ratio = humidity_ratio(relative, kelvin(degc));
            prop_assert!((relative_humidity(ratio, kelvin(degc)) / relative - 1.0).abs() < 1e-12);
            prop_assert!((saturation_ratio(dew_point_k(ratio)) / ratio - 1.0).abs() < 1e-10);
            prop_assert!(dew_point_k(ratio) <= kelvin(degc) + 1e-9);
        }
    }

    #[test]
    fn ends_are_held() {
        assert_eq!(humidity_ratio(0.0, kelvin(20.0)), 0.0);
        assert_eq!(relative_humidity(0.0, kelvin(20.0)), 0.0);
        assert_eq!(saturation_ratio(kelvin(200.0)), saturation_ratio(kelvin(150.0)));
        assert!(dew_point_k(0.0).is_finite() && dew_point_k(0.0) < kelvin(-60.0));
    }
}
