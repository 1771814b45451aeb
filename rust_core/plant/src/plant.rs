//! The vehicle: one entry, [`Plant::step_into`] ([`Plant::step`] returns what it writes), pure and deterministic.

use crate::circuits::assembly::{Assembly, LinkConditions, NODES};
use crate::circuits::branches::{BRANCH_COUNT, Branch, BranchTable};
use crate::circuits::refrigeration_cycle::RefrigerationCycle;
use crate::circuits::refrigeration_loop::{
    CompressorAllowance, Limit, LoopBoundary, LoopResult, RefrigerationState, SupplyLimit,
};
use crate::command::{ActuatorRanges, Command};
use crate::components::battery::{Battery, BatteryStep, CircuitStep, PowerLimits};
use crate::components::exhaust_recovery::{ExhaustRecovery, RecoveryTemperatures};
use crate::components::pid::ResetPid;
use crate::components::powertrain::Powertrain;
use crate::config::initial::InitialParameters;
use crate::config::kinds::VEHICLE;
use crate::config::library::{self, Override};
use crate::config::vehicle::VehicleParameters;
use crate::control::thermal_switch::ThermalSwitches;
use crate::error::PlantResult;
use crate::flows::{Flow, Flows};
use crate::ledger::{self, LedgerEntry, StoredEnergyChange};
use crate::media::air::AirProperties;
use crate::media::refrigerant::RefrigerantTable;
use crate::numerics::thermal_network::{MAXIMUM_NODES, NodeValues};
use crate::state::State;
use controls::{ControlGains, Period};
use serde::{Deserialize, Serialize};

mod controls;

/// Period of all controllers and of a plant step [s].
pub const CONTROL_PERIOD_S: f64 = 1.0;

/// What the surroundings do during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disturbance {
    /// Vehicle speed at the beginning [m/s].
    pub start_speed_m_s: f64,
    /// Vehicle speed at the end [m/s].
    pub end_speed_m_s: f64,
    /// Ambient air.
    pub air: AirProperties,
    /// Solar heat into the cabin [W].
    pub solar_gain_w: f64,
    /// People in the cabin.
    pub occupants: f64,
}

/// What happened during a step.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct StepRecord {
    /// Mean flows.
    pub flows: Flows,
    /// Compressor power that was asked for [W].
    pub demanded_w: f64,
    /// Compressor power left by the pressure controller and the demand, before the caps [W].
    pub compressor_demand_w: f64,
    /// Refrigerant loop at the end of the step.
    pub refrigeration: LoopResult,
    /// What the coolants offered it.
    pub boundary: LoopBoundary,
    /// Mean terminal voltage [V].
    pub battery_voltage_v: f64,
    /// Mean pack current [A].
    pub battery_current_a: f64,
    /// Limits of the battery during the step.
    pub power_limits: PowerLimits,
    /// Worst ledger entry of the sub-steps.
    pub ledger: LedgerEntry,
    /// Thermal loads were cut because the battery could not feed them.
    pub loads_shed: bool,
}

/// A vehicle ready to run: parameters, tables and assembled network. It never changes; all that does is in
/// [`State`].
#[derive(Debug, Clone)]
pub struct Plant {
    /// Parameters.
    pub vehicle: VehicleParameters,
    /// Physical ranges of the actuators.
    pub ranges: ActuatorRanges,
    /// Battery with its tables.
    pub battery: Battery,
    /// Thermal network.
    pub assembly: Assembly,
    /// Refrigerant loop.
    pub refrigeration: RefrigerationCycle,
    /// Refrigerant properties.
    pub refrigerant: RefrigerantTable,
    branches: BranchTable,
    gains: ControlGains,
    substeps: u32,
}

/// Where in a step the flows are on show to the hook of [`Plant::step_with`].
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Electrical loads, before the battery feeds them.
    Loads,
    /// All flows, before the thermal network receives its heat.
    Heat,
    /// All flows, before the ledger balances them.
    Ledger,
}

