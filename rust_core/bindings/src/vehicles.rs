//! Vehicles and architectures as Python sees them: tables of actuators and signals, and what they are made of.

use crate::errors::to_python;
use hp_episode::episode::Episode;
use hp_episode::guard::caught;
use hp_episode::rows::{ActionRow, branch_name};
use hp_plant::architecture::declaration::{Level, Side};
use hp_plant::architecture::layout::{
    BranchLayout, BranchSide, CabinLayout, ExchangerLayout, ExchangerSide, HeaterLayout, HeaterTarget,
    Layout, LoopLayout, MemberLayout,
};
use hp_plant::command::{ActuatorRow, Scale};
use hp_plant::config::library::Override;
use hp_plant::config::vehicle::{VehicleParameters, architecture};
use hp_plant::flows::{Crossing, Flow};
use hp_plant::numerics::thermal_network::Node;
use hp_plant::signals::{Signal, SignalTable};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use serde_json::{Value, json};
use std::sync::Arc;

/// Architecture that the tables of this module speak of unless another is named.
pub const DEFAULT_ARCHITECTURE: &str = "jeffs2019";

/// Name, unit, options (empty for levels) and description of an actuator.
pub type ActuatorTuple = (String, &'static str, Vec<String>, String);

/// Name, unit and description of a signal.
pub type SignalTuple = (String, &'static str, String);

fn options(scale: &Scale) -> Vec<String> {
    match scale {
        Scale::Choice(options) => options.clone(),
        Scale::Linear | Scale::OffThenLogarithmic => Vec::new(),
    }
}

/// An actuator as Python gets it.
pub fn actuator_tuple(row: &ActuatorRow) -> ActuatorTuple {
    (row.name.clone(), row.unit, options(&row.scale), row.description.clone())
}

/// A row of an action as Python gets it.
pub fn action_tuple(row: &ActionRow) -> ActuatorTuple {
    (row.name.clone(), row.unit, options(&row.scale), row.description.clone())
}

/// A signal as Python gets it.
pub fn signal_tuple(signal: &Signal) -> SignalTuple {
    (signal.name.clone(), signal.unit, signal.description.clone())
}

/// Names of the signals of vehicles, each made once.
#[derive(Default)]
pub struct SignalNames {
    /// By the address of the vehicle, which its garage keeps.
    known: Vec<(usize, Py<PyTuple>)>,
}

impl SignalNames {
    /// Names of the signals of the vehicle of an environment's trip.
    pub fn of<'py>(&mut self, py: Python<'py>, episode: &Episode) -> PyResult<Bound<'py, PyTuple>> {
        let Some((_, experiment)) = episode.trip() else { return Ok(PyTuple::empty(py)) };
        let vehicle = Arc::as_ptr(&experiment.plant).addr();
        if let Some((_, names)) = self.known.iter().find(|(known, _)| *known == vehicle) {
            return Ok(names.bind(py).clone());
        }
        let names = PyTuple::new(py, experiment.plant.signals.rows().iter().map(|signal| &signal.name))?;
        self.known.push((vehicle, names.clone().unbind()));
        Ok(names)
    }
}

/// Name, unit, options (empty for levels) and description of every actuator of an architecture.
#[pyfunction]
#[pyo3(signature = (name=DEFAULT_ARCHITECTURE))]
pub fn actuators(name: &str) -> PyResult<Vec<ActuatorTuple>> {
    let layout = caught(|| architecture(name)).map_err(to_python)?;
    Ok(layout.actuators.iter().map(actuator_tuple).collect())
}

/// Name, unit and description of every trajectory column of an architecture.
#[pyfunction(name = "signals")]
#[pyo3(signature = (name=DEFAULT_ARCHITECTURE))]
pub fn signal_table(name: &str) -> PyResult<Vec<SignalTuple>> {
    let layout = caught(|| architecture(name)).map_err(to_python)?;
    Ok(SignalTable::of(&layout).rows().iter().map(signal_tuple).collect())
}

/// Reads and checks an architecture by name or path; returns what it is made of.
#[pyfunction]
pub fn architecture_layout<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    to_dict(py, &described(&caught(|| architecture(name)).map_err(to_python)?, name))
}

