//! Battery pack: first-order equivalent circuit per string (paper section 2.1), limits and capacity.
//!
//! All strings are equal. Over a step the current is constant, the RC pair follows its exact solution and the
//! open-circuit voltage its exact mean, so terminal energy, losses and stored energy balance to round-off.

use super::battery_tables::{CircuitTable, OpenCircuitVoltageTable, UsableCapacityTable};
use super::rate_limit::{Allowance, RateLimit, RateLimitTable};
use super::underbody_plate::PlateParameters;
use crate::architecture::flows::Flow;
use crate::architecture::kind::{Bounds, ComponentKind, Role};
use crate::architecture::ranks;
use crate::config::ZERO_CELSIUS_K;
use crate::numerics::elementary;
use crate::numerics::interpolation::{BilinearTable, LinearTable, Segment};
use crate::parameters;
use serde::{Deserialize, Serialize};

/// What an architecture has to know of the traction battery.
pub const KIND: ComponentKind = ComponentKind {
    word: "battery",
    role: Some(Role::Battery),
    section: Some("battery"),
    loss: Some(Flow::BATTERY_LOSS),
    temperature: Bounds::new(-40.0, 60.0, ranks::BATTERY),
    branch_heat_flow: Some(Bounds::branch(10_000.0, 1)),
    ..ComponentKind::POWERTRAIN
};

/// Rounds of the fixed point for the mean open-circuit voltage; one suffices within a table segment.
const VOLTAGE_ROUNDS: usize = 12;

parameters! {
    /// Battery pack: equivalent circuit per string, lumped thermal mass, exterior plate.
    pub struct BatteryParameters {
        /// Cells in series in a string.
        cells_in_series: u32 = 1 .. 1000,
        /// Strings in parallel.
        strings_in_parallel: u32 = 1 .. 100,
        /// Capacity of one cell at 25 degC [Ah].
        cell_capacity_ah: f64 = 0.5 .. 500.0,
        /// Mass of one cell with its share of the module [kg].
        cell_mass_kg: f64 = 0.01 .. 10.0,
        /// Specific heat of the cell [J/(kg K)].
        cell_specific_heat_j_kg_k: f64 = 300.0 .. 3000.0,
        /// Capacity of the cell that the circuit tables belong to: a cell of the same family with another capacity has
        /// resistances in inverse proportion to it [Ah].
        circuit_reference_capacity_ah: f64 = 0.5 .. 500.0,
        /// Factor on the resistance tables: from their cell family to the vehicle's [-].
        resistance_scale: f64 = 0.1 .. 10.0,
        /// Time constant with which the rate limits forget the current: electrolyte and particles level out [s].
        rate_memory_s: f64 = 1.0 .. 3600.0,
        /// Lowest cell voltage under load [V].
        minimum_cell_voltage_v: f64 = 1.0 .. 3.6,
        /// Highest cell voltage when charged [V].
        maximum_cell_voltage_v: f64 = 3.0 .. 5.0,
        /// Coolant plate conductance [W/K].
        coolant_ua_w_k: f64 = 1.0 .. 10000.0,
        ;
        /// Largest charging rates against temperature and state of charge.
        charge_limit: RateLimitTable,
        /// Largest discharging rates against temperature and state of charge.
        discharge_limit: RateLimitTable,
        /// Exterior plate under the vehicle.
        plate: PlateParameters,
        /// Open-circuit voltage against state of charge.
        open_circuit_voltage: OpenCircuitVoltageTable,
        /// Resistances and capacitance against temperature and state of charge.
        circuit: CircuitTable,
        /// Share of the capacity that can be used against temperature, C_eff of equation (6).
        usable_capacity: UsableCapacityTable,
    }
}

/// Electrical state of a battery.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BatteryState {
    /// Charge drawn from each string since full [C].
    pub charge_drawn_c: f64,
    /// Charge that was drawn when the run began [C].
    pub initial_charge_drawn_c: f64,
    /// Signed root of twice the energy in the RC pair of a string [J^0.5].
    ///
    /// Energy and not voltage is the state, because C1 changes with temperature and charge.
    pub polarisation: f64,
    /// Charging rate of the last minute or so, negative after a discharge: what the rate limits remember [1/h].
    pub recent_charging_per_h: f64,
}

/// Limits on the terminal power during a step.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PowerLimits {
    /// Largest charging power, as a positive number [W].
    pub charge_w: f64,
    /// Largest discharging power [W].
    pub discharge_w: f64,
}

/// What the battery did during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BatteryStep {
    /// State at the end.
    pub state: BatteryState,
    /// Pack current, positive while discharging [A].
    pub current_a: f64,
    /// Mean terminal voltage [V].
    pub voltage_v: f64,
    /// Terminal power [W].
    pub terminal_power_w: f64,
    /// Chemical power: open-circuit voltage times current [W].
    pub chemical_power_w: f64,
    /// Heat of all resistors [W].
    pub loss_w: f64,
}

