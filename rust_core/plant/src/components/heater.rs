//! Heaters: the paper's PTC at the end of the HTC's series part with its cut-off (section 2.3), and others that
//! warm another loop, a mass or the cabin air.

use super::pid::PidParameters;
use crate::config::Celsius;
use crate::parameters;

parameters! {
    /// Electrical heater.
    pub struct HeaterParameters {
        /// Largest electrical power [W].
        maximum_power_w: f64 = 0.0 .. 20000.0,
        /// Temperature of what it heats above which it is off (paper: 85 degC) [degC].
        cutoff_degc: Celsius = 20.0 .. 120.0,
        ;
        /// Controller on the cabin temperature.
        pid: PidParameters,
    }
}

impl HeaterParameters {
    /// Power that just ends the step at the cut-off temperature, 0 where it is as hot without the heater [W].
    ///
    /// `supply_k` is the temperature at the end of the step without the heater, `sensitivity_k_w` its rise per watt.
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
        let ptc = HeaterParameters { maximum_power_w: 5000.0, cutoff_degc: Celsius(85.0), pid };
        let (supply_k, sensitivity_k_w) = (Celsius(80.0).kelvin(), 2e-4);
        let power_w = ptc.power_to_cutoff_w(supply_k, sensitivity_k_w);
        assert!((supply_k + power_w * sensitivity_k_w - Celsius(85.0).kelvin()).abs() < 1e-9);
        assert_eq!(ptc.power_to_cutoff_w(Celsius(86.0).kelvin(), sensitivity_k_w), 0.0);
    }
}
