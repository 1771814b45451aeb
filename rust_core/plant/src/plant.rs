//! The vehicle: one entry, [`Plant::step_into`] ([`Plant::step`] returns what it writes), pure and deterministic.

use crate::air_side;
use crate::architecture::declaration::{Level, MemberKind};
use crate::architecture::indices::Indices;
use crate::architecture::layout::{
    BranchSide, CABIN_PLACES, CabinLayout, FRONT_END_PLACES, HeaterTarget, LOOP_PLACES, Layout, WEIGHT_PLACES,
};
use crate::circuits::branches::{self, BranchTable, BranchTemperatures};
use crate::circuits::exchangers::{self, ExchangerTable, Sides, Surroundings};
use crate::circuits::refrigeration_cycle::RefrigerationCycle;
use crate::circuits::refrigeration_loop::{
    CompressorAllowance, Limit, LoopBoundary, LoopResult, RefrigerationState,
};
use crate::command::{ActuatorRanges, Command, Demand};
use crate::components::battery::{Battery, BatteryState, BatteryStep, CircuitStep, PowerLimits};
use crate::components::body::RoadLoad;
use crate::components::cabin_air::{CabinAir, WaterFlows};
use crate::components::exhaust_recovery::{ExhaustRecovery, RecoveryTemperatures};
use crate::components::frost::{Frost, Met};
use crate::components::pid::ResetPid;
use crate::components::powertrain::{Powertrain, PowertrainFlow};
use crate::components::pump::PumpState;
use crate::components::reachable_speed::{TractionSupply, reachable_speed_m_s};
use crate::components::thermal_switch::ThermalSwitches;
use crate::config::Violation;
use crate::config::initial::{InitialParameters, WINDSCREEN};
use crate::config::library::Override;
use crate::config::vehicle::VehicleParameters;
use crate::controls::{self, Controls, Period, Sight};
use crate::error::PlantResult;
use crate::flows::{Flow, Flows};
use crate::ledger::{Ledger, LedgerEntry, StoredEnergyChange, WaterEntry};
use crate::media::moist_air::saturation_ratio;
use crate::media::refrigerant::RefrigerantTable;
use crate::network::built_in::with_shape;
use crate::network::conditions::{CabinConditions, Conditions, Constants};
use crate::network::planned::Planned;
use crate::network::shape::{Given, Shape, each};
use crate::network::{Forecast, INLET_PLACES, Network};
use crate::numerics::planned_network::TooLarge;
use crate::numerics::thermal_network::{MAXIMUM_NODES, NodeValues, heat_gained_j};
use crate::signals::SignalTable;
use crate::state::State;
use crate::step_parameters::StepParameters;
pub use crate::surroundings::{CONTROL_PERIOD_S, Disturbance};
use serde::{Deserialize, Serialize};

/// Power that the battery leaves where it limits traction, at most: the speed is found to round-off only [W].
const ROUNDING_W: f64 = 1.0;

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
    /// Mean flows of water of each cabin.
    pub water: [WaterFlows; CABIN_PLACES],
    /// Air that the blower of the cabin that counts for comfort moves [kg/s].
    pub supply_air_kg_s: f64,
    /// Worst entry of the ledger of water, of cabins and sub-steps.
    pub water_ledger: WaterEntry,
    /// Thermal loads were cut because the battery could not feed them.
    pub loads_shed: bool,
    /// Vehicle speed at the end [m/s]: what was asked for, or less where motor or battery could not deliver it.
    pub end_speed_m_s: f64,
}

/// A vehicle ready to run: parameters, tables and assembled network. It never changes; all that does is in
/// [`State`].
#[derive(Debug, Clone)]
pub struct Plant {
    /// Parameters.
    pub vehicle: VehicleParameters,
    /// Actuators with their physical ranges.
    pub ranges: ActuatorRanges,
    /// What can be seen.
    pub signals: SignalTable,
    /// Battery with its tables.
    pub battery: Battery,
    /// Thermal network.
    pub network: Network,
    /// Refrigerant loop.
    pub refrigeration: Option<RefrigerationCycle>,
    /// Exchangers of the refrigerant loop.
    pub exchangers: ExchangerTable,
    /// Coolant branches.
    pub branches: BranchTable,
    controls: Controls,
    parameters: StepParameters,
    ledger: Ledger,
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

/// A piece of a step: the speeds that it runs through.
#[derive(Debug, Clone, Copy)]
struct Segment {
    step_s: f64,
    start_m_s: f64,
    end_m_s: f64,
    speed_m_s: f64,
    /// Of the air along the vehicle.
    air_speed_m_s: f64,
}

/// Traction of a segment.
struct Drive<'a> {
    powertrain: Powertrain<'a>,
    wheel_w: f64,
    /// Power flow while driving; while braking it follows later, from what the battery can take.
    driving: Option<PowertrainFlow>,
}

impl Drive<'_> {
    /// Electrical power of driving; none while braking [W].
    fn electrical_w(&self) -> f64 {
        self.driving.map_or(0.0, |flow| flow.electrical_power_w)
    }

    /// Whether driving asks for more than the motor has.
    fn beyond_motor(&self) -> bool {
        self.driving.is_some_and(|flow| !self.powertrain.within_motor_limits(self.wheel_w, &flow))
    }
}

