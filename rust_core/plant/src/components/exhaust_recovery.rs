//! Exhaust recovery: part of the heat in the leaving cabin air warms the chiller return (paper section 2.2, equation (6)).

use crate::numerics::thermal_network::LinkState;

/// Smallest temperature difference that the exhaust recovery leaves to the chiller supply [K] (assumed).
pub const RECOVERY_APPROACH_K: f64 = 1.0;

/// Exhaust recovery during a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ExhaustRecovery {
    /// Conductance; 0 when it is off [W/K].
    pub conductance_w_k: f64,
    /// Whether it is limited by the chiller supply rather than by ambient.
    pub meets_chiller: bool,
}

/// What decides about the recovery [K].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecoveryTemperatures {
    /// Cabin.
    pub cabin_k: f64,
    /// Chiller supply.
    pub chiller_supply_k: f64,
    /// Ambient.
    pub ambient_k: f64,
}

impl ExhaustRecovery {
    /// It works while the cabin is heated and warmer than ambient and chiller supply.
    ///
    /// `largest_w_k` is the recoverable share of the exhaust's capacity rate. Only heat above ambient is "exhaust heat".
    #[must_use]
    #[inline]
    pub fn during(largest_w_k: f64, cabin_is_heated: bool, temperatures: &RecoveryTemperatures) -> Self {
        let RecoveryTemperatures { cabin_k, chiller_supply_k, ambient_k } = *temperatures;
        let lowest_k = chiller_supply_k + RECOVERY_APPROACH_K;
        let recovers = cabin_is_heated && cabin_k > lowest_k && cabin_k > ambient_k;
        Self {
            conductance_w_k: if recovers { largest_w_k } else { 0.0 },
            meets_chiller: lowest_k > ambient_k,
        }
    }

    /// States of the links from cabin to ambient and from cabin to chiller supply, one of which is open.
    #[must_use]
    #[inline]
    pub fn links(&self, ambient_k: f64) -> (LinkState, LinkState) {
        if self.meets_chiller {
            let to_chiller =
                LinkState { offset_k: -RECOVERY_APPROACH_K, ..LinkState::conductance(self.conductance_w_k) };
            (LinkState::OPEN, to_chiller)
        } else {
            (LinkState::to_fixed(self.conductance_w_k, ambient_k), LinkState::OPEN)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn during(cabin_k: f64, chiller_supply_k: f64, ambient_k: f64) -> ExhaustRecovery {
        ExhaustRecovery::during(50.0, true, &RecoveryTemperatures { cabin_k, chiller_supply_k, ambient_k })
    }

    #[test]
    fn recovers_only_what_is_warmer_than_ambient_and_chiller_supply() {
        assert_eq!(during(295.0, 260.0, 270.0).conductance_w_k, 50.0);
        assert_eq!(during(269.0, 260.0, 270.0).conductance_w_k, 0.0);
        assert_eq!(during(295.0, 294.5, 270.0).conductance_w_k, 0.0);
        let temperatures = RecoveryTemperatures { cabin_k: 295.0, chiller_supply_k: 260.0, ambient_k: 270.0 };
        assert_eq!(ExhaustRecovery::during(50.0, false, &temperatures).conductance_w_k, 0.0);
    }

    #[test]
    fn the_warmer_of_ambient_and_chiller_supply_limits_it() {
        let (ambient, chiller) = during(295.0, 260.0, 270.0).links(270.0);
        assert_eq!((ambient, chiller), (LinkState::to_fixed(50.0, 270.0), LinkState::OPEN));
        let (ambient, chiller) = during(295.0, 280.0, 270.0).links(270.0);
        assert_eq!(ambient, LinkState::OPEN);
        assert_eq!((chiller.conductance_w_k, chiller.offset_k), (50.0, -RECOVERY_APPROACH_K));
    }
}
