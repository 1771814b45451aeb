//! The one table of what can be seen of a vehicle: name, unit, meaning, reader.
//!
//! Trajectories, reports and observations are derived from these rows.

use crate::circuits::assembly::NODES;
use crate::command::{Connection, Member};
use crate::config::ZERO_CELSIUS_K;
use crate::flows::Flow;
use crate::numerics::thermal_network::Node;
use crate::plant::{Disturbance, Plant, StepRecord};
use crate::state::State;

/// Everything that a reader may look at after a step.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// Vehicle.
    pub plant: &'a Plant,
    /// State at the end of the step.
    pub state: &'a State,
    /// What happened; absent before the first step.
    pub record: Option<&'a StepRecord>,
    /// What the surroundings did.
    pub disturbance: &'a Disturbance,
}

impl View<'_> {
    fn recorded(&self, read: impl Fn(&StepRecord) -> f64) -> f64 {
        self.record.map_or(0.0, read)
    }
}

/// A quantity that can be seen.
#[derive(Debug, Clone, Copy)]
pub struct Signal {
    /// Name with its unit; a trajectory column.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Meaning.
    pub description: &'static str,
    reader: Reader,
}

#[derive(Debug, Clone, Copy)]
enum Reader {
    Function(fn(&View<'_>) -> f64),
    Temperature(Node),
    Flow(Flow),
    Connection(Member),
}

impl Signal {
    /// The flow that it shows, if it is one.
    #[must_use]
    pub fn flow(&self) -> Option<Flow> {
        match self.reader {
            Reader::Flow(flow) => Some(flow),
            Reader::Function(_) | Reader::Temperature(_) | Reader::Connection(_) => None,
        }
    }

    /// The node whose temperature it shows in degC, if it shows one.
    #[must_use]
    pub fn node(&self) -> Option<Node> {
        match self.reader {
            Reader::Temperature(node) => Some(node),
            Reader::Function(_) | Reader::Flow(_) | Reader::Connection(_) => None,
        }
    }

    /// Value at a view.
    #[must_use]
    #[inline(always)]
    pub fn read(&self, view: &View<'_>) -> f64 {
        match self.reader {
            Reader::Function(read) => read(view),
            Reader::Temperature(node) => view.state.temperatures_k[node.index()] - ZERO_CELSIUS_K,
            Reader::Flow(flow) => view.recorded(|record| record.flows[flow]),
            Reader::Connection(member) => match view.state.connection(member) {
                Connection::Isolated => 0.0,
                Connection::Htc => 1.0,
                Connection::Chiller => 2.0,
            },
        }
    }
}

macro_rules! signals {
    ($( $name:literal, $unit:literal, $description:literal, $reader:expr; )*) => {
        &[$( Signal { name: $name, unit: $unit, description: $description, reader: $reader }, )*]
    };
}

const fn function(read: fn(&View<'_>) -> f64) -> Reader {
    Reader::Function(read)
}

const fn temperature(node: Node) -> Reader {
    Reader::Temperature(node)
}

const STATES: &[Signal] = signals! {
    "time_s", "s", "time since the start", function(|v| v.state.time_s);
    "speed_m_s", "m/s", "vehicle speed at the end of the step",
        function(|v| if v.record.is_some() { v.disturbance.end_speed_m_s } else { v.disturbance.start_speed_m_s });
    "ambient_temperature_degc", "degC", "ambient air", function(|v| v.disturbance.air.temperature_k - ZERO_CELSIUS_K);
    "cabin_temperature_degc", "degC", "cabin, large air volume", temperature(NODES.cabin);
    "exhaust_temperature_degc", "degC", "cabin, small exhaust volume", temperature(NODES.exhaust);
    "soft_furnishings_temperature_degc", "degC", "seats, carpet", temperature(NODES.soft);
    "hard_furnishings_temperature_degc", "degC", "dashboard, glass", temperature(NODES.hard);
    "battery_temperature_degc", "degC", "battery", temperature(NODES.battery);
    "motor_temperature_degc", "degC", "motor and inverter", temperature(NODES.motor);
    "transmission_temperature_degc", "degC", "transmission", temperature(NODES.transmission);
    "thermal_battery_temperature_degc", "degC", "thermal battery", temperature(NODES.thermal_battery);
    "htc_supply_temperature_degc", "degC", "HTC after condenser, thermal battery and PTC",
        temperature(NODES.htc_supply);
    "htc_return_temperature_degc", "degC", "HTC before the condenser", temperature(NODES.htc_return);
    "chiller_supply_temperature_degc", "degC", "chiller loop after the evaporator",
        temperature(NODES.chiller_supply);
    "chiller_return_temperature_degc", "degC", "chiller loop before the evaporator",
        temperature(NODES.chiller_return);
    "soc", "-", "state of charge of equation (6), against the capacity usable at the present temperature",
        function(|v| v.plant.battery.usable_state_of_charge(&v.state.battery,
            v.state.temperatures_k[v.plant.assembly.nodes.battery.index()]));
    "charge_soc", "-", "state of charge by charge alone", function(|v| v.plant.battery.state_of_charge(&v.state.battery));
    "battery_voltage_v", "V", "mean terminal voltage", function(|v| v.recorded(|r| r.battery_voltage_v));
    "battery_current_a", "A", "mean pack current, positive while discharging", function(|v| v.recorded(|r| r.battery_current_a));
    "battery_charge_limit_w", "W", "largest charging power", function(|v| v.recorded(|r| r.power_limits.charge_w));
    "battery_discharge_limit_w", "W", "largest discharging power", function(|v| v.recorded(|r| r.power_limits.discharge_w));
    "auxiliary_power_w", "W", "12 V load, pumps, blower and fan", function(|v| v.recorded(|r| r.flows.base_load_w()));
    "htc_flow_kg_s", "kg/s", "HTC coolant flow", function(|v| v.state.htc_pump.flow_kg_s);
    "chiller_flow_kg_s", "kg/s", "chiller coolant flow", function(|v| v.state.chiller_pump.flow_kg_s);
    "compressor_demand_w", "W", "compressor power asked for", function(|v| v.recorded(|r| r.demanded_w));
    "compressor_speed_rev_s", "rev/s", "compressor speed", function(|v| v.recorded(|r| r.refrigeration.speed_rev_s));
    "compressor_starts", "-", "compressor starts so far", function(|v| f64::from(v.state.refrigeration.compressor.starts));
    "protection_trips", "-", "compressor stops forced by a limit so far",
        function(|v| f64::from(v.state.refrigeration.compressor.protection_trips));
    "condensing_pressure_bar", "bar", "condensing pressure", function(|v| v.recorded(|r| r.refrigeration.condensing_pressure_pa * 1e-5));
    "evaporating_pressure_bar", "bar", "evaporating pressure", function(|v| v.recorded(|r| r.refrigeration.evaporating_pressure_pa * 1e-5));
    "condensing_temperature_degc", "degC", "condensing temperature",
        function(|v| v.recorded(|r| r.refrigeration.condensing_temperature_k - ZERO_CELSIUS_K));
    "evaporating_temperature_degc", "degC", "evaporating temperature",
        function(|v| v.recorded(|r| r.refrigeration.evaporating_temperature_k - ZERO_CELSIUS_K));
    "discharge_temperature_degc", "degC", "gas at the compressor outlet",
        function(|v| v.recorded(|r| r.refrigeration.discharge_temperature_k - ZERO_CELSIUS_K));
    "refrigerant_flow_kg_s", "kg/s", "refrigerant mass flow", function(|v| v.recorded(|r| r.refrigeration.mass_flow_kg_s));
    "refrigeration_status", "-", "how the refrigerant solve ended, position in its list of statuses",
        function(|v| v.recorded(|r| r.refrigeration.status as u8 as f64));
    "cop", "-", "condenser heat flow over compressor power; 0 at rest",
        function(|v| v.recorded(|r| {
            let power_w = r.flows[Flow::Compressor];
            if power_w > 0.0 { r.flows[Flow::Condenser] / power_w } else { 0.0 }
        }));
    "loads_shed", "-", "1 while thermal loads are cut because the battery cannot feed them",
        function(|v| v.recorded(|r| f64::from(u8::from(r.loads_shed))));
    "energy_residual_w", "W", "residual of the energy ledger", function(|v| v.recorded(|r| r.ledger.residual_w));
    "energy_scale_w", "W", "power in play that the residual is compared with", function(|v| v.recorded(|r| r.ledger.scale_w));
};

const CONNECTIONS: [(&str, Member); 6] = [
    ("battery_connection", Member::Battery),
    ("motor_connection", Member::Motor),
    ("transmission_connection", Member::Transmission),
    ("ambient_connection", Member::Ambient),
    ("thermal_battery_connection", Member::ThermalBattery),
    ("cabin_connection", Member::Cabin),
];

const fn of_connection((name, member): (&'static str, Member)) -> Signal {
    Signal {
        name,
        unit: "-",
        description: "loop that it is connected to: 0 none, 1 HTC, 2 chiller",
        reader: Reader::Connection(member),
    }
}

const fn of_flow(flow: Flow) -> Signal {
    Signal { name: flow.column(), unit: "W", description: flow.description(), reader: Reader::Flow(flow) }
}

/// The first of all signals.
pub const TIME: Signal = STATES[0];

/// Number of signals.
const SIGNALS: usize = STATES.len() + CONNECTIONS.len() + Flow::ALL.len();

/// The signal in a column.
const fn at(column: usize) -> Signal {
    const FIRST_FLOW: usize = STATES.len() + CONNECTIONS.len();
    if column < STATES.len() {
        STATES[column]
    } else if column < FIRST_FLOW {
        of_connection(CONNECTIONS[column - STATES.len()])
    } else {
        of_flow(Flow::ALL[column - FIRST_FLOW])
    }
}

/// All signals, in column order.
pub fn all() -> impl Iterator<Item = Signal> {
    (0..SIGNALS).map(at)
}

/// The signal of a name; a program can ask for it while it is compiled.
#[must_use]
pub const fn find(name: &str) -> Option<Signal> {
    let mut column = 0;
    while column < SIGNALS {
        let signal = at(column);
        if same(signal.name.as_bytes(), name.as_bytes()) {
            return Some(signal);
        }
        column += 1;
    }
    None
}

/// Whether two strings are the same, which `==` does not tell while compiling.
const fn same(one: &[u8], other: &[u8]) -> bool {
    if one.len() != other.len() {
        return false;
    }
    let mut place = 0;
    while place < one.len() {
        if one[place] != other[place] {
            return false;
        }
        place += 1;
    }
    true
}
