//! The plant's own controls, once a control period: connections, pumps, switches, PTC, condensing pressure.

use super::{CONTROL_PERIOD_S, Disturbance, Plant};
use crate::circuits::assembly::NODES;
use crate::circuits::branches::{self, BRANCH_PLACES, Branch, BranchFlows, BranchTemperatures, BranchValues};
use crate::command::Demand;
use crate::components::cabin::Ventilation;
use crate::components::pid::ResetGains;
use crate::components::pump;
use crate::config::vehicle::VehicleParameters;
use crate::numerics::thermal_network::Node;
use crate::state::State;

/// Pascal in a bar.
const PASCAL_PER_BAR: f64 = 1e5;

/// What the controls fixed for one control period.
pub(super) struct Period {
    pub demand: Demand,
    pub ventilation: Ventilation,
    pub branches_w_k: BranchValues,
    pub htc_rate_w_k: f64,
    pub chiller_rate_w_k: f64,
    pub pumps_w: [f64; 2],
    pub ptc_demand_w: f64,
    pub compressor_demand_w: f64,
}

/// What the controls need of gains and time constants, worked out for the control period.
#[derive(Debug, Clone)]
pub(super) struct ControlGains {
    pub ptc: ResetGains,
    pub pressure: ResetGains,
    flow_approach: f64,
}

impl ControlGains {
    /// Gains of a vehicle.
    pub fn of(vehicle: &VehicleParameters) -> Self {
        Self {
            ptc: ResetGains::new(&vehicle.ptc.pid, CONTROL_PERIOD_S),
            pressure: ResetGains::new(&vehicle.controls.pressure_pid, CONTROL_PERIOD_S),
            flow_approach: pump::flow_approach(CONTROL_PERIOD_S),
        }
    }
}

impl Plant {
    /// Temperatures that decide about connections.
    #[must_use]
    pub fn branch_temperatures(
        &self,
        state: &State,
        recirculation: f64,
        ambient_k: f64,
    ) -> BranchTemperatures {
        let nodes = NODES;
        let at = |node: Node| state.temperatures_k[node.index()];
        let htc_rate_w_k = state.htc_pump.flow_kg_s * self.vehicle.htc.circuit.coolant_specific_heat_j_kg_k;
        BranchTemperatures {
            htc_supply_k: at(nodes.htc_supply),
            condenser_outlet_k: at(nodes.htc_return) + state.condenser_heat_flow_w / htc_rate_w_k,
            chiller_supply_k: at(nodes.chiller_supply),
            battery_k: at(nodes.battery),
            motor_k: at(nodes.motor),
            transmission_k: at(nodes.transmission),
            thermal_battery_k: at(nodes.thermal_battery),
            core_inlet_k: (1.0 - recirculation) * ambient_k + recirculation * at(nodes.cabin),
            ambient_k,
        }
    }

    /// The plant's own controls, once a control period: connections, pumps, switches, PTC, pressure.
    pub(super) fn begin_period(
        &self,
        state: &mut State,
        demand: Demand,
        disturbance: &Disturbance,
    ) -> Period {
        let vehicle = &self.vehicle;
        let speed_m_s = 0.5 * (disturbance.start_speed_m_s + disturbance.end_speed_m_s);
        let ventilation =
            vehicle.cabin.ventilation(demand.blower_level, demand.recirculation, disturbance.occupants);
        let temperatures =
            self.branch_temperatures(state, ventilation.recirculation, disturbance.air.temperature_k);
        state.connected = branches::grant(vehicle, &demand.connections, &temperatures, &state.connected);
        for (pump, state, demand_kg_s) in [
            (&vehicle.htc.circuit.pump, &mut state.htc_pump, demand.htc_flow_kg_s),
            (&vehicle.chiller.circuit.pump, &mut state.chiller_pump, demand.chiller_flow_kg_s),
        ] {
            pump.follow(state, demand_kg_s, CONTROL_PERIOD_S, self.gains.flow_approach);
        }
        let flows = BranchFlows {
            htc_rate_w_k: state.htc_pump.flow_kg_s * vehicle.htc.circuit.coolant_specific_heat_j_kg_k,
            chiller_rate_w_k: state.chiller_pump.flow_kg_s
                * vehicle.chiller.circuit.coolant_specific_heat_j_kg_k,
            ventilation,
            speed_m_s,
        };
        let largest_w_k = self.branches.largest_conductances_w_k(&demand, &flows, &state.connected);
        let mut requests_w = [0.0; BRANCH_PLACES];
        for branch in Branch::ALL {
            requests_w[branch as usize] = demand.requests_w[branch.member() as usize];
        }
        let mut branches_w_k = state.switches.track(
            &vehicle.controls.thermal_switch.pid,
            &requests_w,
            &largest_w_k,
            &temperatures.differences_k(),
            CONTROL_PERIOD_S,
        );
        for (position, largest_w_k) in branches_w_k.iter_mut().zip(largest_w_k) {
            *position *= largest_w_k;
        }
        let (inlet_k, coolant_k) = (temperatures.core_inlet_k, temperatures.chiller_supply_k);
        let cooling_core_w_k = &mut branches_w_k[Branch::CabinChiller as usize];
        *cooling_core_w_k = cooling_core_w_k.min(vehicle.cabin.cooling_core_without_ice_w_k(
            &flows.ventilation,
            inlet_k,
            coolant_k,
        ));
        Period {
            demand,
            ventilation: flows.ventilation,
            branches_w_k,
            htc_rate_w_k: flows.htc_rate_w_k,
            chiller_rate_w_k: flows.chiller_rate_w_k,
            pumps_w: [
                vehicle.htc.circuit.pump.power_w(state.htc_pump.flow_kg_s),
                vehicle.chiller.circuit.pump.power_w(state.chiller_pump.flow_kg_s),
            ],
            ptc_demand_w: self.ptc_demand_w(state, &demand),
            compressor_demand_w: self.compressor_demand_w(state, &demand),
        }
    }

    /// PTC power that its PID on the cabin temperature asks for.
    fn ptc_demand_w(&self, state: &mut State, demand: &Demand) -> f64 {
        let ptc = &self.vehicle.ptc;
        if !demand.ptc_allowed {
            state.ptc_pid.clear();
            return 0.0;
        }
        let error_k = demand.cabin_set_point_k - state.temperatures_k[NODES.cabin.index()];
        state.ptc_pid.output(&self.gains.ptc, error_k, 0.0, ptc.maximum_power_w)
    }

    /// Smaller of the controller's demand and that of `PID_pressureControl` (paper section 2.3).
    fn compressor_demand_w(&self, state: &mut State, demand: &Demand) -> f64 {
        let refrigeration = &self.vehicle.refrigeration;
        let error_bar = refrigeration.maximum_pressure_bar - state.condensing_pressure_pa / PASCAL_PER_BAR;
        let pressure_w = state.pressure_pid.output(
            &self.gains.pressure,
            error_bar,
            0.0,
            refrigeration.compressor.maximum_power_w,
        );
        demand.compressor_power_w.min(pressure_w)
    }
}