impl Plant {
    /// Prepares a vehicle.
    ///
    /// # Errors
    /// The refrigerant is unknown or its table unusable with these parameters, or the thermal network is too large.
    pub fn new(vehicle: VehicleParameters) -> PlantResult<Self> {
        let layout = std::sync::Arc::clone(&vehicle.layout);
        let refrigeration = match (&vehicle.refrigeration, &vehicle.refrigerant) {
            (Some(parameters), Some(refrigerant)) => {
                let table = RefrigerantTable::load(refrigerant)?;
                let cycle = RefrigerationCycle::new(parameters.clone(), table)
                    .map_err(|violation| violation.within("refrigeration").in_file("vehicle"))?;
                Some(cycle)
            }
            _ => None,
        };
        Ok(Self {
            ranges: ActuatorRanges::of(&vehicle),
            signals: SignalTable::of(&layout),
            battery: Battery::new(&vehicle.battery),
            network: network(&vehicle).map_err(|TooLarge { what, found }| {
                let allowed = "must be fewer: the architecture has more parts and connections than there are places for";
                Violation::new(what, found, allowed).in_file(&vehicle.architecture)
            })?,
            refrigeration,
            exchangers: ExchangerTable::of(&vehicle),
            branches: BranchTable::of(&vehicle),
            controls: Controls::of(&vehicle),
            parameters: StepParameters::of(&vehicle),
            ledger: Ledger::of(&layout),
            vehicle,
            substeps: 1,
        })
    }

    /// Loads a vehicle by name or path with overrides.
    ///
    /// # Errors
    /// See [`VehicleParameters::load`].
    pub fn load(vehicle: &str, overrides: &[Override]) -> PlantResult<Self> {
        Self::new(VehicleParameters::load(vehicle, overrides)?).map_err(|error| error.named_by(vehicle))
    }