impl Plant {
    /// Prepares a vehicle.
    ///
    /// # Errors
    /// The refrigerant is unknown or its table unusable with these parameters.
    pub fn new(vehicle: VehicleParameters) -> PlantResult<Self> {
        let table = RefrigerantTable::load(&vehicle.refrigerant)?;
        Ok(Self {
            ranges: ActuatorRanges::of(&vehicle),
            battery: Battery::new(&vehicle.battery),
            assembly: Assembly::of(&vehicle),
            refrigeration: RefrigerationCycle::new(vehicle.refrigeration.clone(), table.clone())
                .map_err(|violation| violation.within("refrigeration").in_file("vehicle"))?,
            refrigerant: table,
            branches: BranchTable::of(&vehicle),
            gains: ControlGains::of(&vehicle),
            vehicle,
            substeps: 1,
        })
    }

    /// Loads a vehicle by name with overrides.
    ///
    /// # Errors
    /// See [`library::load`].
    pub fn load(vehicle: &str, overrides: &[Override]) -> PlantResult<Self> {
        Self::new(library::load(VEHICLE, vehicle, overrides)?)
    }

    /// The same vehicle with each second integrated in several sub-steps; controllers stay at 1 s.
    #[must_use]
    pub fn with_substeps(mut self, substeps: u32) -> Self {
        self.substeps = substeps.max(1);
        self
    }

    /// A parked vehicle.
    #[must_use]
    pub fn parked(&self, initial: &InitialParameters) -> State {
        let soak_k = initial.soak_temperature_degc.kelvin();
        let nodes = NODES;
        let mut temperatures_k = [0.0; MAXIMUM_NODES];
        temperatures_k[..self.assembly.network.nodes()].fill(soak_k);
        if let Some(cabin) = initial.cabin_temperature_degc {
            for node in [nodes.cabin, nodes.exhaust, nodes.soft, nodes.hard] {
                temperatures_k[node.index()] = cabin.kelvin();
            }
        }
        for (node, value) in [
            (nodes.battery, initial.battery_temperature_degc),
            (nodes.thermal_battery, initial.thermal_battery_temperature_degc),
        ] {
            if let Some(value) = value {
                temperatures_k[node.index()] = value.kelvin();
            }
        }
        State {
            time_s: 0.0,
            temperatures_k,
            battery: self.battery.rested(initial.state_of_charge_pct / 100.0),
            connected: [false; BRANCH_COUNT],
            switches: ThermalSwitches::default(),
            htc_pump: self.vehicle.htc.circuit.pump.idle(),
            chiller_pump: self.vehicle.chiller.circuit.pump.idle(),
            ptc_pid: ResetPid::default(),
            pressure_pid: ResetPid::default(),
            refrigeration: RefrigerationState::parked(),
            condensing_pressure_pa: self.refrigerant.saturation_pressure_pa(soak_k),
            condenser_heat_flow_w: 0.0,
            ptc_power_w: 0.0,
            compressor_power_w: 0.0,
        }
    }

    /// Steps the vehicle by one control period.
    pub fn step(&self, state: &mut State, command: &Command, disturbance: &Disturbance) -> StepRecord {
        let mut record = StepRecord::default();
        self.step_into(state, command, disturbance, &mut record);
        record
    }

    /// [`Plant::step`] that writes what happened to where it is kept.
    pub fn step_into(
        &self,
        state: &mut State,
        command: &Command,
        disturbance: &Disturbance,
        record: &mut StepRecord,
    ) {
        self.step_with(state, command, disturbance, record, |_, _| {});
    }

