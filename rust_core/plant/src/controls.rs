//! The plant's own controls, once a control period: connections, pumps, switches, heaters, condensing pressure.

use crate::air_side;
use crate::architecture::indices::Indices;
use crate::architecture::layout::{
    BRANCH_PLACES, CABIN_PLACES, FRONT_END_PLACES, HEATER_PLACES, LOOP_PLACES,
};
use crate::circuits::branches::{BranchFlows, BranchTable, BranchTemperatures, BranchValues, differences_k};
use crate::circuits::front_ends::{self, Asked, FrontAirs};
use crate::command::Demand;
use crate::components::cabin::Ventilation;
use crate::components::pid::ResetGains;
use crate::components::pump;
use crate::components::wet_core::WetSurface;
use crate::config::vehicle::VehicleParameters;
use crate::network::shape::{Shape, each};
use crate::state::State;
use crate::step_parameters::StepParameters;
use crate::surroundings::{CONTROL_PERIOD_S, Disturbance};

/// Pascal in a bar.
const PASCAL_PER_BAR: f64 = 1e5;

/// What the controls fixed for one control period.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Period {
    pub demand: Demand,
    pub ventilation: [Ventilation; CABIN_PLACES],
    pub core_inlet_k: [f64; CABIN_PLACES],
    /// Cooling cores on which water condenses.
    pub wet_cores: [Option<WetSurface>; CABIN_PLACES],
    pub front_end_air_k: [f64; FRONT_END_PLACES],
    pub front: FrontAirs,
    pub branches_w_k: BranchValues,
    pub rates_w_k: [f64; LOOP_PLACES],
    pub pumps_w: [f64; LOOP_PLACES],
    pub heaters_w: [f64; HEATER_PLACES],
    pub compressor_demand_w: f64,
}

impl Period {
    /// A period of a demand, all else still to come.
    #[inline(always)]
    pub fn of(demand: Demand) -> Self {
        Self {
            demand,
            ventilation: [Ventilation::default(); CABIN_PLACES],
            core_inlet_k: [0.0; CABIN_PLACES],
            wet_cores: [None; CABIN_PLACES],
            front_end_air_k: [0.0; FRONT_END_PLACES],
            front: FrontAirs::default(),
            branches_w_k: [0.0; BRANCH_PLACES],
            rates_w_k: [0.0; LOOP_PLACES],
            pumps_w: [0.0; LOOP_PLACES],
            heaters_w: [0.0; HEATER_PLACES],
            compressor_demand_w: 0.0,
        }
    }
}

/// What the controls need of gains and time constants, worked out for the control period.
#[derive(Debug, Clone)]
pub(crate) struct Controls {
    pub pressure: ResetGains,
    flow_approach: f64,
}

/// What controls look at besides the state.
#[derive(Clone, Copy)]
pub(crate) struct Sight<'a> {
    pub vehicle: &'a VehicleParameters,
    pub parameters: &'a StepParameters,
    pub shape: &'a Indices<'a>,
    pub disturbance: &'a Disturbance,
}

impl Controls {
    /// Gains of a vehicle.
    pub fn of(vehicle: &VehicleParameters) -> Self {
        Self {
            pressure: ResetGains::new(&vehicle.controls.pressure_pid, CONTROL_PERIOD_S),
            flow_approach: pump::flow_approach(CONTROL_PERIOD_S),
        }
    }

    /// The plant's own controls, once a control period.
    #[inline(always)]
    pub fn begin_period<S: Shape>(
        &self,
        sight: Sight<'_>,
        branches: &BranchTable,
        state: &mut State,
        period: &mut Period,
    ) {
        enter_air::<S>(sight, state, period);
        enter_front_end_air::<S>(sight, state, period);
        self.demand_compression(sight, state, period);
        self.connect::<S>(sight, branches, state, period);
        keep_cores_free_of_ice::<S>(sight, state, period);
        air_side::wet_cores::<S>(sight, state, period);
        self.demand_heat::<S>(sight, state, period);
    }

    /// Grants connections, moves pumps, fans and switches.
    #[inline(always)]
    fn connect<S: Shape>(
        &self,
        sight: Sight<'_>,
        branches: &BranchTable,
        state: &mut State,
        period: &mut Period,
    ) {
        let Sight { vehicle, parameters, shape, disturbance } = sight;
        let temperatures = temperatures::<S>(sight, state, period);
        let differences_k = differences_k::<S>(shape, &temperatures);
        let ambient_k = disturbance.air.temperature_k;
        branches.grant::<S>(shape, &period.demand, &differences_k, ambient_k, &mut state.connected);
        each!(S::loops(shape) => |circuit, indices| {
            let (pump, state) = (&parameters.pumps[circuit], &mut state.pumps[circuit]);
            let wanted_kg_s = period.demand.0[usize::from(indices.flow_row)];
            pump.follow(state, wanted_kg_s, CONTROL_PERIOD_S, self.flow_approach);
            period.rates_w_k[circuit] = state.flow_kg_s * parameters.specific_heats_j_kg_k[circuit];
            period.pumps_w[circuit] = pump.power_w(state.flow_kg_s);
        });
        let flows = BranchFlows { rates_w_k: period.rates_w_k, ventilation: period.ventilation };
        let mut requests_w = [0.0; BRANCH_PLACES];
        each!(S::branches(shape) => |i, branch| { requests_w[i] = period.demand.0[usize::from(branch.request_row)]; });
        let coolant_w_k = branches.coolant_rates_w_k::<S>(shape, &period.demand, &flows, &state.connected);
        let asked = Asked {
            demand: &period.demand,
            connected: &state.connected,
            requests_w: &requests_w,
            differences_k: &differences_k,
            coolant_w_k: &coolant_w_k,
            compressor_w: period.compressor_demand_w,
        };
        period.front = front_ends::blow::<S>(shape, parameters, disturbance, &state.frosts, &asked);
        let largest_w_k = branches.largest_conductances_w_k::<S>(
            shape,
            &flows,
            &period.front,
            &state.connected,
            &coolant_w_k,
        );
        let places = shape.branch_places().min(BRANCH_PLACES);
        let gains = &vehicle.controls.thermal_switch.pid;
        let positions =
            state.switches.track(gains, &requests_w, &largest_w_k, &differences_k, CONTROL_PERIOD_S, places);
        for i in 0..places {
            period.branches_w_k[i] = positions[i] * largest_w_k[i];
        }
    }