/// Reads and checks a vehicle by name or path; returns what it is made of.
#[pyfunction]
#[pyo3(signature = (name, overrides=Vec::new()))]
pub fn vehicle_layout<'py>(
    py: Python<'py>,
    name: &str,
    overrides: Vec<String>,
) -> PyResult<Bound<'py, PyAny>> {
    let overrides: Vec<Override> =
        overrides.iter().map(|text| Override::parse(text)).collect::<Result<_, _>>().map_err(to_python)?;
    layout_dict(py, Some(&caught(|| VehicleParameters::load(name, &overrides)).map_err(to_python)?))
}

/// What a vehicle is made of, as a dict; empty without one.
pub fn layout_dict<'py>(py: Python<'py>, vehicle: Option<&VehicleParameters>) -> PyResult<Bound<'py, PyAny>> {
    let value =
        vehicle.map_or_else(|| json!({}), |vehicle| described(&vehicle.layout, &vehicle.architecture));
    to_dict(py, &value)
}

fn to_dict<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}

/// A layout with its names instead of positions.
struct Named<'a>(&'a Layout);

fn described(layout: &Layout, architecture: &str) -> Value {
    let named = Named(layout);
    let masses = layout.masses.iter().map(|mass| {
        json!({"member": layout.members[mass.member].name, "temperature": named.temperature(mass.node)})
    });
    let front_ends = layout.front_ends.iter().map(|front_end| {
        json!({
            "member": layout.members[front_end.member].name,
            "air_stream": front_end.stream,
            "behind": front_end.behind.map(|other| &layout.members[layout.front_ends[other].member].name),
        })
    });
    let nodes = (0..layout.nodes.len())
        .map(|node| json!({"temperature": named.temperature(Node::new(node as u8)), "description": layout.nodes[node].description}));
    let flows = layout.flows.iter().map(|row| {
        json!({"flow": row.column, "description": row.description, "crossing": crossing_word(row.crossing)})
    });
    let links = layout.links.iter().map(|link| {
        json!({
            "flow": named.flow(link.flow),
            "loses": link.ports.loses.map(|node| named.temperature(node)),
            "gains": link.ports.gains.map(|node| named.temperature(node)),
        })
    });
    let sources = layout.sources.iter().map(|source| {
        json!({"flow": named.flow(source.flow), "node": named.temperature(source.node), "out": source.out})
    });
    json!({
        "architecture": architecture,
        "description": layout.description,
        "refrigerates": layout.refrigerates(),
        "sections": layout.sections(),
        "loops": layout.loops.iter().map(|circuit| named.circuit(circuit)).collect::<Vec<_>>(),
        "members": layout.members.iter().map(|member| named.member(member)).collect::<Vec<_>>(),
        "branches": (0..layout.branches.len()).map(|place| named.branch(place)).collect::<Vec<_>>(),
        "exchangers": layout.exchangers.iter().map(|exchanger| named.exchanger(exchanger)).collect::<Vec<_>>(),
        "heaters": layout.heaters.iter().map(|heater| named.heater(heater)).collect::<Vec<_>>(),
        "cabins": layout.cabins.iter().enumerate().map(|(place, cabin)| named.cabin(place, cabin)).collect::<Vec<_>>(),
        "masses": masses.collect::<Vec<_>>(),
        "front_ends": front_ends.collect::<Vec<_>>(),
        "nodes": nodes.collect::<Vec<_>>(),
        "flows": flows.collect::<Vec<_>>(),
        "links": links.collect::<Vec<_>>(),
        "sources": sources.collect::<Vec<_>>(),
    })
}