    /// What follows from the vehicle's architecture.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.vehicle.layout
    }

    /// The same vehicle with each second integrated in several sub-steps; controllers stay at 1 s.
    #[must_use]
    pub fn with_substeps(mut self, substeps: u32) -> Self {
        self.substeps = substeps.max(1);
        self
    }

    /// Steps in each second.
    #[must_use]
    pub fn substeps_a_second(&self) -> u32 {
        self.substeps
    }

    /// The same vehicle with the network stepped by the executor for any architecture, even where it was compiled.
    #[doc(hidden)]
    #[must_use]
    pub fn with_planned_network(mut self) -> Self {
        self.network = self.network.planned();
        self
    }

    /// A parked vehicle.
    #[must_use]
    pub fn parked(&self, initial: &InitialParameters) -> State {
        let layout = self.layout();
        let soak_k = initial.soak_temperature_degc.kelvin();
        let mut cabin_air = [CabinAir::parked(soak_k); CABIN_PLACES];
        if let Some(windscreen) = initial.of(WINDSCREEN) {
            cabin_air[0] = CabinAir::parked(windscreen.kelvin());
        }
        let mut pumps = [PumpState::default(); LOOP_PLACES];
        for (pump, parameters) in pumps.iter_mut().zip(&self.vehicle.loops) {
            *pump = parameters.circuit.pump.idle();
        }
        let resting_pa =
            self.refrigeration.as_ref().map(|cycle| cycle.table().saturation_pressure_pa(soak_k));
        State {
            time_s: 0.0,
            temperatures_k: parked_k(layout, initial),
            cabin_air,
            battery: self.battery.rested(initial.state_of_charge_pct / 100.0),
            connected: [false; _],
            switches: ThermalSwitches::default(),
            pumps,
            heater_pids: [ResetPid::default(); _],
            pressure_pid: ResetPid::default(),
            refrigeration: RefrigerationState::parked(),
            condensing_pressure_pa: resting_pa.unwrap_or(0.0),
            entered_w: [0.0; LOOP_PLACES],
            front_end_rise_k: [0.0; FRONT_END_PLACES],
            short_of_power: false,
            frosts: [Frost::default(); FRONT_END_PLACES],
            heater_power_w: 0.0,
            compressor_power_w: 0.0,
        }
    }

    /// A parked vehicle in air of a humidity ratio [kg/kg]: the air of its cabins has it too, as far as it is warm enough.
    #[must_use]
    pub fn parked_in(&self, initial: &InitialParameters, ambient_humidity_ratio: f64) -> State {
        let mut state = self.parked(initial);
        for (air, cabin) in state.cabin_air.iter_mut().zip(&self.layout().cabins) {
            let cabin_k = state.temperatures_k[cabin.air.index()];
            air.humidity_ratio = ambient_humidity_ratio.min(saturation_ratio(cabin_k));
        }
        state
    }

    /// Temperatures that decide about connections, for the recirculated share of each cabin's air.
    #[must_use]
    pub fn branch_temperatures(
        &self,
        state: &State,
        recirculation: &[f64; CABIN_PLACES],
        disturbance: &Disturbance,
    ) -> BranchTemperatures {
        let shape = self.network.indices.view();
        let sight =
            Sight { vehicle: &self.vehicle, parameters: &self.parameters, shape: &shape, disturbance };
        let mut period = Period::of(Demand([0.0; _]));
        controls::enter_front_end_air::<Planned>(sight, state, &mut period);
        for (place, cabin) in shape.cabins.iter().enumerate() {
            let (share, cabin_k) = (recirculation[place], state.temperatures_k[cabin.air.index()]);
            period.core_inlet_k[place] = (1.0 - share) * disturbance.air.temperature_k + share * cabin_k;
        }
        controls::temperatures::<Planned>(sight, state, &period)
    }

    /// Temperature difference that drives a branch in its right direction [K].
    #[must_use]
    pub fn branch_difference_k(&self, temperatures: &BranchTemperatures, branch: usize) -> f64 {
        let shape = self.network.indices.view();
        branches::difference_of(&shape, &shape.branches[branch], temperatures)
    }

    /// Temperature difference that drives the branch of a mass in its right direction [K].
    #[must_use]
    pub fn mass_difference_k(&self, state: &State, branch: usize) -> f64 {
        let shape = self.network.indices.view();
        let circuit = usize::from(shape.branches[branch].circuit);
        let mut behind_exchanger_k = [0.0; LOOP_PLACES];
        let parameters = &self.vehicle.loops[circuit].circuit;
        let rate_w_k = state.pumps[circuit].flow_kg_s * parameters.coolant_specific_heat_j_kg_k;
        behind_exchanger_k[circuit] =
            state.temperatures_k[shape.loops[circuit].back.index()] + state.entered_w[circuit] / rate_w_k;
        let temperatures = BranchTemperatures {
            nodes_k: state.temperatures_k,
            front_end_air_k: [0.0; FRONT_END_PLACES],
            core_inlet_k: [0.0; CABIN_PLACES],
            behind_exchanger_k,
        };
        branches::difference_of(&shape, &shape.branches[branch], &temperatures)
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
        with_shape!(self.network.shaped, S => self.run::<S>(state, command, disturbance, record, &mut tamper));
    }

    /// One control period of a vehicle of a shape.
    #[inline(never)]
    fn run<S: Shape>(
        &self,
        state: &mut State,
        command: &Command,
        disturbance: &Disturbance,
        record: &mut StepRecord,
        tamper: &mut impl FnMut(Stage, &mut Flows),
    ) {
        let own = self.network.indices.view();
        let shape = S::indices(&own);
        let compressor_row = shape.compressor_row.map(usize::from);
        let mut period = Period::of(self.ranges.decoded(command, shape.actuators, compressor_row));
        let sight = Sight { vehicle: &self.vehicle, parameters: &self.parameters, shape, disturbance };
        if state.short_of_power {
            self.spare_pumps_and_blowers(&mut period.demand);
        }
        self.controls.begin_period::<S>(sight, &self.branches, state, &mut period);
        if self.substeps == 1 {
            self.substep::<S>(sight, state, &period, 0, &mut 0.0, record, tamper);
        } else {
            self.substeps::<S>(sight, state, &period, record, tamper);
        }
        self.end_period::<S>(sight, state, &period, &record.flows);
    }

    /// Lowest coolant and air flows while the battery cannot give what driving asks for.
    #[cold]
    fn spare_pumps_and_blowers(&self, demand: &mut Demand) {
        let layout = self.layout();
        let pumps = layout.loops.iter().map(|circuit| circuit.flow_row);
        for row in pumps.chain(layout.cabins.iter().map(|cabin| cabin.blower_row)) {
            demand[row] = self.ranges.range(row).0;
        }
    }

    /// All sub-steps of a second; the record becomes their mean.
    #[inline(never)]
    fn substeps<S: Shape>(
        &self,
        sight: Sight<'_>,
        state: &mut State,
        period: &Period,
        record: &mut StepRecord,
        tamper: &mut impl FnMut(Stage, &mut Flows),
    ) {
        let share = 1.0 / f64::from(self.substeps);
        let mut mean = Flows::default();
        let (mut voltage_v, mut current_a) = (0.0, 0.0);
        let mut worst = (LedgerEntry::default(), false);
        let mut slower_m_s = 0.0;
        let mut water = ([WaterFlows::default(); CABIN_PLACES], WaterEntry::default());
        for part in 0..self.substeps {
            self.substep::<S>(sight, state, period, part, &mut slower_m_s, record, tamper);
            mean.accumulate(&record.flows, share);
            voltage_v += record.battery_voltage_v * share;
            current_a += record.battery_current_a * share;
            for (mean, flows) in water.0.iter_mut().zip(&record.water) {
                mean.accumulate(flows, share);
            }
            if part == 0 || record.water_ledger.relative() > water.1.relative() {
                water.1 = record.water_ledger;
            }
            if part == 0 || record.ledger.relative() > worst.0.relative() {
                worst.0 = record.ledger;
            }
            worst.1 |= record.loads_shed;
        }
        record.flows = mean;
        (record.battery_voltage_v, record.battery_current_a) = (voltage_v, current_a);
        (record.ledger, record.loads_shed) = worst;
        (record.water, record.water_ledger) = water;
    }

    /// What the next second must know of this one.
    #[inline(always)]
    fn end_period<S: Shape>(&self, sight: Sight<'_>, state: &mut State, period: &Period, flows: &Flows) {
        let Sight { shape, parameters, disturbance, .. } = sight;
        state.time_s += CONTROL_PERIOD_S;
        state.heater_power_w = 0.0;
        each!(S::heaters(shape) => |place, heater| {
            let power_w = flows[heater.flow];
            state.heater_power_w += power_w;
            state.heater_pids[place].applied(&self.parameters.heater_gains[place], power_w);
        });
        state.compressor_power_w = flows[Flow::COMPRESSOR];
        state.pressure_pid.applied(&self.controls.pressure, state.compressor_power_w);
        let mut front_end_w = [0.0; FRONT_END_PLACES];
        each!(S::branches(shape) => |_, branch| {
            if let BranchSide::Ambient(end) = branch.side {
                let heat_w = flows[branch.flow];
                front_end_w[end] += if branch.out_of_loop { heat_w } else { -heat_w };
            }
        });
        exchangers::remember::<S>(shape, flows, &mut state.entered_w, &mut front_end_w);
        each!(S::front_ends(shape) => |place, indices| {
            if indices.shares_air {
                state.front_end_rise_k[place] = front_end_w[place] / period.front.airs[place].rate_w_k;
            }
            if parameters.front_ends[place].frost.grows() {
                let frost = &mut state.frosts[place];
                let met = Met {
                    air_k: period.front_end_air_k[place] - frost.rise_k,
                    humidity_ratio: disturbance.ambient_humidity_ratio,
                    taken_w: -front_end_w[place],
                };
                let (own, air) = (&parameters.front_ends[place].frost, &period.front.airs[place]);
                frost.advance(own, air, &met, CONTROL_PERIOD_S);
            }
        });
    }

    /// One integration step: traction demand, constant loads, refrigerant loop, heaters, regeneration and battery, thermal
    /// network, ledger. `slower_m_s` is by how much the vehicle is slower than asked for where the step begins, then where
    /// it ends.
    #[allow(clippy::too_many_arguments, reason = "what the phases of a step hand on, nothing of it kept")]
    #[inline(always)]
    fn substep<S: Shape>(
        &self,
        sight: Sight<'_>,
        state: &mut State,
        period: &Period,
        part: u32,
        slower_m_s: &mut f64,
        record: &mut StepRecord,
        tamper: &mut impl FnMut(Stage, &mut Flows),
    ) {
        let shape = sight.shape;
        let mut segment = self.segment(sight.disturbance, part, *slower_m_s);
        record.flows.clear(shape.flows);
        let flows = &mut record.flows;
        let mut drive = self.road(sight, state, &segment, flows);
        self.constant_loads::<S>(sight, period, flows);
        let moment = air_side::Moment { step_s: segment.step_s, air_speed_m_s: segment.air_speed_m_s };
        let blown_w_k = air_side::step::<S>(sight, state, period, moment, record);
        let flows = &mut record.flows;

        // Driving comes before thermal loads: they have what it leaves.
        let battery_k = state.temperatures_k[shape.battery.index()];
        let circuit = self.battery.during(&state.battery, battery_k, segment.step_s);
        let limits = circuit.power_limits();
        let base_w = base_load_w::<S>(shape, flows);
        let left_w =
            self.drive(sight, state, (&limits, base_w), &mut segment, &mut drive, slower_m_s, record);
        let flows = &mut record.flows;
        let spare_w = left_w.max(0.0);

        let conditions = self.conditions::<S>(sight, state, period, &blown_w_k, segment.air_speed_m_s);
        let start_k = state.temperatures_k;
        let given = Given {
            capacities_j_k: &self.network.capacities_j_k,
            constants: &self.network.constants,
            now: &conditions,
            start_k: &start_k,
        };
        let planned = self.network.planned.as_ref();
        let (forecasts, factors) = S::begin(planned, &given, segment.step_s, flows);
        let available = Available { spare_w, may_start: part == 0 };
        self.refrigerate::<S>(sight, state, period, &segment, &forecasts, &available, record);
        record.loads_shed |=
            self.heat::<S>(shape, &start_k, period, &segment, &forecasts, spare_w, &mut record.flows);

        let flows = &mut record.flows;
        self.traction::<S>(shape, &drive, &limits, flows);
        tamper(Stage::Loads, flows);
        let battery = draw::<S>(shape, &circuit, &limits, flows);

        tamper(Stage::Heat, flows);
        let end_k = S::finish(planned, &factors, &given, flows);

        tamper(Stage::Ledger, flows);
        let stored = self.stored_change(sight, state, &segment, &circuit, &battery.state, &end_k);
        record.ledger = self.ledger.balance(shape.flows, flows, &stored, segment.step_s);
        (state.temperatures_k, state.battery) = (end_k, battery.state);
        (record.battery_voltage_v, record.battery_current_a) = (battery.voltage_v, battery.current_a);
        record.power_limits = limits;
    }

    /// Driving as asked for, or as fast as motor and battery allow with the loads that are fed first [W]; returns what it leaves
    /// of the battery's power, which is negative where even those lack some [W].
    #[allow(clippy::too_many_arguments, reason = "what the phases of a step hand on, nothing of it kept")]
    #[inline(always)]
    fn drive<'a>(
        &'a self,
        sight: Sight<'_>,
        state: &mut State,
        (limits, base_w): (&PowerLimits, f64),
        segment: &mut Segment,
        drive: &mut Drive<'a>,
        slower_m_s: &mut f64,
        record: &mut StepRecord,
    ) -> f64 {
        let mut left_w = limits.discharge_w - drive.electrical_w() - base_w;
        state.short_of_power = left_w < 0.0;
        record.end_speed_m_s = sight.disturbance.end_speed_m_s;
        *slower_m_s = 0.0;
        if drive.driving.is_some() && (left_w < 0.0 || drive.beyond_motor()) {
            let supply = TractionSupply {
                most_w: (limits.discharge_w - base_w).max(0.0),
                recovery_w: limits.charge_w + base_w,
            };
            let wanted_m_s = segment.end_m_s;
            *segment = self.reachable(sight, state, segment, supply);
            *drive = self.road(sight, state, segment, &mut record.flows);
            left_w = limits.discharge_w - drive.electrical_w() - base_w;
            // Where the motor is what limits, the battery has something left.
            state.short_of_power = left_w < ROUNDING_W;
            *slower_m_s = wanted_m_s - segment.end_m_s;
            record.end_speed_m_s = segment.end_m_s;
        }
        left_w
    }

    /// A piece of a second, asked to end at the speed that it would have if all before had ended at theirs.
    #[inline(always)]
    fn segment(&self, disturbance: &Disturbance, part: u32, slower_m_s: f64) -> Segment {
        let step_s = CONTROL_PERIOD_S / f64::from(self.substeps);
        let acceleration = (disturbance.end_speed_m_s - disturbance.start_speed_m_s) / CONTROL_PERIOD_S;
        let start_m_s = disturbance.start_speed_m_s + acceleration * step_s * f64::from(part);
        let end_m_s = start_m_s + acceleration * step_s;
        let start_m_s = (start_m_s - slower_m_s).max(0.0);
        let speed_m_s = 0.5 * (start_m_s + end_m_s);
        let air_speed_m_s = disturbance.air_speed_m_s(speed_m_s);
        Segment { step_s, start_m_s, end_m_s, speed_m_s, air_speed_m_s }
    }

    /// The same piece, ended as fast as motor and battery allow: the vehicle falls behind.
    #[cold]
    #[inline(never)]
    fn reachable(
        &self,
        sight: Sight<'_>,
        state: &State,
        segment: &Segment,
        supply: TractionSupply,
    ) -> Segment {
        let ending = |end_m_s: f64| {
            let speed_m_s = 0.5 * (segment.start_m_s + end_m_s);
            let air_speed_m_s = sight.disturbance.air_speed_m_s(speed_m_s);
            Segment { end_m_s, speed_m_s, air_speed_m_s, ..*segment }
        };
        ending(reachable_speed_m_s(segment.end_m_s, supply, |end_m_s| {
            let (road, powertrain) = self.pull(sight, state, &ending(end_m_s));
            (road.wheel_power_w(), powertrain)
        }))
    }

    /// What a piece of the road asks of the powertrain.
    #[inline(always)]
    fn pull(&self, sight: Sight<'_>, state: &State, segment: &Segment) -> (RoadLoad, Powertrain<'_>) {
        let vehicle = &self.vehicle;
        let Segment { step_s, start_m_s, end_m_s, speed_m_s, .. } = *segment;
        let road = vehicle.body.road_load(start_m_s, end_m_s, step_s, &sight.disturbance.road());
        let oil_k = state.temperatures_k[sight.shape.transmission.index()];
        let motor_k = state.temperatures_k[sight.shape.motor.index()];
        let powertrain = Powertrain {
            motor: &vehicle.motor,
            transmission: &vehicle.transmission,
            regeneration: &vehicle.regeneration,
            speed_m_s,
            spin_loss_w: vehicle.transmission.spin_loss_w(oil_k, speed_m_s),
            motor_share: vehicle.motor.available_share(motor_k),
        };
        (road, powertrain)
    }

    /// Traction demand.
    #[inline(always)]
    fn road(&self, sight: Sight<'_>, state: &State, segment: &Segment, flows: &mut Flows) -> Drive<'_> {
        let (road, powertrain) = self.pull(sight, state, segment);
        let wheel_w = road.wheel_power_w();
        let driving = (wheel_w >= 0.0).then(|| powertrain.drive(wheel_w));
        flows[Flow::DRAG] = road.drag_power_w;
        flows[Flow::ROLLING] = road.rolling_power_w;
        flows[Flow::KINETIC] = road.kinetic_power_w;
        flows[Flow::CLIMB] = road.climb_power_w;
        flows[Flow::WHEEL] = wheel_w;
        if let Some(driving) = driving {
            flows[Flow::MOTOR_LOSS] = driving.motor_loss_w;
            flows[Flow::TRANSMISSION_LOSS] = driving.transmission_loss_w;
        }
        Drive { powertrain, wheel_w, driving }
    }

    /// Loads and gains that nothing in the step changes.
    #[inline(always)]
    fn constant_loads<S: Shape>(&self, sight: Sight<'_>, period: &Period, flows: &mut Flows) {
        let Sight { vehicle, parameters, shape, disturbance } = sight;
        flows[Flow::AUXILIARY] = vehicle.controls.auxiliary_power_w;
        each!(S::loops(shape) => |place, circuit| { flows[circuit.pump_flow] = period.pumps_w[place]; });
        flows[Flow::FAN] = period.front.fan_w;
        each!(S::cabins(shape) => |place, cabin| {
            flows[cabin.blower_flow] = period.ventilation[place].blower_power_w;
            let sun_w = disturbance.solar_gain_w * parameters.solar_shares[place];
            let onto_furnishings = parameters.cabins[place].solar_to_furnishings_share;
            flows[cabin.solar_flow] = sun_w * (1.0 - onto_furnishings);
            flows[cabin.solar_soft_flow] = 0.5 * sun_w * onto_furnishings;
            flows[cabin.solar_hard_flow] = 0.5 * sun_w * onto_furnishings;
            let occupants = disturbance.occupants * parameters.occupant_shares[place];
            flows[cabin.occupants_flow] = occupants * parameters.cabins[place].occupant_heat_w;
        });
    }

    /// What the links of the thermal network depend on.
    #[inline(always)]
    fn conditions<'a, S: Shape>(
        &self,
        sight: Sight<'_>,
        state: &State,
        period: &'a Period,
        blown_w_k: &[f64; CABIN_PLACES],
        air_speed_m_s: f64,
    ) -> Conditions<'a> {
        let Sight { vehicle, parameters, shape, disturbance } = sight;
        let mut masses_w_k = parameters.masses_w_k;
        masses_w_k[0] = vehicle.battery.plate.conductance_to_ambient_w_k(air_speed_m_s, &disturbance.air);
        masses_w_k[1] = vehicle.motor.ambient_conductance_w_k(air_speed_m_s);
        masses_w_k[2] = vehicle.transmission.ambient_conductance_w_k(air_speed_m_s);
        let mut cabins = [CabinConditions::default(); CABIN_PLACES];
        each!(S::cabins(shape) => |place, cabin| {
            cabins[place] = cabin_conditions(sight, (place, cabin), state, period, air_speed_m_s);
            cabins[place].panel_w_k += blown_w_k[place];
        });
        let mut conditions = Conditions {
            rates_w_k: &period.rates_w_k,
            branches_w_k: &period.branches_w_k,
            masses_w_k,
            cabins,
            weights: [0.0; WEIGHT_PLACES],
            front_end_air_k: &period.front_end_air_k,
            ambient_k: disturbance.air.temperature_k,
        };
        if shape.weights > 0 {
            enter_series_weights(&vehicle.layout, &mut conditions);
        }
        conditions
    }

    /// Refrigerant loop, its caps at the end of the step included.
    #[allow(clippy::too_many_arguments, reason = "what the phases of a step hand on, nothing of it kept")]
    #[inline(always)]
    fn refrigerate<S: Shape>(
        &self,
        sight: Sight<'_>,
        state: &mut State,
        period: &Period,
        segment: &Segment,
        forecasts: &[Forecast; INLET_PLACES],
        available: &Available,
        record: &mut StepRecord,
    ) {
        record.loads_shed = false;
        let (Some(row), Some(cycle)) = (sight.shape.compressor_row, &self.refrigeration) else { return };
        let shape = sight.shape;
        let demand_w = period.compressor_demand_w.min(available.spare_w);
        let allowed =
            CompressorAllowance { demand_w, available_w: available.spare_w, may_start: available.may_start };
        let mut sides = self.exchangers.sides::<S>(
            shape,
            &Surroundings {
                nodes_k: &state.temperatures_k,
                rates_w_k: &period.rates_w_k,
                ventilation: &period.ventilation,
                core_inlet_k: &period.core_inlet_k,
                branches_w_k: &period.branches_w_k,
                front_end_air_k: &period.front_end_air_k,
                ambient_k: sight.disturbance.air.temperature_k,
                front: &period.front,
                forecasts,
                demand: &period.demand,
                may_run: demand_w > 0.0 || state.refrigeration.compressor.running,
            },
        );
        record.boundary = exchangers::boundary(shape, &sides);
        if shape.is_pair() {
            let result = cycle.step(&mut state.refrigeration, &record.boundary, &allowed, segment.step_s);
            record.refrigeration = result;
        } else {
            self.step_exchangers(cycle, shape, state, &allowed, segment.step_s, &mut sides, record);
        }
        let result = &record.refrigeration;
        record.flows[Flow::COMPRESSOR] = result.electric_power_w;
        record.flows[Flow::COMPRESSOR_LOSS] = result.loss_to_ambient_w;
        exchangers::record(shape, result, &sides, &mut record.flows);
        record.demanded_w = period.demand.0[usize::from(row)];
        record.compressor_demand_w = period.compressor_demand_w;
        record.loads_shed = demand_w < period.compressor_demand_w && result.limited_by == Limit::Power;
        state.condensing_pressure_pa = result.condensing_pressure_pa;
    }

    /// The refrigerant loop with exchangers that close where they would run backwards.
    #[allow(clippy::too_many_arguments, reason = "what the phases of a step hand on, nothing of it kept")]
    fn step_exchangers(
        &self,
        cycle: &RefrigerationCycle,
        shape: &Indices<'_>,
        state: &mut State,
        allowed: &CompressorAllowance,
        step_s: f64,
        sides: &mut Sides,
        record: &mut StepRecord,
    ) {
        let before = state.refrigeration;
        loop {
            record.refrigeration = cycle.step(&mut state.refrigeration, &record.boundary, allowed, step_s);
            if !exchangers::close_backward(shape, &record.refrigeration, sides) {
                return;
            }
            state.refrigeration = before;
            record.boundary = exchangers::boundary(shape, sides);
        }
    }

    /// Heaters, off above their cut-off temperature: just enough to end the step there, continuous in all it depends on.
    /// Whether the battery could not feed one.
    #[allow(unused_assignments, reason = "what the last heater leaves is not asked for")]
    #[allow(clippy::too_many_arguments, reason = "what the phases of a step hand on, nothing of it kept")]
    #[inline(always)]
    fn heat<S: Shape>(
        &self,
        shape: &Indices<'_>,
        start_k: &NodeValues,
        period: &Period,
        segment: &Segment,
        forecasts: &[Forecast; INLET_PLACES],
        spare_w: f64,
        flows: &mut Flows,
    ) -> bool {
        let mut spare_w = (spare_w - flows[Flow::COMPRESSOR]).max(0.0);
        let mut shed = false;
        each!(S::heaters(shape) => |place, heater| {
            let (mut reached_k, sensitivity_k_w) = match heater.target {
                HeaterTarget::Loop(circuit) => {
                    let indices = &shape.loops[circuit];
                    let forecast = indices.inlet.map(|inlet| forecasts[usize::from(inlet)]).unwrap_or_default();
                    let entering_w = indices.exchanger.map_or(0.0, |exchanger| {
                        let exchanger = &shape.exchangers[usize::from(exchanger)];
                        let heat_w = flows[exchanger.flow];
                        if exchanger.level == Level::Condensing { heat_w } else { -heat_w }
                    });
                    let reached_k = forecast.base_k + forecast.sensitivity_k_w * entering_w;
                    (reached_k, forecast.sensitivity_k_w)
                }
                HeaterTarget::Mass(node) => {
                    (start_k[node.index()], segment.step_s / self.network.capacities_j_k[node.index()])
                }
            };
            for before in shape.heaters.iter().take(place).filter(|before| before.target == heater.target) {
                reached_k += sensitivity_k_w * flows[before.flow];
            }
            let to_cutoff_w = self.parameters.heaters[place].power_to_cutoff_w(reached_k, sensitivity_k_w);
            let wanted_w = period.heaters_w[place].min(to_cutoff_w);
            let power_w = wanted_w.min(spare_w);
            flows[heater.flow] = power_w;
            shed |= power_w < wanted_w;
            spare_w -= power_w;
        });
        shed
    }

    /// Traction, while braking against the charge limit with this step's loads.
    #[inline(always)]
    fn traction<S: Shape>(
        &self,
        shape: &Indices<'_>,
        drive: &Drive<'_>,
        limits: &PowerLimits,
        flows: &mut Flows,
    ) {
        let base_w = base_load_w::<S>(shape, flows) + flows[Flow::COMPRESSOR];
        let mut loads_w = base_w;
        each!(S::heaters(shape) => |_, heater| { loads_w += flows[heater.flow]; });
        let Drive { powertrain, wheel_w, driving } = drive;
        let traction = driving.unwrap_or_else(|| powertrain.brake(-wheel_w, limits.charge_w + loads_w));
        flows[Flow::TRACTION] = traction.electrical_power_w;
        flows[Flow::MOTOR_LOSS] = traction.motor_loss_w;
        flows[Flow::TRANSMISSION_LOSS] = traction.transmission_loss_w;
        flows[Flow::FRICTION_BRAKE] = traction.friction_brake_power_w;
    }

    #[inline(always)]
    fn stored_change(
        &self,
        sight: Sight<'_>,
        state: &State,
        segment: &Segment,
        circuit: &CircuitStep<'_>,
        battery: &BatteryState,
        end_k: &NodeValues,
    ) -> StoredEnergyChange {
        let body = &self.vehicle.body;
        let capacities_j_k = &self.network.capacities_j_k;
        StoredEnergyChange {
            kinetic_j: body.kinetic_energy_j(segment.end_m_s) - body.kinetic_energy_j(segment.start_m_s),
            potential_j: body
                .potential_energy_j(&sight.disturbance.road(), segment.speed_m_s * segment.step_s),
            chemical_j: circuit.chemical_energy_gained_j(battery),
            polarisation_j: self.battery.polarisation_energy_j(battery)
                - self.battery.polarisation_energy_j(&state.battery),
            heat_j: heat_gained_j(sight.shape.nodes, capacities_j_k, &state.temperatures_k, end_k),
        }
    }
}