    /// Power that the heaters' PIDs on the cabin temperature ask for.
    #[inline(always)]
    fn demand_heat<S: Shape>(&self, sight: Sight<'_>, state: &mut State, period: &mut Period) {
        let Some(set_point_row) = sight.shape.set_point_row else { return };
        let cabin_k = state.temperatures_k[sight.shape.cabins[0].air.index()];
        each!(S::heaters(sight.shape) => |place, indices| {
            let (pid, highest_w) = (&mut state.heater_pids[place], sight.parameters.heaters[place].maximum_power_w);
            period.heaters_w[place] = if period.demand.0[usize::from(indices.row)] > 0.5 {
                let error_k = period.demand.0[usize::from(set_point_row)] - cabin_k;
                pid.output(&sight.parameters.heater_gains[place], error_k, 0.0, highest_w)
            } else {
                pid.clear();
                0.0
            };
        });
    }

    /// Smaller of the controller's demand and that of `PID_pressureControl` (paper section 2.3).
    #[inline(always)]
    fn demand_compression(&self, sight: Sight<'_>, state: &mut State, period: &mut Period) {
        let (Some(row), Some(refrigeration)) = (sight.shape.compressor_row, &sight.vehicle.refrigeration)
        else {
            return;
        };
        let error_bar = refrigeration.maximum_pressure_bar - state.condensing_pressure_pa / PASCAL_PER_BAR;
        let highest_w = refrigeration.compressor.maximum_power_w;
        let pressure_w = state.pressure_pid.output(&self.pressure, error_bar, 0.0, highest_w);
        period.compressor_demand_w = period.demand.0[usize::from(row)].min(pressure_w);
    }
}

/// Air flows of each cabin, and the air into its cores.
#[inline(always)]
fn enter_air<S: Shape>(sight: Sight<'_>, state: &State, period: &mut Period) {
    let Disturbance { occupants, air, .. } = sight.disturbance;
    each!(S::cabins(sight.shape) => |place, cabin| {
        let (level, recirculation) =
            (period.demand.0[cabin.blower_row], period.demand.0[cabin.recirculation_row]);
        let occupants = occupants * sight.parameters.occupant_shares[place];
        let ventilation = sight.parameters.cabins[place].ventilation(level, recirculation, occupants);
        let cabin_k = state.temperatures_k[cabin.air.index()];
        period.core_inlet_k[place] = (1.0 - ventilation.recirculation) * air.temperature_k
            + ventilation.recirculation * cabin_k;
        period.ventilation[place] = ventilation;
    });
}

/// Air at each front-end exchanger: ambient, warmed or cooled by the exchangers before it in the last second, and
/// warmer by what vapour that becomes frost gives off.
#[inline(always)]
pub(crate) fn enter_front_end_air<S: Shape>(sight: Sight<'_>, state: &State, period: &mut Period) {
    each!(S::front_ends(sight.shape) => |place, indices| {
        let mut air_k = sight.disturbance.air.temperature_k + state.frosts[place].rise_k;
        if indices.shares_air {
            let mut before = indices.behind;
            while let Some(other) = before {
                air_k += state.front_end_rise_k[usize::from(other)];
                before = sight.shape.front_ends[usize::from(other)].behind;
            }
        }
        period.front_end_air_k[place] = air_k;
    });
}

/// Temperatures that decide about connections.
#[inline(always)]
pub(crate) fn temperatures<S: Shape>(sight: Sight<'_>, state: &State, period: &Period) -> BranchTemperatures {
    let mut behind_exchanger_k = [0.0; LOOP_PLACES];
    each!(S::loops(sight.shape) => |place, indices| {
        if indices.has_series {
            let specific_heat_j_kg_k = sight.parameters.specific_heats_j_kg_k[place];
            let rate_w_k = state.pumps[place].flow_kg_s * specific_heat_j_kg_k;
            behind_exchanger_k[place] =
                state.temperatures_k[indices.back.index()] + state.entered_w[place] / rate_w_k;
        }
    });
    BranchTemperatures {
        nodes_k: state.temperatures_k,
        front_end_air_k: period.front_end_air_k,
        core_inlet_k: period.core_inlet_k,
        behind_exchanger_k,
    }
}

#[inline(always)]
fn keep_cores_free_of_ice<S: Shape>(sight: Sight<'_>, state: &State, period: &mut Period) {
    let shape = sight.shape;
    each!(S::cabins(shape) => |place, cabin| {
        if let Some(cooler) = cabin.cooler {
            let supply = shape.loops[usize::from(shape.branches[cooler].circuit)].supply;
            let coolant_k = state.temperatures_k[supply.index()];
            let (ventilation, inlet_k) = (&period.ventilation[place], period.core_inlet_k[place]);
            let parameters = &sight.parameters.cabins[place];
            let largest_w_k = parameters.cooling_core_without_ice_w_k(ventilation, inlet_k, coolant_k);
            period.branches_w_k[cooler] = period.branches_w_k[cooler].min(largest_w_k);
        }
    });
}