/// A battery ready to run: parameters with their tables.
#[derive(Debug, Clone)]
pub struct Battery {
    cells_in_series: f64,
    strings: f64,
    cell_capacity_c: f64,
    per_cell_capacity_1_c: f64,
    minimum_string_voltage_v: f64,
    maximum_string_voltage_v: f64,
    charge_limit: RateLimit,
    discharge_limit: RateLimit,
    rate_memory_1_s: f64,
    open_circuit_voltage: LinearTable,
    circuit: BilinearTable<3>,
    usable_capacity: LinearTable,
}

impl BatteryParameters {
    /// Number of cells.
    #[must_use]
    pub fn cells(&self) -> f64 {
        f64::from(self.cells_in_series * self.strings_in_parallel)
    }

    /// Heat capacity of the pack; follows the number of cells [J/K].
    #[must_use]
    pub fn heat_capacity_j_k(&self) -> f64 {
        self.cells() * self.cell_mass_kg * self.cell_specific_heat_j_kg_k
    }
}

impl Battery {
    /// Prepares the tables.
    #[must_use]
    pub fn new(parameters: &BatteryParameters) -> Self {
        // Resistance times capacity is what the cells of a family have in common.
        let scale = parameters.resistance_scale
            * (parameters.circuit_reference_capacity_ah / parameters.cell_capacity_ah);
        let circuit = &parameters.circuit;
        let times = |table: &[Vec<f64>], factor: f64| -> Vec<Vec<f64>> {
            table.iter().map(|row| row.iter().map(|value| value * factor).collect()).collect()
        };
        let series = times(&circuit.series_resistance_ohm, scale);
        let polarisation = times(&circuit.polarisation_resistance_ohm, scale);
        // Between the nodes the time constant is interpolated: R1 and C1 apart would make it far too long.
        // Scaling R1 leaves it, so C1 gives way.
        let products = circuit.polarisation_resistance_ohm.iter().zip(&circuit.polarisation_capacitance_f);
        let time_constants: Vec<Vec<f64>> =
            products.map(|(r, c)| r.iter().zip(c).map(|(r, c)| r * c).collect()).collect();
        let temperatures: Vec<f64> = circuit.temperature_degc.iter().map(|t| t + ZERO_CELSIUS_K).collect();
        let usable = &parameters.usable_capacity;
        let usable_k: Vec<f64> = usable.temperature_degc.iter().map(|t| t + ZERO_CELSIUS_K).collect();
        let cells_in_series = f64::from(parameters.cells_in_series);
        let open_circuit_voltage = LinearTable::new(
            &parameters.open_circuit_voltage.state_of_charge,
            &parameters.open_circuit_voltage.voltage_v,
        );
        Self {
            cells_in_series,
            strings: f64::from(parameters.strings_in_parallel),
            cell_capacity_c: parameters.cell_capacity_ah * 3600.0,
            per_cell_capacity_1_c: (parameters.cell_capacity_ah * 3600.0).recip(),
            minimum_string_voltage_v: parameters.minimum_cell_voltage_v * cells_in_series,
            maximum_string_voltage_v: parameters.maximum_cell_voltage_v * cells_in_series,
            charge_limit: RateLimit::new(&parameters.charge_limit, parameters.rate_memory_s),
            discharge_limit: RateLimit::new(&parameters.discharge_limit, parameters.rate_memory_s),
            rate_memory_1_s: parameters.rate_memory_s.recip(),
            open_circuit_voltage,
            circuit: BilinearTable::new(
                &temperatures,
                &circuit.state_of_charge,
                [&series, &polarisation, &time_constants],
            ),
            usable_capacity: LinearTable::new(&usable_k, &usable.share),
        }
    }

    /// A rested battery at a state of charge [-].
    #[must_use]
    pub fn rested(&self, state_of_charge: f64) -> BatteryState {
        let drawn = (1.0 - state_of_charge) * self.cell_capacity_c;
        BatteryState {
            charge_drawn_c: drawn,
            initial_charge_drawn_c: drawn,
            polarisation: 0.0,
            recent_charging_per_h: 0.0,
        }
    }

    /// State of charge by charge [-]: what the open-circuit voltage depends on.
    #[must_use]
    pub fn state_of_charge(&self, state: &BatteryState) -> f64 {
        1.0 - state.charge_drawn_c * self.per_cell_capacity_1_c
    }

