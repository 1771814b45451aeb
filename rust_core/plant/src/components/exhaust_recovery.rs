//! Exhaust recovery: part of the heat in the leaving cabin air warms the return of a cold loop (paper section 2.2).

use crate::numerics::thermal_network::LinkState;

/// Smallest temperature difference that the exhaust recovery leaves to the loop supply [K] (assumed).
pub const RECOVERY_APPROACH_K: f64 = 1.0;

/// Exhaust recovery during a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ExhaustRecovery {
    /// Conductance; 0 when it is off [W/K].
    pub conductance_w_k: f64,
    /// Whether it is limited by the loop supply rather than by ambient.
    pub meets_loop: bool,
}

/// What decides about the recovery [K].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecoveryTemperatures {
    /// Cabin.
    pub cabin_k: f64,
    /// Supply of the loop.
    pub supply_k: f64,
    /// Ambient.
    pub ambient_k: f64,
}

impl ExhaustRecovery {
    /// It works while the cabin is heated and warmer than ambient and loop supply.
    ///
    /// `largest_w_k` is the recoverable share of the exhaust's capacity rate. Only heat above ambient is "exhaust heat".
    #[must_use]
    #[inline]
    pub fn during(largest_w_k: f64, cabin_is_heated: bool, temperatures: &RecoveryTemperatures) -> Self {
        let RecoveryTemperatures { cabin_k, supply_k, ambient_k } = *temperatures;
        let lowest_k = supply_k + RECOVERY_APPROACH_K;
        let recovers = cabin_is_heated && cabin_k > lowest_k && cabin_k > ambient_k;
        Self { conductance_w_k: if recovers { largest_w_k } else { 0.0 }, meets_loop: lowest_k > ambient_k }
    }

    /// State of the link from cabin to ambient, open while the loop limits it.
    #[must_use]
    #[inline(always)]
    pub fn from_ambient(&self, ambient_k: f64) -> LinkState {
        if self.meets_loop { LinkState::OPEN } else { LinkState::to_fixed(self.conductance_w_k, ambient_k) }
    }

    /// State of the link from cabin to the loop's supply, open while ambient limits it.
    #[must_use]
    #[inline(always)]
    pub fn from_loop(&self) -> LinkState {
        if self.meets_loop {
            LinkState { offset_k: -RECOVERY_APPROACH_K, ..LinkState::conductance(self.conductance_w_k) }
        } else {
            LinkState::OPEN
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn during(cabin_k: f64, supply_k: f64, ambient_k: f64) -> ExhaustRecovery {
        ExhaustRecovery::during(50.0, true, &RecoveryTemperatures { cabin_k, supply_k, ambient_k })
    }

    #[test]
    fn recovers_only_what_is_warmer_than_ambient_and_chiller_supply() {
        assert_eq!(during(295.0, 260.0, 270.0).conductance_w_k, 50.0);
        assert_eq!(during(269.0, 260.0, 270.0).conductance_w_k, 0.0);
        assert_eq!(during(295.0, 294.5, 270.0).conductance_w_k, 0.0);
        let temperatures = RecoveryTemperatures { cabin_k: 295.0, supply_k: 260.0, ambient_k: 270.0 };
        assert_eq!(ExhaustRecovery::during(50.0, false, &temperatures).conductance_w_k, 0.0);
    }

    #[test]
    fn the_warmer_of_ambient_and_chiller_supply_limits_it() {
        let recovery = during(295.0, 260.0, 270.0);
        let (ambient, chiller) = (recovery.from_ambient(270.0), recovery.from_loop());
        assert_eq!((ambient, chiller), (LinkState::to_fixed(50.0, 270.0), LinkState::OPEN));
        let recovery = during(295.0, 280.0, 270.0);
        let (ambient, chiller) = (recovery.from_ambient(270.0), recovery.from_loop());
        assert_eq!(ambient, LinkState::OPEN);
        assert_eq!((chiller.conductance_w_k, chiller.offset_k), (50.0, -RECOVERY_APPROACH_K));
    }
}
