//! Coolant pump under a PID that follows the flow demand (paper section 2.3).

use super::pid::{IncrementalPid, PidParameters};
use crate::parameters;
use serde::{Deserialize, Serialize};

/// Time constant of the coolant column [s] (assumed; about a second for a loop of 10 m and 0.1 bar).
const FLOW_TIME_CONSTANT_S: f64 = 1.0;

parameters! {
    /// Circulation pump under a PID that follows the flow demand.
    pub struct PumpParameters {
        /// Largest coolant flow [kg/s].
        maximum_flow_kg_s: f64 = 0.01 .. 5.0,
        /// Smallest coolant flow while the vehicle is on [kg/s].
        minimum_flow_kg_s: f64 = 0.001 .. 1.0,
        /// Electrical power at the largest flow; it warms the coolant [W].
        maximum_power_w: f64 = 0.0 .. 2000.0,
        ;
        /// Controller on the flow.
        pid: PidParameters,
    }
}

/// Flow and controller memory of a pump.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PumpState {
    /// Coolant flow [kg/s].
    pub flow_kg_s: f64,
    /// Drive signal as a share of full speed, with the controller's memory.
    pub pid: IncrementalPid,
}

/// Share of the way to its steady flow that the coolant column moves in a period.
#[must_use]
pub fn flow_approach(period_s: f64) -> f64 {
    1.0 - (-period_s / FLOW_TIME_CONSTANT_S).exp()
}

impl PumpParameters {
    /// A pump idling at its smallest flow.
    #[must_use]
    pub fn idle(&self) -> PumpState {
        let share = self.minimum_flow_kg_s / self.maximum_flow_kg_s;
        PumpState { flow_kg_s: self.minimum_flow_kg_s, pid: IncrementalPid::at(share) }
    }

    /// One control period of the pump.
    ///
    /// `approach` is [`flow_approach`] of the period.
    pub fn follow(&self, state: &mut PumpState, demand_kg_s: f64, period_s: f64, approach: f64) {
        let demand_kg_s = demand_kg_s.clamp(self.minimum_flow_kg_s, self.maximum_flow_kg_s);
        let per_maximum_s_kg = self.maximum_flow_kg_s.recip();
        let error = (demand_kg_s - state.flow_kg_s) * per_maximum_s_kg;
        let low = self.minimum_flow_kg_s * per_maximum_s_kg;
        let drive = state.pid.update(&self.pid, error, period_s, low, 1.0);
        state.flow_kg_s += approach * (drive * self.maximum_flow_kg_s - state.flow_kg_s);
    }

    /// Electrical power; rises with the cube of the flow [W].
    #[must_use]
    pub fn power_w(&self, flow_kg_s: f64) -> f64 {
        self.maximum_power_w * (flow_kg_s / self.maximum_flow_kg_s).powi(3)
    }
}
