//! Options that cars of today have and the paper's rules have not, for any rule set: heat pump before PTC, cabin before
//! battery, blower by need, recirculation by humidity and carbon dioxide, air at the windscreen by fog. All of them pure functions of what is measured; zeros switch them off.

use super::rule_based::CabinMode;
use crate::roles::Roles;
use hp_plant::command::Demand;
use hp_plant::config::Celsius;
use hp_plant::parameters;
use hp_plant::state::State;

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
        /// Recirculation by humidity: fog margin of the windscreen up to which there is fresh air only [K].
        #[serde(default)]
        fresh_below_fog_margin_k: f64 = 0.0 .. 20.0,
        /// How far above that the whole recirculated share is allowed; 0: recirculation does not look at fog [K].
        #[serde(default)]
        recirculation_fog_band_k: f64 = 0.0 .. 20.0,
        /// Recirculation by carbon dioxide: from here on there is fresh air only [ppm].
        #[serde(default)]
        fresh_above_co2_ppm: f64 = 0.0 .. 10000.0,
        /// How far below that the whole recirculated share is allowed; 0: recirculation does not look at it [ppm].
        #[serde(default)]
        recirculation_co2_band_ppm: f64 = 0.0 .. 10000.0,
        /// Outlets by fog risk: fog margin below which air is blown at the windscreen, all of it at none; 0: never [K].
        #[serde(default)]
        windscreen_below_fog_margin_k: f64 = 0.0 .. 20.0,
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

/// Of a cabin's air, what limits recirculation and calls for air at the windscreen.
impl Options {
    /// Share of the recirculation that fog and carbon dioxide allow [-].
    #[must_use]
    pub fn recirculation_share(&self, fog_margin_k: f64, co2_ppm: f64) -> f64 {
        let within = |room: f64, band: f64| if band > 0.0 { (room / band).clamp(0.0, 1.0) } else { 1.0 };
        let dry = within(fog_margin_k - self.fresh_below_fog_margin_k, self.recirculation_fog_band_k);
        dry.min(within(self.fresh_above_co2_ppm - co2_ppm, self.recirculation_co2_band_ppm))
    }

    /// Share of the air that is blown at the windscreen [-].
    #[must_use]
    pub fn windscreen_share(&self, fog_margin_k: f64) -> f64 {
        if self.windscreen_below_fog_margin_k > 0.0 {
            (1.0 - fog_margin_k / self.windscreen_below_fog_margin_k).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }

    /// Whether any of this is switched on.
    #[must_use]
    pub fn minds_air(&self) -> bool {
        self.recirculation_fog_band_k > 0.0
            || self.recirculation_co2_band_ppm > 0.0
            || self.windscreen_below_fog_margin_k > 0.0
    }

    /// Holds the recirculation of each cabin back where its air calls for that, and blows air at its windscreen.
    #[inline]
    pub fn mind_air(&self, roles: &Roles, state: &State, demand: &mut Demand) {
        if !self.minds_air() {
            return;
        }
        let rows = roles.recirculation_rows.iter().zip(&roles.windscreen_rows);
        for (air, (&recirculation, &windscreen)) in state.cabin_air.iter().zip(rows) {
            let fog_margin_k = air.fog_margin_k();
            demand[recirculation] *= self.recirculation_share(fog_margin_k, air.co2 * 1e6);
            demand[windscreen] = self.windscreen_share(fog_margin_k);
        }
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
            fresh_below_fog_margin_k: 1.0,
            recirculation_fog_band_k: 4.0,
            fresh_above_co2_ppm: 1200.0,
            recirculation_co2_band_ppm: 400.0,
            windscreen_below_fog_margin_k: 3.0,
        }
    }

    #[test]
    fn air_goes_round_as_far_as_fog_and_carbon_dioxide_allow() {
        let share = |margin_k, co2_ppm| modern().recirculation_share(margin_k, co2_ppm);
        assert_eq!((share(20.0, 420.0), share(1.0, 420.0), share(-3.0, 420.0)), (1.0, 0.0, 0.0));
        assert_eq!((share(3.0, 420.0), share(20.0, 1000.0), share(3.0, 1100.0)), (0.5, 0.5, 0.25));
        assert_eq!(share(20.0, 2000.0), 0.0);
        let none = Options::default();
        assert_eq!((none.recirculation_share(-5.0, 9000.0), none.windscreen_share(-5.0)), (1.0, 0.0));
        assert!(!none.minds_air() && modern().minds_air());
    }

    #[test]
    fn air_is_blown_at_a_windscreen_that_is_about_to_fog_up() {
        let share = |margin_k| modern().windscreen_share(margin_k);
        assert_eq!((share(3.0), share(1.5), share(0.0), share(-2.0)), (0.0, 0.5, 1.0, 1.0));
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
