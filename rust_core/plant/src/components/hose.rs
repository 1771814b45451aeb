//! Hoses and pipes of a coolant loop, which lose heat to ambient.

use super::coolant_loop::CircuitParameters;

impl CircuitParameters {
    /// Conductance to ambient of the hoses at one end of the loop, supply or return: half of them each [W/K].
    #[must_use]
    #[inline]
    pub fn half_hose_conductance_w_k(&self) -> f64 {
        0.5 * self.hose_conductance_w_k
    }
}