    /// [`Plant::step_into`] with a hook that sees, and may falsify, the flows inside the vehicle; tests of the energy
    /// ledger use it.
    #[doc(hidden)]
    #[inline]
    pub fn step_with(
        &self,
        state: &mut State,
        command: &Command,
        disturbance: &Disturbance,
        record: &mut StepRecord,
        mut tamper: impl FnMut(Stage, &mut Flows),
    ) {
        let demand = self.ranges.decode(command);
        let period = self.begin_period(state, demand, disturbance);
        self.substep(state, &period, disturbance, 0, record, &mut tamper);
        if self.substeps > 1 {
            let share = 1.0 / f64::from(self.substeps);
            let mut mean = Flows::default();
            mean.accumulate(&record.flows, share);
            let (mut voltage_v, mut current_a) =
                (record.battery_voltage_v * share, record.battery_current_a * share);
            for part in 1..self.substeps {
                let before = (record.ledger, record.loads_shed);
                self.substep(state, &period, disturbance, part, record, &mut tamper);
                mean.accumulate(&record.flows, share);
                voltage_v += record.battery_voltage_v * share;
                current_a += record.battery_current_a * share;
                if before.0.relative() >= record.ledger.relative() {
                    record.ledger = before.0;
                }
                record.loads_shed |= before.1;
            }
            record.flows = mean;
            record.battery_voltage_v = voltage_v;
            record.battery_current_a = current_a;
        }
        state.time_s += CONTROL_PERIOD_S;
        state.ptc_power_w = record.flows[Flow::Ptc];
        state.compressor_power_w = record.flows[Flow::Compressor];
        state.condenser_heat_flow_w = record.flows[Flow::Condenser];
        state.ptc_pid.applied(&self.gains.ptc, state.ptc_power_w);
        state.pressure_pid.applied(&self.gains.pressure, state.compressor_power_w);
    }