/// Electrical power besides traction, compressor and heaters [W].
#[inline(always)]
fn base_load_w<S: Shape>(shape: &Indices<'_>, flows: &Flows) -> f64 {
    let mut sum_w = 0.0;
    each!(S::base_loads(shape) => |_, flow| { sum_w += flows[*flow]; });
    sum_w
}

/// Draws all electrical power from the battery; what it cannot deliver goes unserved.
#[inline(always)]
fn draw<S: Shape>(
    shape: &Indices<'_>,
    circuit: &CircuitStep<'_>,
    limits: &PowerLimits,
    flows: &mut Flows,
) -> BatteryStep {
    let base_w = flows[Flow::TRACTION] + base_load_w::<S>(shape, flows) + flows[Flow::COMPRESSOR];
    let mut wanted_w = base_w;
    each!(S::heaters(shape) => |_, heater| { wanted_w += flows[heater.flow]; });
    let battery = circuit.draw(wanted_w.min(limits.discharge_w));
    // Formed from what the circuit really delivered, so that round-off of its solution is not lost.
    flows[Flow::UNSERVED] =
        if wanted_w > limits.discharge_w { wanted_w - battery.terminal_power_w } else { 0.0 };
    flows[Flow::BATTERY] = battery.terminal_power_w;
    flows[Flow::CHEMICAL] = battery.chemical_power_w;
    flows[Flow::BATTERY_LOSS] = battery.loss_w;
    battery
}

