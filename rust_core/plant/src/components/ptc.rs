//! PTC heater at the end of the HTC's series part (paper section 2.3, equation (4)).

use super::pid::PidParameters;
use crate::config::Celsius;
use crate::parameters;

parameters! {
    /// PTC heater at the end of the HTC's series part.
    pub struct PtcParameters {
        /// Largest electrical power [W].
        maximum_power_w: f64 = 0.0 .. 20000.0,
        /// Coolant temperature above which it is off (paper: 85 degC) [degC].
        cutoff_degc: Celsius = 20.0 .. 120.0,
        ;
        /// Controller on the cabin temperature.
        pid: PidParameters,
    }
}

impl PtcParameters {
    /// Power that just ends the step at the cut-off temperature, 0 where the coolant is as hot without it [W].
    ///
    /// `supply_k` is the HTC supply at the end of the step without the heater, `sensitivity_k_w` its rise per watt.
    /// Unlike a switch it is continuous in all it depends on.
    #[must_use]
    #[inline]
    pub fn power_to_cutoff_w(&self, supply_k: f64, sensitivity_k_w: f64) -> f64 {
        ((self.cutoff_degc.kelvin() - supply_k) / sensitivity_k_w).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn step_ends_at_the_cut_off_and_hotter_coolant_takes_nothing() {
        let pid = PidParameters { proportional: 1.0, integral: 0.0, derivative: 0.0 };
        let ptc = PtcParameters { maximum_power_w: 5000.0, cutoff_degc: Celsius(85.0), pid };
        let (supply_k, sensitivity_k_w) = (Celsius(80.0).kelvin(), 2e-4);
        let power_w = ptc.power_to_cutoff_w(supply_k, sensitivity_k_w);
        assert!((supply_k + power_w * sensitivity_k_w - Celsius(85.0).kelvin()).abs() < 1e-9);
        assert_eq!(ptc.power_to_cutoff_w(Celsius(86.0).kelvin(), sensitivity_k_w), 0.0);
    }
}