    /// One integration step: traction demand, refrigerant loop, thermal loads, regeneration and battery,
    /// thermal network, ledger.
    fn substep(
        &self,
        state: &mut State,
        period: &Period,
        disturbance: &Disturbance,
        part: u32,
        record: &mut StepRecord,
        tamper: &mut impl FnMut(Stage, &mut Flows),
    ) {
        let vehicle = &self.vehicle;
        let nodes = NODES;
        let step_s = CONTROL_PERIOD_S / f64::from(self.substeps);
        let acceleration = (disturbance.end_speed_m_s - disturbance.start_speed_m_s) / CONTROL_PERIOD_S;
        let start_m_s = disturbance.start_speed_m_s + acceleration * step_s * f64::from(part);
        let end_m_s = start_m_s + acceleration * step_s;
        let speed_m_s = 0.5 * (start_m_s + end_m_s);
        let flows = &mut record.flows;
        *flows = Flows::default();

        // Traction demand.
        let road = vehicle.body.road_load(start_m_s, end_m_s, step_s, disturbance.air.density_kg_m3);
        let wheel_w = road.wheel_power_w();
        let oil_k = state.temperatures_k[nodes.transmission.index()];
        let powertrain = Powertrain {
            motor: &vehicle.motor,
            transmission: &vehicle.transmission,
            regeneration: &vehicle.regeneration,
            speed_m_s,
            spin_loss_w: vehicle.transmission.spin_loss_w(oil_k, speed_m_s),
        };
        let driving = (wheel_w >= 0.0).then(|| powertrain.drive(wheel_w));
        flows[Flow::Drag] = road.drag_power_w;
        flows[Flow::Rolling] = road.rolling_power_w;
        flows[Flow::Kinetic] = road.kinetic_power_w;
        flows[Flow::Wheel] = wheel_w;

        // Loads that are always there.
        flows[Flow::Auxiliary] = vehicle.controls.auxiliary_power_w;
        [flows[Flow::HtcPump], flows[Flow::ChillerPump]] = period.pumps_w;
        flows[Flow::Blower] = period.ventilation.blower_power_w;
        flows[Flow::Fan] = self.fan_power_w(state, speed_m_s);
        flows[Flow::Solar] = disturbance.solar_gain_w;
        flows[Flow::Occupants] = disturbance.occupants * vehicle.cabin.occupant_heat_w;

        // What the battery can still give to thermal loads.
        let battery_k = state.temperatures_k[nodes.battery.index()];
        let circuit = self.battery.during(&state.battery, battery_k, step_s);
        let limits = circuit.power_limits();
        let driving_w = driving.map_or(0.0, |flow| flow.electrical_power_w);
        let spare_w = (limits.discharge_w - driving_w - flows.base_load_w()).max(0.0);

        // Refrigerant loop, its caps at the end of the step included.
        let conditions = self.link_conditions(state, period, disturbance, speed_m_s);
        let links = self.assembly.links(vehicle, &conditions);
        let factorised = self.assembly.network.factorise(&links, step_s);
        if let Some(driving) = driving {
            flows[Flow::MotorLoss] = driving.motor_loss_w;
            flows[Flow::TransmissionLoss] = driving.transmission_loss_w;
        }
        let without_heat_pump_k =
            factorised.advance(&state.temperatures_k, &self.heat_sources(flows, &conditions));
        let hot_response = factorised.response(&self.assembly.condenser_sources(1.0, &conditions));
        let mut cold_source = NodeValues::default();
        cold_source[nodes.chiller_supply.index()] = 1.0;
        let cold_response = factorised.response(&cold_source);
        let boundary = LoopBoundary {
            hot_return_k: state.temperatures_k[nodes.htc_return.index()],
            cold_return_k: state.temperatures_k[nodes.chiller_return.index()],
            hot_capacity_rate_w_k: period.htc_rate_w_k,
            cold_capacity_rate_w_k: period.chiller_rate_w_k,
            hot_supply: SupplyLimit {
                base_k: without_heat_pump_k[nodes.htc_supply.index()],
                sensitivity_k_w: hot_response[nodes.htc_supply.index()],
                limit_k: vehicle.htc.maximum_supply_degc.kelvin(),
            },
            cold_supply: SupplyLimit {
                base_k: without_heat_pump_k[nodes.chiller_supply.index()],
                sensitivity_k_w: cold_response[nodes.chiller_supply.index()],
                limit_k: vehicle.chiller.minimum_supply_degc.kelvin(),
            },
        };
        let compressor_w = period.compressor_demand_w.min(spare_w);
        let allowed =
            CompressorAllowance { demand_w: compressor_w, available_w: spare_w, may_start: part == 0 };
        let refrigeration = self.refrigeration.step(&mut state.refrigeration, &boundary, &allowed, step_s);
        flows[Flow::Compressor] = refrigeration.electric_power_w;
        flows[Flow::CompressorLoss] = refrigeration.loss_to_ambient_w;
        flows[Flow::Condenser] = refrigeration.condenser_heat_flow_w;
        flows[Flow::Evaporator] = refrigeration.evaporator_heat_flow_w;

        // PTC, off above its cut-off temperature: just enough to end the step there, continuous in all it
        // depends on.
        let hot_supply_k = boundary.hot_supply.base_k
            + boundary.hot_supply.sensitivity_k_w * refrigeration.condenser_heat_flow_w;
        let to_cutoff_w = vehicle.ptc.power_to_cutoff_w(hot_supply_k, boundary.hot_supply.sensitivity_k_w);
        let ptc_spare_w = (spare_w - refrigeration.electric_power_w).max(0.0);
        let ptc_w = period.ptc_demand_w.min(to_cutoff_w);
        flows[Flow::Ptc] = ptc_w.min(ptc_spare_w);
        let held_back = compressor_w < period.compressor_demand_w && refrigeration.limited_by == Limit::Power;
        let loads_shed = held_back || flows[Flow::Ptc] < ptc_w;

        // Regeneration against the charge limit with this step's loads, then the battery.
        let loads_w = flows.base_load_w() + flows[Flow::Compressor] + flows[Flow::Ptc];
        let traction = driving.unwrap_or_else(|| powertrain.brake(-wheel_w, limits.charge_w + loads_w));
        flows[Flow::Traction] = traction.electrical_power_w;
        flows[Flow::MotorLoss] = traction.motor_loss_w;
        flows[Flow::TransmissionLoss] = traction.transmission_loss_w;
        flows[Flow::FrictionBrake] = traction.friction_brake_power_w;
        tamper(Stage::Loads, flows);
        let battery = draw(&circuit, &limits, flows);

        // Thermal network.
        tamper(Stage::Heat, flows);
        let start_k = state.temperatures_k;
        let end_k = factorised.advance(&start_k, &self.heat_sources(flows, &conditions));
        self.assembly.record_flows(&links, &conditions, &end_k, flows);

        // Ledger.
        tamper(Stage::Ledger, flows);
        let stored = StoredEnergyChange {
            kinetic_j: vehicle.body.kinetic_energy_j(end_m_s) - vehicle.body.kinetic_energy_j(start_m_s),
            chemical_j: circuit.chemical_energy_gained_j(&battery.state),
            polarisation_j: self.battery.polarisation_energy_j(&battery.state)
                - self.battery.polarisation_energy_j(&state.battery),
            heat_j: self.assembly.network.heat_gained_j(&start_k, &end_k),
        };
        let ledger = ledger::balance(flows, &stored, step_s);

        state.temperatures_k = end_k;
        state.battery = battery.state;
        state.condensing_pressure_pa = refrigeration.condensing_pressure_pa;
        record.demanded_w = period.demand.compressor_power_w;
        record.compressor_demand_w = period.compressor_demand_w;
        record.refrigeration = refrigeration;
        record.boundary = boundary;
        record.battery_voltage_v = battery.voltage_v;
        record.battery_current_a = battery.current_a;
        record.power_limits = limits;
        record.ledger = ledger;
        record.loads_shed = loads_shed;
    }