    /// State of charge of equation (6): charge drawn since the start over the usable capacity; 0 where the last step took more
    /// than was left [-].
    #[must_use]
    pub fn usable_state_of_charge(&self, state: &BatteryState, temperature_k: f64) -> f64 {
        let initial = 1.0 - state.initial_charge_drawn_c * self.per_cell_capacity_1_c;
        let drawn = (state.charge_drawn_c - state.initial_charge_drawn_c) * self.per_cell_capacity_1_c;
        not_negative(initial - drawn / self.usable_capacity.at(temperature_k))
    }

    /// State of charge by charge, as it is told: 0 where the last step took more than was left [-].
    #[must_use]
    pub fn charge_left(&self, state: &BatteryState) -> f64 {
        not_negative(self.state_of_charge(state))
    }

    /// Terminal voltage without a current, after a rest [V].
    #[must_use]
    pub fn open_circuit_voltage_v(&self, state: &BatteryState) -> f64 {
        self.open_circuit_voltage.at(self.state_of_charge(state)) * self.cells_in_series
    }

    /// Energy stored in all RC pairs [J].
    #[must_use]
    pub fn polarisation_energy_j(&self, state: &BatteryState) -> f64 {
        0.5 * state.polarisation * state.polarisation * self.strings
    }

    /// The circuit as it is during one step.
    #[must_use]
    #[inline(always)]
    pub fn during(&self, state: &BatteryState, temperature_k: f64, step_s: f64) -> CircuitStep<'_> {
        let soc = self.state_of_charge(state);
        let [r0, r1, time_constant_s] = self.circuit.at(temperature_k, soc);
        let series_ohm = r0 * self.cells_in_series;
        let polarisation_ohm = r1 * self.cells_in_series;
        let root_capacitance = (time_constant_s / (r1 * self.cells_in_series)).sqrt();
        let decay = elementary::exp(-step_s / time_constant_s);
        let segment = self.open_circuit_voltage.segment(soc);
        let open_circuit_v = segment.at(soc) * self.cells_in_series;
        let polarisation_v = state.polarisation / root_capacitance;
        let mean_decay = time_constant_s / step_s * (1.0 - decay);
        let discharge_ohm = 0.5 * segment.slope * step_s * self.per_cell_capacity_1_c * self.cells_in_series;
        CircuitStep {
            battery: self,
            state: *state,
            state_of_charge: soc,
            temperature_k,
            step_s,
            segment,
            open_circuit_v,
            discharge_ohm,
            series_ohm,
            polarisation_ohm,
            root_capacitance,
            polarisation_v,
            decay,
            mean_decay,
            remembered: elementary::exp(-step_s * self.rate_memory_1_s),
            source_v: open_circuit_v - polarisation_v * mean_decay,
            source_ohm: series_ohm + polarisation_ohm * (1.0 - mean_decay) + discharge_ohm,
        }
    }
}

/// Not `max`, which would hide what is no number.
fn not_negative(value: f64) -> f64 {
    if value < 0.0 { 0.0 } else { value }
}

/// One string over one step; solves current for power.
#[derive(Debug, Clone, Copy)]
pub struct CircuitStep<'a> {
    battery: &'a Battery,
    state: BatteryState,
    state_of_charge: f64,
    temperature_k: f64,
    step_s: f64,
    /// Piece of the open-circuit voltage that the step begins on.
    segment: &'a Segment,
    open_circuit_v: f64,
    /// Fall of the mean open-circuit voltage per ampere, as long as the step stays on that piece.
    discharge_ohm: f64,
    series_ohm: f64,
    polarisation_ohm: f64,
    root_capacitance: f64,
    polarisation_v: f64,
    decay: f64,
    mean_decay: f64,
    /// Share of the recent rate that the rate limits still remember at the end.
    remembered: f64,
    /// Voltage and resistance of the equivalent source, `P = I (U - R I)`.
    source_v: f64,
    source_ohm: f64,
}

