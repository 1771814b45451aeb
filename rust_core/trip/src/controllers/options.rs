//! Options that cars of today have and the paper's rules have not, for any rule set: heat pump before PTC, cabin before
//! battery, blower by need. All of them pure functions of what is measured; zeros switch them off.

use super::rule_based::CabinMode;
use hp_plant::config::Celsius;
use hp_plant::parameters;

parameters! {
    /// Options of today's cars, table `[options]` of a controller file; without the table, or with zeros, none of them acts.
    pub struct Options {
        /// Heat pump before PTC: while there is a heat pump, the PTC's controller aims this far below the cabin target [K].
        ptc_below_target_k: f64 = 0.0 .. 5.0,
        /// Cabin before battery: how much the cabin may lack until the battery gets no heat of the hot loop on the cabin's
        /// account; 0: the battery does not wait [K].
        battery_after_cabin_band_k: f64 = 0.0 .. 20.0,
        /// Cabin before battery: supply of the hot loop that the cabin has no use for anything above [degC].
        battery_from_supply_degc: Celsius = -40.0 .. 95.0,
        /// How far above that the battery gets its whole request [K].
        battery_supply_band_k: f64 = 0.0 .. 50.0,
        /// Blower by need: lack of the cabin that calls for the whole air flow while heating; 0: constant air flow [K].
        heating_blower_band_k: f64 = 0.0 .. 30.0,
        /// The same while cooling [K].
        cooling_blower_band_k: f64 = 0.0 .. 30.0,
        /// Blower level at the cabin target, which brings the fresh air that occupants need [-].
        least_blower_level: f64 = 0.0 .. 1.0,
    }
}

impl Options {
    /// How far below the cabin target the PTC's controller aims [K].
    ///
    /// Two integrators on one error share a load as their history has it. With targets of their own at most one of them rests
    /// between its limits: at the target the PTC has wound down to nothing, and where the heat pump gives all it can, the
    /// cabin stays lower by this and the PTC's controller alone decides (split range by set points).
    #[must_use]
    pub fn heater_offset_k(&self, has_heat_pump: bool) -> f64 {
        if has_heat_pump { self.ptc_below_target_k } else { 0.0 }
    }

    /// Share of its requested heat that the battery gets from the hot loop: 1 for what the cabin does not need, 0 for what it
    /// does. `lack_k` is how far the cabin is below its target, `supply_k` the warmest supply of the hot loops.
    #[must_use]
    pub fn battery_share(&self, lack_k: f64, supply_k: Option<f64>) -> f64 {
        if self.battery_after_cabin_band_k == 0.0 {
            return 1.0;
        }
        let satisfied = 1.0 - lack_k / self.battery_after_cabin_band_k;
        let surplus = supply_k.map_or(0.0, |supply_k| {
            let above_k = supply_k - self.battery_from_supply_degc.kelvin();
            // Without a band all of it at once.
            above_k / self.battery_supply_band_k.max(f64::MIN_POSITIVE)
        });
        satisfied.max(surplus).clamp(0.0, 1.0)
    }

    /// Blower level for a cabin that lacks this much in the direction of a mode [K]; `highest` is the level of full need.
    #[must_use]
    pub fn blower_level(&self, mode: CabinMode, highest: f64, lack_k: f64) -> f64 {
        let band_k = match mode {
            CabinMode::Heating => self.heating_blower_band_k,
            CabinMode::Cooling => self.cooling_blower_band_k,
        };
        if band_k == 0.0 {
            return highest;
        }
        let least = self.least_blower_level.min(highest);
        least + (highest - least) * (lack_k / band_k).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn modern() -> Options {
        Options {
            ptc_below_target_k: 0.5,
            battery_after_cabin_band_k: 1.0,
            battery_from_supply_degc: Celsius(70.0),
            battery_supply_band_k: 10.0,
            heating_blower_band_k: 4.0,
            cooling_blower_band_k: 2.0,
            least_blower_level: 0.3,
        }
    }

    #[test]
    fn nothing_acts_without_the_table() {
        let none = Options::default();
        assert_eq!(none.heater_offset_k(true), 0.0);
        for lack_k in [-5.0, 0.0, 40.0] {
            assert_eq!(none.battery_share(lack_k, Some(250.0)), 1.0);
            assert_eq!(none.blower_level(CabinMode::Heating, 0.7, lack_k), 0.7);
            assert_eq!(none.blower_level(CabinMode::Cooling, 0.7, lack_k), 0.7);
        }
    }

    #[test]
    fn heater_has_the_targets_of_the_cabin_where_it_is_alone() {
        assert_eq!((modern().heater_offset_k(true), modern().heater_offset_k(false)), (0.5, 0.0));
    }

    #[test]
    fn battery_gets_what_a_satisfied_cabin_leaves_and_what_is_too_hot_for_it() {
        let (options, cool_k, hot_k) = (modern(), Celsius(40.0).kelvin(), Celsius(75.0).kelvin());
        assert_eq!(options.battery_share(0.0, Some(cool_k)), 1.0);
        assert_eq!(options.battery_share(0.5, Some(cool_k)), 0.5);
        assert_eq!(options.battery_share(1.0, Some(cool_k)), 0.0);
        assert!((options.battery_share(30.0, Some(hot_k)) - 0.5).abs() < 1e-12);
        assert_eq!(options.battery_share(30.0, None), 0.0);
        let at_once = Options { battery_supply_band_k: 0.0, ..options };
        assert_eq!(at_once.battery_share(30.0, Some(hot_k)), 1.0);
    }

    #[test]
    fn blower_follows_the_lack_between_its_levels() {
        let level = |mode, highest, lack_k| modern().blower_level(mode, highest, lack_k);
        assert_eq!(level(CabinMode::Heating, 1.0, 0.0), 0.3);
        assert!((level(CabinMode::Heating, 1.0, 2.0) - 0.65).abs() < 1e-12);
        assert_eq!(level(CabinMode::Cooling, 1.0, 2.0), 1.0);
        assert_eq!(level(CabinMode::Heating, 1.0, 15.0), 1.0);
        // Fresh air is left where the cabin is too warm, too.
        assert_eq!(level(CabinMode::Heating, 1.0, -5.0), 0.3);
        // A driver who wants less air than the least gets it.
        assert_eq!(level(CabinMode::Heating, 0.2, 1.0), 0.2);
    }
}