    /// Fan of the front-end exchanger, on while that is connected [W].
    fn fan_power_w(&self, state: &State, speed_m_s: f64) -> f64 {
        let connected =
            state.connected[Branch::AmbientHtc as usize] || state.connected[Branch::AmbientChiller as usize];
        if connected { self.vehicle.ambient_exchanger.fan_power_w(speed_m_s) } else { 0.0 }
    }

    /// What the links of the thermal network depend on during a step.
    fn link_conditions(
        &self,
        state: &State,
        period: &Period,
        disturbance: &Disturbance,
        speed_m_s: f64,
    ) -> LinkConditions {
        let nodes = NODES;
        let temperatures = RecoveryTemperatures {
            cabin_k: state.temperatures_k[nodes.cabin.index()],
            chiller_supply_k: state.temperatures_k[nodes.chiller_supply.index()],
            ambient_k: disturbance.air.temperature_k,
        };
        let cabin_is_heated = period.branches_w_k[Branch::CabinHtc as usize] > 0.0;
        let recovery_w_k = self.vehicle.cabin.exhaust_recovery_share * period.ventilation.fresh_rate_w_k;
        LinkConditions {
            htc_rate_w_k: period.htc_rate_w_k,
            chiller_rate_w_k: period.chiller_rate_w_k,
            branches_w_k: period.branches_w_k,
            ventilation: period.ventilation,
            recovery: ExhaustRecovery::during(recovery_w_k, cabin_is_heated, &temperatures),
            speed_m_s,
            battery_ambient_w_k: self
                .vehicle
                .battery
                .plate
                .conductance_to_ambient_w_k(speed_m_s, &disturbance.air),
            ambient_k: disturbance.air.temperature_k,
        }
    }

    /// Heat that flows bring into the nodes [W].
    fn heat_sources(&self, flows: &Flows, conditions: &LinkConditions) -> NodeValues {
        let nodes = NODES;
        let mut sources = self.assembly.condenser_sources(flows[Flow::Condenser], conditions);
        sources[nodes.htc_supply.index()] += flows[Flow::Ptc];
        sources[nodes.htc_return.index()] += flows[Flow::HtcPump];
        sources[nodes.chiller_supply.index()] -= flows[Flow::Evaporator];
        sources[nodes.chiller_return.index()] += flows[Flow::ChillerPump];
        sources[nodes.motor.index()] += flows[Flow::MotorLoss];
        sources[nodes.transmission.index()] += flows[Flow::TransmissionLoss];
        sources[nodes.battery.index()] += flows[Flow::BatteryLoss];
        sources[nodes.cabin.index()] += flows[Flow::Blower] + flows[Flow::Solar] + flows[Flow::Occupants];
        sources
    }
}

/// Draws all electrical power from the battery; what it cannot deliver goes unserved.
fn draw(circuit: &CircuitStep<'_>, limits: &PowerLimits, flows: &mut Flows) -> BatteryStep {
    let wanted_w = flows[Flow::Traction] + flows.base_load_w() + flows[Flow::Compressor] + flows[Flow::Ptc];
    let battery = circuit.draw(wanted_w.min(limits.discharge_w));
    // Formed from what the circuit really delivered, so that round-off of its solution is not lost.
    flows[Flow::Unserved] =
        if wanted_w > limits.discharge_w { wanted_w - battery.terminal_power_w } else { 0.0 };
    flows[Flow::Battery] = battery.terminal_power_w;
    flows[Flow::Chemical] = battery.chemical_power_w;
    flows[Flow::BatteryLoss] = battery.loss_w;
    battery
}