impl CircuitStep<'_> {
    /// What the terminals can take and give during this step: rate, voltage and peak power limits.
    #[must_use]
    #[inline(always)]
    pub fn power_limits(&self) -> PowerLimits {
        let battery = self.battery;
        let (voltage, resistance) = (self.source_v, self.source_ohm);
        let per_ohm = resistance.recip();
        let rate_a = |limit: &RateLimit, recent_per_h: f64| {
            let allowance = Allowance { recent_per_h, remembered: self.remembered };
            let rate_per_h = limit.rate_per_h(self.temperature_k, self.state_of_charge, &allowance);
            rate_per_h * battery.cell_capacity_c / 3600.0
        };
        let recent_per_h = self.state.recent_charging_per_h;
        let discharge_a = rate_a(&battery.discharge_limit, -recent_per_h)
            .min((voltage - battery.minimum_string_voltage_v) * per_ohm)
            .clamp(0.0, 0.5 * voltage * per_ohm);
        let charge_a = rate_a(&battery.charge_limit, recent_per_h)
            .min((battery.maximum_string_voltage_v - voltage) * per_ohm)
            // A full battery accepts no charge.
            .min(self.state.charge_drawn_c / self.step_s)
            .max(0.0);
        PowerLimits {
            charge_w: battery.strings * charge_a * (voltage + resistance * charge_a),
            discharge_w: battery.strings * discharge_a * (voltage - resistance * discharge_a),
        }
    }

    /// Draws a terminal power (negative: charges). The power must lie within [`Self::power_limits`].
    #[must_use]
    #[inline(always)]
    pub fn draw(&self, terminal_power_w: f64) -> BatteryStep {
        let battery = self.battery;
        let power_w = terminal_power_w / battery.strings;
        let (source_v, resistance) = (self.source_v, self.source_ohm);
        let mut correction_v = 0.0;
        let mut current_a = 0.0;
        let mut mean_open_circuit_v = self.open_circuit_v;
        for _ in 0..VOLTAGE_ROUNDS {
            let voltage = source_v + correction_v;
            let root = (voltage * voltage - 4.0 * resistance * power_w).max(0.0).sqrt();
            current_a = 2.0 * power_w / (voltage + root);
            mean_open_circuit_v = self.mean_open_circuit_v(current_a);
            let next_v = mean_open_circuit_v - (self.open_circuit_v - self.discharge_ohm * current_a);
            let change_v = next_v - correction_v;
            correction_v = next_v;
            if change_v.abs() < 1e-13 * self.open_circuit_v {
                break;
            }
        }
        self.finish(current_a, mean_open_circuit_v)
    }

    /// Mean open-circuit voltage of a string while a constant current flows [V].
    #[inline(always)]
    fn mean_open_circuit_v(&self, current_a: f64) -> f64 {
        let battery = self.battery;
        let change = -current_a * self.step_s * battery.per_cell_capacity_1_c;
        let end = self.state_of_charge + change;
        if self.segment.holds(end) || change.abs() < 1e-9 {
            return self.open_circuit_v - self.discharge_ohm * current_a;
        }
        let rise = self.piece(end).integral_to(end) - self.segment.integral_to(self.state_of_charge);
        rise / change * battery.cells_in_series
    }

    /// Chemical energy that all cells gained up to a later state [J]: the open-circuit voltage summed over the charge.
    #[must_use]
    #[inline(always)]
    pub fn chemical_energy_gained_j(&self, later: &BatteryState) -> f64 {
        let battery = self.battery;
        let (start, end) = (self.state_of_charge, battery.state_of_charge(later));
        let rise_v = self.piece(end).integral_to(end) - self.segment.integral_to(start);
        rise_v * battery.cell_capacity_c * battery.cells_in_series * battery.strings
    }

    /// Piece of the open-circuit voltage that holds a state of charge.
    #[inline]
    fn piece(&self, state_of_charge: f64) -> &Segment {
        if self.segment.holds(state_of_charge) {
            self.segment
        } else {
            self.battery.open_circuit_voltage.segment(state_of_charge)
        }
    }

    #[inline(always)]
    fn finish(&self, current_a: f64, mean_open_circuit_v: f64) -> BatteryStep {
        let strings = self.battery.strings;
        let steady_v = self.polarisation_ohm * current_a;
        let mean_polarisation_v = steady_v + (self.polarisation_v - steady_v) * self.mean_decay;
        let end_polarisation_v = steady_v + (self.polarisation_v - steady_v) * self.decay;
        let polarisation = end_polarisation_v * self.root_capacitance;
        let stored_w = 0.5
            * (polarisation * polarisation - self.state.polarisation * self.state.polarisation)
            / self.step_s;
        let voltage_v = mean_open_circuit_v - self.series_ohm * current_a - mean_polarisation_v;
        // The second term equals the mean of v1^2 / R1 over the step (exact solution of the RC pair).
        let loss_w = self.series_ohm * current_a * current_a + (current_a * mean_polarisation_v - stored_w);
        let rate_per_h = -current_a * 3600.0 * self.battery.per_cell_capacity_1_c;
        BatteryStep {
            state: BatteryState {
                charge_drawn_c: self.state.charge_drawn_c + current_a * self.step_s,
                polarisation,
                recent_charging_per_h: rate_per_h
                    + (self.state.recent_charging_per_h - rate_per_h) * self.remembered,
                ..self.state
            },
            current_a: current_a * strings,
            voltage_v,
            terminal_power_w: voltage_v * current_a * strings,
            chemical_power_w: mean_open_circuit_v * current_a * strings,
            loss_w: loss_w * strings,
        }
    }
}