#[inline(always)]
fn cabin_conditions(
    sight: Sight<'_>,
    (place, cabin): (usize, &CabinLayout),
    state: &State,
    period: &Period,
    air_speed_m_s: f64,
) -> CabinConditions {
    let Sight { parameters, shape, disturbance, .. } = sight;
    let parameters = &parameters.cabins[place];
    let ventilation = period.ventilation[place];
    let recovery = match cabin.recovery {
        Some(circuit) => {
            let largest_w_k = parameters.exhaust_recovery_share * ventilation.fresh_rate_w_k;
            let heated = cabin.heater.is_some_and(|branch| period.branches_w_k[branch] > 0.0);
            let temperatures = RecoveryTemperatures {
                cabin_k: state.temperatures_k[cabin.air.index()],
                supply_k: state.temperatures_k[shape.loops[circuit].supply.index()],
                ambient_k: disturbance.air.temperature_k,
            };
            ExhaustRecovery::during(largest_w_k, heated, &temperatures)
        }
        None => ExhaustRecovery::default(),
    };
    CabinConditions { ventilation, recovery, panel_w_k: parameters.panel_conductance_w_k(air_speed_m_s) }
}

/// Temperatures of all nodes of a parked vehicle: soaked, then what is given of wholes, then what is given of their parts.
fn parked_k(layout: &Layout, initial: &InitialParameters) -> NodeValues {
    let mut temperatures_k = [0.0; MAXIMUM_NODES];
    temperatures_k[..layout.nodes.len()].fill(initial.soak_temperature_degc.kelvin());
    for member in &layout.members {
        if let (Some(node), Some(value)) = (member.node, initial.of(&member.name)) {
            temperatures_k[node.index()] = value.kelvin();
        }
    }
    for cabin in &layout.cabins {
        for part in [cabin.exhaust, cabin.soft, cabin.hard] {
            temperatures_k[part.index()] = temperatures_k[cabin.air.index()];
        }
    }
    for circuit in &layout.loops {
        if let Some(value) = initial.of(&circuit.name) {
            temperatures_k[circuit.supply.index()] = value.kelvin();
            temperatures_k[circuit.back.index()] = value.kelvin();
        }
    }
    for (temperature_k, node) in temperatures_k.iter_mut().zip(&layout.nodes) {
        if let Some(value) = initial.of(&node.stem) {
            *temperature_k = value.kelvin();
        }
    }
    temperatures_k
}