impl Named<'_> {
    fn temperature(&self, node: Node) -> String {
        format!("{}_temperature_degc", self.0.nodes[node.index()].stem)
    }

    fn flow(&self, flow: Flow) -> Option<&str> {
        self.0.flows.iter().find(|row| row.flow == flow).map(|row| row.column.as_str())
    }

    fn actuator(&self, row: Option<usize>) -> Option<&str> {
        row.map(|row| self.0.actuators[row].name.as_str())
    }

    fn member_at(&self, node: Node) -> Option<&str> {
        self.0.members.iter().find(|member| member.node == Some(node)).map(|member| member.name.as_str())
    }

    fn circuit(&self, circuit: &LoopLayout) -> Value {
        let series =
            circuit.series.iter().map(|&branch| &self.0.members[self.0.branches[branch].member].name);
        json!({
            "name": circuit.name,
            "label": circuit.label,
            "side": match circuit.side { Side::Hot => "hot", Side::Cold => "cold" },
            "supply": self.temperature(circuit.supply),
            "return": self.temperature(circuit.back),
            "series": series.collect::<Vec<_>>(),
            "coolant_flow": format!("{}_flow_kg_s", circuit.name),
            "pump_power": self.flow(circuit.pump_flow),
            "flow_actuator": self.actuator(Some(circuit.flow_row)),
            "exchanger": circuit.exchanger.map(|place| &self.0.exchangers[place].name),
        })
    }

    fn member(&self, member: &MemberLayout) -> Value {
        let options = member.connection_row.map(|row| self.0.actuators[row].options().to_vec());
        json!({
            "name": member.name,
            "label": member.label,
            "kind": member.kind.data().word,
            "temperature": member.node.map(|node| self.temperature(node)),
            "options": options.unwrap_or_default(),
            "connection": member.connection_row.map(|_| format!("{}_connection", member.name)),
            "from": member.from.map(|circuit| &self.0.loops[circuit].name),
        })
    }

    fn branch(&self, place: usize) -> Value {
        let branch: BranchLayout = self.0.branches[place];
        json!({
            "member": self.0.members[branch.member].name,
            "loop": self.0.loops[branch.circuit].name,
            "series": branch.series,
            "direction": if branch.out_of_loop { "out-of-loop" } else { "into-loop" },
            "side": match branch.side {
                BranchSide::Mass(_) => "mass",
                BranchSide::Ambient(_) => "ambient",
                BranchSide::Core(_) => "cabin",
                BranchSide::Plate(_) => "plate",
            },
            "flow": self.flow(branch.flow),
            "granted": branch_name(self.0, place),
        })
    }

    fn exchanger(&self, exchanger: &ExchangerLayout) -> Value {
        let (side, name) = match exchanger.side {
            ExchangerSide::Loop(circuit) => ("loop", &self.0.loops[circuit].name),
            ExchangerSide::Cabin(cabin) => ("cabin", &self.0.members[self.0.cabins[cabin].member].name),
            ExchangerSide::FrontEnd(end) => {
                ("front-end", &self.0.members[self.0.front_ends[end].member].name)
            }
        };
        json!({
            "name": exchanger.name,
            "level": match exchanger.level { Level::Condensing => "condensing", Level::Evaporating => "evaporating" },
            "side": side,
            "on": name,
            "flow": self.flow(exchanger.flow),
            "valve": self.actuator(exchanger.valve_row),
        })
    }

    fn heater(&self, heater: &HeaterLayout) -> Value {
        let (side, name) = match heater.target {
            HeaterTarget::Loop(circuit) => ("loop", Some(self.0.loops[circuit].name.as_str())),
            HeaterTarget::Mass(node) => ("member", self.member_at(node)),
        };
        json!({
            "name": heater.name,
            "label": heater.label,
            "side": side,
            "heats": name,
            "power": self.flow(heater.flow),
            "actuator": self.actuator(Some(heater.row)),
        })
    }

    fn cabin(&self, place: usize, cabin: &CabinLayout) -> Value {
        json!({
            "member": self.0.members[cabin.member].name,
            "comfort": place == 0,
            "air": self.temperature(cabin.air),
            "exhaust": self.temperature(cabin.exhaust),
            "soft_furnishings": self.temperature(cabin.soft),
            "hard_furnishings": self.temperature(cabin.hard),
            "exhaust_recovery": cabin.recovery.map(|circuit| &self.0.loops[circuit].name),
            "blower_power": self.flow(cabin.blower_flow),
            "solar": self.flow(cabin.solar_flow),
            "solar_soft_furnishings": self.flow(cabin.solar_soft_flow),
            "solar_hard_furnishings": self.flow(cabin.solar_hard_flow),
            "occupants": self.flow(cabin.occupants_flow),
            "latent": cabin.latent_flow.map(|flow| self.flow(flow)),
            "recirculation_actuator": self.actuator(Some(cabin.recirculation_row)),
            "blower_actuator": self.actuator(Some(cabin.blower_row)),
            "windscreen_actuator": self.actuator(Some(cabin.windscreen_row)),
        })
    }
}

fn crossing_word(crossing: Crossing) -> &'static str {
    match crossing {
        Crossing::Enters => "enters",
        Crossing::Leaves => "leaves",
        Crossing::Inside => "inside",
    }
}