/// What the compressor may have.
struct Available {
    spare_w: f64,
    may_start: bool,
}

/// Weights that the return and the branches before have in the coolant that reaches each later branch of a series.
fn enter_series_weights(layout: &Layout, conditions: &mut Conditions<'_>) {
    let mut place = 0;
    for (circuit, declared) in layout.loops.iter().enumerate() {
        for (position, _) in declared.series.iter().enumerate().skip(1) {
            let before = &declared.series[..position];
            let share = |branch: usize| conditions.branches_w_k[branch] / conditions.rates_w_k[circuit];
            let left_after =
                |first: usize| before[first..].iter().fold(1.0, |left, &branch| left * (1.0 - share(branch)));
            let mut weights = [0.0; WEIGHT_PLACES];
            weights[0] = left_after(0);
            for (k, &branch) in before.iter().enumerate() {
                weights[k + 1] = share(branch) * left_after(k + 1);
            }
            for weight in &weights[..=before.len()] {
                conditions.weights[place] = *weight;
                place += 1;
            }
        }
    }
}

/// Heat capacities and constant conductances of a vehicle's network.
fn network(vehicle: &VehicleParameters) -> Result<Network, TooLarge> {
    let layout = &*vehicle.layout;
    let mut capacities_j_k = NodeValues::default();
    let mut constants = Constants::default();
    for (place, (circuit, parameters)) in layout.loops.iter().zip(&vehicle.loops).enumerate() {
        let half_j_k = 0.5 * parameters.circuit.heat_capacity_j_k;
        (capacities_j_k[circuit.supply.index()], capacities_j_k[circuit.back.index()]) = (half_j_k, half_j_k);
        constants.half_hoses_w_k[place] = parameters.circuit.half_hose_conductance_w_k();
    }
    let mut stores = vehicle.stores.iter();
    for mass in &layout.masses {
        capacities_j_k[mass.node.index()] = match layout.members[mass.member].kind {
            MemberKind::Battery => vehicle.battery.heat_capacity_j_k(),
            MemberKind::Motor => vehicle.motor.heat_capacity_j_k,
            MemberKind::Transmission => vehicle.transmission.heat_capacity_j_k,
            _ => stores.next().map_or(0.0, |store| store.heat_capacity_j_k),
        };
    }
    for (place, (cabin, share)) in layout.cabins.iter().zip(&vehicle.cabins).enumerate() {
        let parameters = &share.parameters;
        for (node, capacity_j_k) in [
            (cabin.air, parameters.air_heat_capacity_j_k),
            (cabin.exhaust, parameters.exhaust_heat_capacity_j_k),
            (cabin.soft, parameters.soft_heat_capacity_j_k),
            (cabin.hard, parameters.hard_heat_capacity_j_k),
        ] {
            capacities_j_k[node.index()] = capacity_j_k;
        }
        constants.soft_w_k[place] = parameters.soft_conductance_w_k;
        constants.hard_w_k[place] = parameters.hard_conductance_w_k;
    }
    Network::new(layout, capacities_j_k, constants)
}
