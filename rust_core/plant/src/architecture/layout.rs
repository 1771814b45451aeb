//! What follows from an architecture: everything countable, by position.

use super::declaration::{
    Declaration, Direction, Flaw, HeaterDeclaration, Level, MemberDeclaration, MemberKind, Side,
};
use super::flows::{Crossing, FIXED_COUNT, Flow, FlowRow, OF_EVERY_VEHICLE};
use super::rows::{ActuatorRow, Purpose, Scale};
use super::wiring::{HeatSource, Inlet, Law, Link, SERIES_PLACES, SeriesPlace};
use crate::numerics::graph::{LinkPorts, Node};

/// Most thermal nodes.
pub const NODE_PLACES: usize = 22;
/// Most links of the thermal network.
pub const LINK_PLACES: usize = 56;
/// Most branches; a multiple of four, so that they are worked out side by side.
pub const BRANCH_PLACES: usize = 16;
/// Most flows; a multiple of four.
pub const FLOW_PLACES: usize = 80;
/// Most actuators; a multiple of eight.
pub const ACTUATOR_PLACES: usize = 40;
/// Most coolant loops.
pub const LOOP_PLACES: usize = 4;
/// Most cabins.
pub const CABIN_PLACES: usize = 2;
/// Most members.
pub const MEMBER_PLACES: usize = 12;
/// Most masses besides cabins.
pub const MASS_PLACES: usize = 8;
/// Most heaters.
pub const HEATER_PLACES: usize = 4;
/// Most exchangers of the refrigerant loop.
pub const EXCHANGER_PLACES: usize = 6;
/// Most front-end exchangers.
pub const FRONT_END_PLACES: usize = 3;
/// Most weights of branches in series.
pub const WEIGHT_PLACES: usize = 8;
/// Most loops that heat enters: exchangers of the refrigerant loop, heaters.
pub const INLET_PLACES: usize = 3;
/// What an inlet carries that is asked about only: the last place of flows, which nothing else has.
const NOTHING: Flow = Flow((FLOW_PLACES - 1) as u8);

/// A coolant loop.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopLayout {
    /// Name.
    pub name: String,
    /// Name in texts.
    pub label: String,
    /// What its branches do unless they say otherwise.
    pub side: Side,
    /// Node behind what tempers it, before its branches.
    pub supply: Node,
    /// Node behind its branches.
    pub back: Node,
    /// Branches in series, in order.
    pub series: Vec<usize>,
    /// Flow of its pump's power.
    pub pump_flow: Flow,
    /// Row of its coolant flow.
    pub flow_row: usize,
    /// Exchanger of the refrigerant loop that tempers it.
    pub exchanger: Option<usize>,
}

/// A member.
#[derive(Debug, Clone, PartialEq)]
pub struct MemberLayout {
    /// Name.
    pub name: String,
    /// Name in texts.
    pub label: String,
    /// What it is.
    pub kind: MemberKind,
    /// The vehicle's section with its numbers.
    pub section: String,
    /// Node of its mass; that of a cabin is its air.
    pub node: Option<Node>,
    /// Branches in the order of its actuator's options, which follow `isolated`.
    pub options: Vec<usize>,
    /// Row of its connection; none without branches.
    pub connection_row: Option<usize>,
    /// Row of its requested heat flow.
    pub request_row: Option<usize>,
    /// Row of its valve.
    pub valve_row: Option<usize>,
    /// Loop that a plate comes from.
    pub from: Option<usize>,
}

/// What is on the member's side of a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BranchSide {
    /// A thermal mass.
    Mass(Node),
    /// Ambient air; position among the front-end exchangers.
    Ambient(usize),
    /// Supply air of a cabin.
    Core(usize),
    /// Return of another loop.
    Plate(usize),
}

/// A branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BranchLayout {
    /// Member.
    pub member: usize,
    /// Loop.
    pub circuit: usize,
    /// Number of its option of the member's actuator; 0 is isolated.
    pub option: usize,
    /// In series.
    pub series: bool,
    /// Whether it moves heat out of the loop.
    pub out_of_loop: bool,
    /// What is on the other side.
    pub side: BranchSide,
    /// Flow that it carries, positive in its direction.
    pub flow: Flow,
}

/// A mass besides cabins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MassLayout {
    /// Member.
    pub member: usize,
    /// Node.
    pub node: Node,
}

/// A cabin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CabinLayout {
    /// Member.
    pub member: usize,
    /// Large air volume.
    pub air: Node,
    /// Small exhaust volume.
    pub exhaust: Node,
    /// Soft furnishings.
    pub soft: Node,
    /// Hard furnishings.
    pub hard: Node,
    /// Loop that its exhaust heat goes into.
    pub recovery: Option<usize>,
    /// Branch of its heater core, and that of its cooling core.
    pub heater: Option<usize>,
    /// Branch of its cooling core.
    pub cooler: Option<usize>,
    /// Flow of its blower's power.
    pub blower_flow: Flow,
    /// Flow of solar heat.
    pub solar_flow: Flow,
    /// Flow of its occupants' heat.
    pub occupants_flow: Flow,
    /// Row of the recirculated share.
    pub recirculation_row: usize,
    /// Row of the blower level.
    pub blower_row: usize,
}

/// What an exchanger of the refrigerant loop has on its other side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExchangerSide {
    /// Coolant of a loop.
    Loop(usize),
    /// Supply air of a cabin.
    Cabin(usize),
    /// Ambient air at a front-end exchanger.
    FrontEnd(usize),
}

/// An exchanger of the refrigerant loop.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExchangerLayout {
    /// Name.
    pub name: String,
    /// Pressure level.
    pub level: Level,
    /// Other side.
    pub side: ExchangerSide,
    /// Row of its valve; always open without.
    pub valve_row: Option<usize>,
    /// Flow that it carries, positive from the refrigerant where it condenses, into it where it evaporates.
    pub flow: Flow,
}

/// What a heater heats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeaterTarget {
    /// Coolant of a loop, at its supply.
    Loop(usize),
    /// A mass; the air of a cabin.
    Mass(Node),
}

/// A heater.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HeaterLayout {
    /// Name.
    pub name: String,
    /// Name in texts.
    pub label: String,
    /// What it heats.
    pub target: HeaterTarget,
    /// Row that allows it to heat.
    pub row: usize,
    /// Flow of its power.
    pub flow: Flow,
}

/// A front-end exchanger.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrontEndLayout {
    /// Member.
    pub member: usize,
    /// The vehicle's section of the air that it shares.
    pub stream: Option<String>,
    /// Front-end exchanger whose air it gets.
    pub behind: Option<usize>,
}

/// Everything that follows from an architecture.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// What it is, in a sentence.
    pub description: String,
    /// Loops.
    pub loops: Vec<LoopLayout>,
    /// Members.
    pub members: Vec<MemberLayout>,
    /// Branches.
    pub branches: Vec<BranchLayout>,
    /// Masses besides cabins: powertrain, then stores.
    pub masses: Vec<MassLayout>,
    /// Cabins, the one that counts for comfort first.
    pub cabins: Vec<CabinLayout>,
    /// Front-end exchangers.
    pub front_ends: Vec<FrontEndLayout>,
    /// Exchangers of the refrigerant loop.
    pub exchangers: Vec<ExchangerLayout>,
    /// Heaters.
    pub heaters: Vec<HeaterLayout>,
    /// Names of the nodes; the stem of a column.
    pub nodes: Vec<NodeRow>,
    /// Links of the thermal network.
    pub links: Vec<Link>,
    /// Heat that flows bring into nodes.
    pub sources: Vec<HeatSource>,
    /// Where heat enters loops: exchangers first, then loops with a heater only.
    pub inlets: Vec<Inlet>,
    /// Flows in the order of their columns.
    pub flows: Vec<FlowRow>,
    /// Flows of electrical power besides traction, compressor and heaters.
    pub base_loads: Vec<Flow>,
    /// Actuators.
    pub actuators: Vec<ActuatorRow>,
    /// Node of the battery.
    pub battery: Node,
    /// Node of motor and inverter.
    pub motor: Node,
    /// Node of the transmission.
    pub transmission: Node,
    /// Row of the compressor's power.
    pub compressor_row: Option<usize>,
    /// Row of the cabin temperature that heaters aim at.
    pub set_point_row: Option<usize>,
}

/// A node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodeRow {
    /// Stem of its column: `<stem>_temperature_degc`.
    pub stem: String,
    /// What it is.
    pub description: String,
}

/// First of the names of what belongs to a cabin: none for the one that counts for comfort.
fn of_cabin(cabin: usize, member: &MemberDeclaration) -> String {
    if cabin == 0 { String::new() } else { format!("{}_", member.name) }
}

fn label(given: Option<&String>, name: &str) -> String {
    given.cloned().unwrap_or_else(|| name.replace('_', " "))
}

/// Builds a [`Layout`] step by step.
struct Builder<'a> {
    declaration: &'a Declaration,
    layout: Layout,
}

impl Layout {
    /// The layout of a declared architecture.
    ///
    /// # Errors
    /// The declaration has a flaw, or is larger than there is room for.
    pub fn of(declaration: &Declaration) -> Result<Self, Flaw> {
        declaration.check()?;
        check_sizes(declaration)?;
        let mut builder = Builder { declaration, layout: Self::empty(declaration) };
        builder.add_nodes();
        builder.add_branches();
        builder.add_machines();
        builder.add_flows();
        builder.add_links();
        builder.add_sources();
        builder.add_actuators();
        let layout = builder.layout;
        let fixed = layout.flows.iter().filter(|row| row.flow.index() < FIXED_COUNT).count();
        for (what, count, room) in [
            ("thermal masses", layout.nodes.len(), NODE_PLACES),
            ("thermal links", layout.links.len(), LINK_PLACES),
            ("flows", FIXED_COUNT + layout.flows.len() - fixed, FLOW_PLACES - 1),
            ("loops with an exchanger or a heater", layout.inlets.len(), INLET_PLACES),
            ("actuators", layout.actuators.len(), ACTUATOR_PLACES),
            ("branches in series", layout.series_weights(), WEIGHT_PLACES),
        ] {
            check_room(what, count, room)?;
        }
        Ok(layout)
    }

    fn empty(declaration: &Declaration) -> Self {
        let node = Node::new(0);
        Self {
            description: declaration.description.clone(),
            loops: Vec::new(),
            members: Vec::new(),
            branches: Vec::new(),
            masses: Vec::new(),
            cabins: Vec::new(),
            front_ends: Vec::new(),
            exchangers: Vec::new(),
            heaters: Vec::new(),
            nodes: Vec::new(),
            links: Vec::new(),
            sources: Vec::new(),
            inlets: Vec::new(),
            flows: Vec::new(),
            base_loads: Vec::new(),
            actuators: Vec::new(),
            battery: node,
            motor: node,
            transmission: node,
            compressor_row: None,
            set_point_row: None,
        }
    }

    /// Number of weights of branches in series.
    #[must_use]
    pub fn series_weights(&self) -> usize {
        self.loops.iter().map(|circuit| (1..circuit.series.len()).map(|place| place + 1).sum::<usize>()).sum()
    }

    /// Place of the first weight of a later branch of a loop's series: loop by loop, not in the order of the branches.
    fn series_weight(&self, circuit: usize, position: usize) -> usize {
        let weights = |later: usize| (1..later).map(|place| place + 1).sum::<usize>();
        let before: usize = self.loops[..circuit].iter().map(|other| weights(other.series.len())).sum();
        before + weights(position)
    }

    /// Whether there is a refrigerant loop.
    #[must_use]
    pub fn refrigerates(&self) -> bool {
        !self.exchangers.is_empty()
    }

    /// Position of a member.
    #[must_use]
    pub fn member(&self, name: &str) -> Option<usize> {
        self.members.iter().position(|member| member.name == name)
    }

    /// Position of a loop.
    #[must_use]
    pub fn circuit(&self, name: &str) -> Option<usize> {
        self.loops.iter().position(|circuit| circuit.name == name)
    }

    /// Row of an actuator.
    #[must_use]
    pub fn actuator(&self, name: &str) -> Option<usize> {
        self.actuators.iter().position(|actuator| actuator.name == name)
    }

    /// Branch of a member in a loop.
    #[must_use]
    pub fn branch(&self, member: usize, circuit: usize) -> Option<usize> {
        self.branches.iter().position(|branch| branch.member == member && branch.circuit == circuit)
    }

    /// Sections that a vehicle must have besides those of [`super::declaration::VEHICLE_SECTIONS`].
    #[must_use]
    pub fn sections(&self) -> Vec<String> {
        let mut sections: Vec<String> = Vec::new();
        let loops = self.loops.iter().map(|circuit| circuit.name.clone());
        let members = self.members.iter().map(|member| member.section.clone());
        let heaters = self.heaters.iter().map(|heater| heater.name.clone());
        let streams = self.front_ends.iter().filter_map(|front_end| front_end.stream.clone());
        for section in loops.chain(members).chain(heaters).chain(streams) {
            if !sections.contains(&section) {
                sections.push(section);
            }
        }
        sections
    }
}

fn check_room(what: &str, count: usize, room: usize) -> Result<(), Flaw> {
    if count <= room {
        return Ok(());
    }
    Err(Flaw::new("architecture", format!("of {count} {what}"), format!("must have at most {room}")))
}

fn check_sizes(declaration: &Declaration) -> Result<(), Flaw> {
    let count = |kind: MemberKind| declaration.members.iter().filter(|member| member.kind == kind).count();
    let masses = 3 + count(MemberKind::Store);
    for (what, count, room) in [
        ("loops", declaration.loops.len(), LOOP_PLACES),
        ("members", declaration.members.len(), MEMBER_PLACES),
        ("branches", declaration.branches.len(), BRANCH_PLACES),
        ("cabins", count(MemberKind::Cabin), CABIN_PLACES),
        ("masses besides cabins", masses, MASS_PLACES),
        ("front-end exchangers", count(MemberKind::FrontEnd), FRONT_END_PLACES),
        ("heaters", declaration.heaters.len(), HEATER_PLACES),
        ("refrigerant exchangers", declaration.exchangers.len(), EXCHANGER_PLACES),
    ] {
        check_room(what, count, room)?;
    }
    for circuit in &declaration.loops {
        let series = declaration.branches.iter().filter(|b| b.series && b.circuit == circuit.name).count();
        check_room(&format!("branches in series in `{}`", circuit.name), series, SERIES_PLACES)?;
    }
    Ok(())
}

impl Builder<'_> {
    fn node(&mut self, stem: String, description: String) -> Node {
        let node = Node::new(self.layout.nodes.len() as u8);
        self.layout.nodes.push(NodeRow { stem, description });
        node
    }

    /// Loops, powertrain, cabins, stores.
    fn add_nodes(&mut self) {
        let declaration = self.declaration;
        for circuit in &declaration.loops {
            let label = label(circuit.label.as_ref(), &circuit.name);
            let supply =
                self.node(format!("{}_supply", circuit.name), format!("{label} before its branches"));
            let back = self.node(format!("{}_return", circuit.name), format!("{label} behind its branches"));
            self.layout.loops.push(LoopLayout {
                name: circuit.name.clone(),
                label,
                side: circuit.side,
                supply,
                back,
                series: Vec::new(),
                pump_flow: Flow::AUXILIARY,
                flow_row: 0,
                exchanger: None,
            });
        }
        for member in &declaration.members {
            self.layout.members.push(MemberLayout {
                name: member.name.clone(),
                label: label(member.label.as_ref(), &member.name),
                kind: member.kind,
                section: member.section().to_owned(),
                node: None,
                options: Vec::new(),
                connection_row: None,
                request_row: None,
                valve_row: None,
                from: member.from.as_ref().and_then(|name| declaration.circuit(name)),
            });
        }
        for kind in [MemberKind::Battery, MemberKind::Motor, MemberKind::Transmission] {
            self.add_masses(kind);
        }
        self.add_cabins();
        self.add_masses(MemberKind::Store);
    }

    fn add_masses(&mut self, kind: MemberKind) {
        for member in 0..self.layout.members.len() {
            if self.layout.members[member].kind != kind {
                continue;
            }
            let (stem, text) =
                (self.layout.members[member].name.clone(), self.layout.members[member].label.clone());
            let node = self.node(stem, text);
            self.layout.members[member].node = Some(node);
            self.layout.masses.push(MassLayout { member, node });
            match kind {
                MemberKind::Battery => self.layout.battery = node,
                MemberKind::Motor => self.layout.motor = node,
                MemberKind::Transmission => self.layout.transmission = node,
                _ => {}
            }
        }
    }

    fn add_cabins(&mut self) {
        let declaration = self.declaration;
        let mut cabins: Vec<usize> = (0..declaration.members.len())
            .filter(|&member| declaration.members[member].kind == MemberKind::Cabin)
            .collect();
        cabins.sort_by_key(|&member| !declaration.members[member].comfort);
        for (cabin, member) in cabins.into_iter().enumerate() {
            let declared = &declaration.members[member];
            let prefix = of_cabin(cabin, declared);
            let text = self.layout.members[member].label.clone();
            let air = self.node(declared.name.clone(), format!("{text}, large air volume"));
            let exhaust = self.node(format!("{prefix}exhaust"), format!("{text}, small exhaust volume"));
            let soft = self.node(format!("{prefix}soft_furnishings"), format!("{text}: seats, carpet"));
            let hard = self.node(format!("{prefix}hard_furnishings"), format!("{text}: dashboard, glass"));
            self.layout.members[member].node = Some(air);
            self.layout.cabins.push(CabinLayout {
                member,
                air,
                exhaust,
                soft,
                hard,
                recovery: declared.exhaust_recovery.as_ref().and_then(|name| declaration.circuit(name)),
                heater: None,
                cooler: None,
                blower_flow: Flow::AUXILIARY,
                solar_flow: Flow::AUXILIARY,
                occupants_flow: Flow::AUXILIARY,
                recirculation_row: 0,
                blower_row: 0,
            });
        }
    }

    fn add_branches(&mut self) {
        let declaration = self.declaration;
        self.add_front_ends();
        for (place, declared) in declaration.branches.iter().enumerate() {
            let (Some(member), Some(circuit)) =
                (declaration.member(&declared.member), declaration.circuit(&declared.circuit))
            else {
                continue;
            };
            let hot = declaration.loops[circuit].side == Side::Hot;
            let out_of_loop = match declared.direction {
                Some(direction) => direction == Direction::OutOfLoop,
                None => hot,
            };
            let side = self.branch_side(member);
            if let BranchSide::Core(cabin) = side {
                let core = if out_of_loop {
                    &mut self.layout.cabins[cabin].heater
                } else {
                    &mut self.layout.cabins[cabin].cooler
                };
                *core = Some(place);
            }
            if declared.series {
                self.layout.loops[circuit].series.push(place);
            }
            self.layout.branches.push(BranchLayout {
                member,
                circuit,
                option: 0,
                series: declared.series,
                out_of_loop,
                side,
                flow: Flow::AUXILIARY,
            });
        }
        for member in 0..self.layout.members.len() {
            self.add_options(member);
        }
    }

    fn add_front_ends(&mut self) {
        let declaration = self.declaration;
        let exchangers =
            (0..declaration.members.len()).filter(|&i| declaration.members[i].kind == MemberKind::FrontEnd);
        let places: Vec<usize> = exchangers.collect();
        for &member in &places {
            let name = &declaration.members[member].name;
            let stream = declaration.air_streams.iter().find(|stream| stream.through.contains(name));
            let behind = stream.and_then(|stream| {
                let place = stream.through.iter().position(|other| other == name)?;
                let before = declaration.member(&stream.through[place.checked_sub(1)?])?;
                places.iter().position(|&other| other == before)
            });
            let stream = stream.map(|stream| stream.name.clone());
            self.layout.front_ends.push(FrontEndLayout { member, stream, behind });
        }
    }

    fn branch_side(&self, member: usize) -> BranchSide {
        let layout = &self.layout;
        match layout.members[member].kind {
            MemberKind::Cabin => {
                BranchSide::Core(layout.cabins.iter().position(|cabin| cabin.member == member).unwrap_or(0))
            }
            MemberKind::FrontEnd => BranchSide::Ambient(
                layout.front_ends.iter().position(|end| end.member == member).unwrap_or(0),
            ),
            MemberKind::Plate => BranchSide::Plate(layout.members[member].from.unwrap_or(0)),
            _ => BranchSide::Mass(layout.members[member].node.unwrap_or(layout.battery)),
        }
    }

    fn add_options(&mut self, member: usize) {
        let declaration = self.declaration;
        let declared = &declaration.members[member];
        let loops: Vec<usize> = match &declared.options {
            Some(names) => names.iter().filter_map(|name| declaration.circuit(name)).collect(),
            None => declaration
                .loops_of(&declared.name)
                .into_iter()
                .filter_map(|n| declaration.circuit(n))
                .collect(),
        };
        for circuit in loops {
            if let Some(branch) = self.layout.branch(member, circuit) {
                self.layout.members[member].options.push(branch);
                self.layout.branches[branch].option = self.layout.members[member].options.len();
            }
        }
    }

    fn add_machines(&mut self) {
        let declaration = self.declaration;
        let alone =
            |level: Level| declaration.exchangers.iter().filter(|other| other.level == level).count() == 1;
        for (place, declared) in declaration.exchangers.iter().enumerate() {
            let side = match (&declared.circuit, &declared.air) {
                (Some(name), _) => ExchangerSide::Loop(declaration.circuit(name).unwrap_or(0)),
                (None, air) => {
                    let member = air.as_ref().and_then(|name| declaration.member(name)).unwrap_or(0);
                    match self.branch_side(member) {
                        BranchSide::Ambient(front_end) => ExchangerSide::FrontEnd(front_end),
                        BranchSide::Core(cabin) => ExchangerSide::Cabin(cabin),
                        BranchSide::Mass(_) | BranchSide::Plate(_) => ExchangerSide::Cabin(0),
                    }
                }
            };
            if let ExchangerSide::Loop(circuit) = side {
                self.layout.loops[circuit].exchanger = Some(place);
            }
            let total = if declared.level == Level::Condensing { Flow::CONDENSER } else { Flow::EVAPORATOR };
            // The only one on its level, facing coolant, carries the level's flow.
            let own = alone(declared.level) && matches!(side, ExchangerSide::Loop(_));
            self.layout.exchangers.push(ExchangerLayout {
                name: declared.name.clone(),
                level: declared.level,
                side,
                valve_row: None,
                flow: if own { total } else { Flow::AUXILIARY },
            });
        }
        for declared in &declaration.heaters {
            let target = self.heater_target(declared);
            self.layout.heaters.push(HeaterLayout {
                name: declared.name.clone(),
                label: label(declared.label.as_ref(), &declared.name),
                target,
                row: 0,
                flow: Flow::AUXILIARY,
            });
        }
    }

    fn heater_target(&self, heater: &HeaterDeclaration) -> HeaterTarget {
        match self.declaration.circuit(&heater.heats) {
            Some(circuit) => HeaterTarget::Loop(circuit),
            None => {
                let member = self.declaration.member(&heater.heats).unwrap_or(0);
                HeaterTarget::Mass(self.layout.members[member].node.unwrap_or(self.layout.battery))
            }
        }
    }

    fn flow(&mut self, column: String, description: String, crossing: Crossing) -> Flow {
        let own = self.layout.flows.iter().filter(|row| row.flow.index() >= FIXED_COUNT).count();
        let flow = Flow((FIXED_COUNT + own) as u8);
        self.layout.flows.push(FlowRow { flow, column, description, crossing });
        flow
    }

    fn fixed(&mut self, flow: Flow) {
        let row = &OF_EVERY_VEHICLE[flow.index()];
        let (column, description) = (row.column.to_owned(), row.description.to_owned());
        self.layout.flows.push(FlowRow { flow, column, description, crossing: row.crossing });
    }

    /// Flows in the order of their columns.
    fn add_flows(&mut self) {
        for flow in [
            Flow::DRAG,
            Flow::ROLLING,
            Flow::KINETIC,
            Flow::WHEEL,
            Flow::FRICTION_BRAKE,
            Flow::TRACTION,
            Flow::UNSERVED,
            Flow::MOTOR_LOSS,
            Flow::TRANSMISSION_LOSS,
            Flow::AUXILIARY,
        ] {
            self.fixed(flow);
        }
        self.layout.base_loads.push(Flow::AUXILIARY);
        for circuit in 0..self.layout.loops.len() {
            let LoopLayout { name, label, .. } = &self.layout.loops[circuit];
            let (column, text) =
                (format!("{name}_pump_power_w"), format!("Pump of the {label}; warms its coolant."));
            let flow = self.flow(column, text, Crossing::Inside);
            self.layout.loops[circuit].pump_flow = flow;
            self.layout.base_loads.push(flow);
        }
        for cabin in 0..self.layout.cabins.len() {
            let prefix = self.prefix(cabin);
            let text = "Blower; warms the cabin air.".to_owned();
            let flow = self.flow(format!("{prefix}blower_power_w"), text, Crossing::Inside);
            self.layout.cabins[cabin].blower_flow = flow;
            self.layout.base_loads.push(flow);
        }
        self.fixed(Flow::FAN);
        self.layout.base_loads.push(Flow::FAN);
        self.add_machine_flows();
        for flow in [Flow::BATTERY, Flow::CHEMICAL, Flow::BATTERY_LOSS] {
            self.fixed(flow);
        }
        for cabin in 0..self.layout.cabins.len() {
            let prefix = self.prefix(cabin);
            let text = "Solar heat into the cabin.".to_owned();
            self.layout.cabins[cabin].solar_flow =
                self.flow(format!("{prefix}solar_heat_flow_w"), text, Crossing::Enters);
            let text = "Heat of the occupants into the cabin.".to_owned();
            self.layout.cabins[cabin].occupants_flow =
                self.flow(format!("{prefix}occupant_heat_flow_w"), text, Crossing::Enters);
        }
    }

    fn add_machine_flows(&mut self) {
        for heater in 0..self.layout.heaters.len() {
            let HeaterLayout { name, label, .. } = &self.layout.heaters[heater];
            let (column, text) =
                (format!("{name}_power_w"), format!("Power of the {label}, all of it heat."));
            self.layout.heaters[heater].flow = self.flow(column, text, Crossing::Inside);
        }
        if !self.layout.refrigerates() {
            return;
        }
        for flow in [Flow::COMPRESSOR, Flow::COMPRESSOR_LOSS, Flow::CONDENSER, Flow::EVAPORATOR] {
            self.fixed(flow);
        }
        for place in 0..self.layout.exchangers.len() {
            let ExchangerLayout { name, level, side, flow, .. } = &self.layout.exchangers[place];
            if *flow != Flow::AUXILIARY {
                continue;
            }
            let crossing = match (side, level) {
                (ExchangerSide::FrontEnd(_), Level::Condensing) => Crossing::Leaves,
                (ExchangerSide::FrontEnd(_), Level::Evaporating) => Crossing::Enters,
                _ => Crossing::Inside,
            };
            let column = format!("{name}_heat_flow_w");
            let text = match level {
                Level::Condensing => {
                    format!("Heat from the condensing refrigerant in {}.", name.replace('_', " "))
                }
                Level::Evaporating => {
                    format!("Heat into the evaporating refrigerant in {}.", name.replace('_', " "))
                }
            };
            self.layout.exchangers[place].flow = self.flow(column, text, crossing);
        }
    }

    fn prefix(&self, cabin: usize) -> String {
        of_cabin(cabin, &self.declaration.members[self.layout.cabins[cabin].member])
    }

    fn link(&mut self, ports: LinkPorts, law: Law, flow: Flow) {
        self.layout.links.push(Link { ports, law, flow });
    }

    /// Links with the flows that they carry, in the order in which both are listed.
    fn add_links(&mut self) {
        self.add_loop_links();
        for branch in 0..self.layout.branches.len() {
            self.add_branch_links(branch);
        }
        for cabin in 0..self.layout.cabins.len() {
            self.add_recovery_links(cabin);
        }
        for mass in 0..self.layout.masses.len() {
            let MassLayout { member, node } = self.layout.masses[mass];
            let MemberLayout { name, label, .. } = &self.layout.members[member];
            let (column, text) =
                (format!("{name}_ambient_heat_flow_w"), format!("From the {label} to ambient."));
            let flow = self.flow(column, text, Crossing::Leaves);
            self.link(LinkPorts::to_surroundings(node), Law::MassToAmbient(mass as u8), flow);
        }
        for cabin in 0..self.layout.cabins.len() {
            self.add_cabin_links(cabin);
        }
    }

    fn add_loop_links(&mut self) {
        let count = self.layout.loops.len();
        for place in 0..count {
            let LoopLayout { name, label, supply, back, .. } = self.layout.loops[place].clone();
            let text = format!("Coolant flow of the {label}, supply to return side; internal.");
            let flow = self.flow(format!("{name}_advection_w"), text, Crossing::Inside);
            self.link(LinkPorts::between(supply, back), Law::Advection(place as u8), flow);
        }
        for place in 0..count {
            let LoopLayout { name, label, supply, back, .. } = self.layout.loops[place].clone();
            for (end, node) in [("supply", supply), ("return", back)] {
                let text = format!("Hoses of the {label}'s {end} to ambient.");
                let flow = self.flow(format!("{name}_{end}_hose_heat_flow_w"), text, Crossing::Leaves);
                self.link(LinkPorts::to_surroundings(node), Law::Hose(place as u8), flow);
            }
        }
    }

    fn add_branch_links(&mut self, place: usize) {
        let branch = self.layout.branches[place];
        let circuit = self.layout.loops[branch.circuit].clone();
        let member = self.layout.members[branch.member].clone();
        let (from, to) = if branch.out_of_loop {
            (&circuit.label, &member.label)
        } else {
            (&member.label, &circuit.label)
        };
        let crossing = match (branch.side, branch.out_of_loop) {
            (BranchSide::Ambient(_), true) => Crossing::Leaves,
            (BranchSide::Ambient(_), false) => Crossing::Enters,
            _ => Crossing::Inside,
        };
        let column = format!("{}_{}_heat_flow_w", member.name, circuit.name);
        let flow = self.flow(column, format!("From {from} to {to}."), crossing);
        self.layout.branches[place].flow = flow;
        let (law, own) = self.branch_law(place as u8, &branch);
        if branch.series {
            self.add_series_links(place, (law, own), flow);
        } else {
            self.add_parallel_link(&branch, &circuit, (law, own), flow);
        }
    }

    /// The supply drives it, the return takes or gives the heat.
    fn add_parallel_link(
        &mut self,
        branch: &BranchLayout,
        circuit: &LoopLayout,
        (law, own): (Law, Option<Node>),
        flow: Flow,
    ) {
        let other = match branch.side {
            BranchSide::Plate(from) => Some((self.layout.loops[from].back, self.layout.loops[from].supply)),
            _ => own.map(|node| (node, node)),
        };
        let (drives, exchanges) = (other.map(|ends| ends.0), other.map(|ends| ends.1));
        let ports = if branch.out_of_loop {
            LinkPorts { loses: Some(circuit.back), gains: exchanges, hot: Some(circuit.supply), cold: drives }
        } else {
            LinkPorts { loses: exchanges, gains: Some(circuit.back), hot: drives, cold: Some(circuit.supply) }
        };
        self.link(ports, law, flow);
    }

    /// Return and all members before it in the series drive it, each by its weight.
    fn add_series_links(&mut self, place: usize, (law, own): (Law, Option<Node>), flow: Flow) {
        let branch = self.layout.branches[place];
        let circuit = self.layout.loops[branch.circuit].clone();
        let before: Vec<Node> = circuit
            .series
            .iter()
            .take_while(|&&other| other != place)
            .filter_map(|&other| match self.layout.branches[other].side {
                BranchSide::Mass(node) => Some(node),
                _ => None,
            })
            .collect();
        let ports = |drives: Node, member: Option<Node>| {
            if branch.out_of_loop {
                LinkPorts { loses: Some(circuit.supply), gains: own, hot: Some(drives), cold: member }
            } else {
                LinkPorts { loses: own, gains: Some(circuit.supply), hot: member, cold: Some(drives) }
            }
        };
        if before.is_empty() {
            self.link(ports(circuit.back, own), law, flow);
            return;
        }
        let weight = self.layout.series_weight(branch.circuit, before.len());
        self.link(
            ports(circuit.back, own),
            Law::SeriesReturn(place as u8, weight as u8, branch.out_of_loop),
            flow,
        );
        for (k, node) in before.into_iter().enumerate() {
            let weight = (weight + 1 + k) as u8;
            self.link(ports(node, None), Law::SeriesBefore(place as u8, weight, branch.out_of_loop), flow);
        }
    }

    fn branch_law(&self, place: u8, branch: &BranchLayout) -> (Law, Option<Node>) {
        match (branch.side, branch.out_of_loop) {
            (BranchSide::Mass(node), _) => (Law::Branch(place), Some(node)),
            (BranchSide::Plate(_), _) => (Law::Branch(place), None),
            (BranchSide::Core(cabin), true) => {
                (Law::HeaterCore(place, cabin as u8), Some(self.layout.cabins[cabin].air))
            }
            (BranchSide::Core(cabin), false) => {
                (Law::CoolingCore(place, cabin as u8), Some(self.layout.cabins[cabin].air))
            }
            (BranchSide::Ambient(end), out_of_loop) => {
                let law = match (self.layout.front_ends[end].behind, out_of_loop) {
                    (None, true) => Law::BranchToAmbient(place),
                    (None, false) => Law::BranchFromAmbient(place),
                    (Some(_), true) => Law::BranchToStream(place, end as u8),
                    (Some(_), false) => Law::BranchFromStream(place, end as u8),
                };
                (law, None)
            }
        }
    }

    /// The exhaust enters at cabin temperature and meets whichever is warmer, ambient (only heat above ambient is "exhaust
    /// heat") or the supply of its loop.
    fn add_recovery_links(&mut self, cabin: usize) {
        let layout = self.layout.cabins[cabin];
        let Some(circuit) = layout.recovery else { return };
        let LoopLayout { label, supply, back, .. } = self.layout.loops[circuit].clone();
        let column = format!("{}exhaust_recovery_heat_flow_w", self.prefix(cabin));
        let flow = self.flow(column, format!("Exhaust air to {label}."), Crossing::Inside);
        let ports =
            LinkPorts { loses: Some(layout.exhaust), gains: Some(back), hot: Some(layout.air), cold: None };
        self.link(ports, Law::RecoveryFromAmbient(cabin as u8), flow);
        self.link(LinkPorts { cold: Some(supply), ..ports }, Law::RecoveryFromLoop(cabin as u8), flow);
    }

    fn add_cabin_links(&mut self, cabin: usize) {
        let CabinLayout { member, air, exhaust, soft, hard, .. } = self.layout.cabins[cabin];
        let (prefix, place) = (self.prefix(cabin), cabin as u8);
        let name = self.layout.members[member].name.clone();
        let flow = self.flow(
            format!("{name}_panel_heat_flow_w"),
            "Cabin through its panels to ambient.".to_owned(),
            Crossing::Leaves,
        );
        self.link(LinkPorts::to_surroundings(air), Law::Panel(place), flow);
        for (part, node, law) in [("soft", soft, Law::Soft(place)), ("hard", hard, Law::Hard(place))] {
            let column = format!("{prefix}{part}_furnishings_heat_flow_w");
            let flow = self.flow(column, format!("Cabin air to {part} furnishings."), Crossing::Inside);
            self.link(LinkPorts::between(air, node), law, flow);
        }
        let text = "Cabin air into the small exhaust volume, relative to ambient.".to_owned();
        let flow = self.flow(format!("{name}_exhaust_heat_flow_w"), text, Crossing::Inside);
        let ports = LinkPorts { gains: Some(exhaust), ..LinkPorts::to_surroundings(air) };
        self.link(ports, Law::Exhaust(place), flow);
        let text = "Exhaust air leaving the vehicle, relative to ambient.".to_owned();
        let flow = self.flow(format!("{prefix}exhaust_ambient_heat_flow_w"), text, Crossing::Leaves);
        self.link(LinkPorts::to_surroundings(exhaust), Law::Exhaust(place), flow);
    }

    /// Heat that flows bring into nodes besides links.
    fn add_sources(&mut self) {
        for place in 0..self.layout.exchangers.len() {
            let ExchangerLayout { level, side, flow, .. } = self.layout.exchangers[place];
            let out = level == Level::Evaporating;
            match side {
                ExchangerSide::Loop(circuit) => {
                    let inlet = self.inlet(circuit, flow, out);
                    self.layout.inlets.push(inlet);
                }
                ExchangerSide::Cabin(cabin) => {
                    let node = self.layout.cabins[cabin].air;
                    self.layout.sources.push(HeatSource { flow, node, out });
                }
                ExchangerSide::FrontEnd(_) => {}
            }
        }
        for heater in 0..self.layout.heaters.len() {
            let HeaterLayout { target, flow, .. } = self.layout.heaters[heater];
            let node = match target {
                HeaterTarget::Loop(circuit) => {
                    let asked = self.layout.inlets.iter().any(|inlet| usize::from(inlet.circuit) == circuit);
                    if !asked {
                        let inlet = self.inlet(circuit, NOTHING, false);
                        self.layout.inlets.push(inlet);
                    }
                    self.layout.loops[circuit].supply
                }
                HeaterTarget::Mass(node) => node,
            };
            self.layout.sources.push(HeatSource { flow, node, out: false });
        }
        for circuit in 0..self.layout.loops.len() {
            let LoopLayout { back, pump_flow, .. } = self.layout.loops[circuit];
            self.layout.sources.push(HeatSource { flow: pump_flow, node: back, out: false });
        }
        let Layout { motor, transmission, battery, .. } = self.layout;
        for (flow, node) in [
            (Flow::MOTOR_LOSS, motor),
            (Flow::TRANSMISSION_LOSS, transmission),
            (Flow::BATTERY_LOSS, battery),
        ] {
            self.layout.sources.push(HeatSource { flow, node, out: false });
        }
        for cabin in self.layout.cabins.clone() {
            for flow in [cabin.blower_flow, cabin.solar_flow, cabin.occupants_flow] {
                self.layout.sources.push(HeatSource { flow, node: cabin.air, out: false });
            }
        }
    }

    fn inlet(&self, circuit: usize, flow: Flow, out: bool) -> Inlet {
        let mut series = [None; SERIES_PLACES];
        for (place, &branch) in series.iter_mut().zip(&self.layout.loops[circuit].series) {
            let layout = self.layout.branches[branch];
            if let BranchSide::Mass(node) = layout.side {
                let (branch, out_of_loop) = (branch as u8, layout.out_of_loop);
                *place = Some(SeriesPlace { branch, node, flow: layout.flow, out_of_loop });
            }
        }
        Inlet { flow, out, supply: self.layout.loops[circuit].supply, circuit: circuit as u8, series }
    }

    fn row(&mut self, row: ActuatorRow) -> usize {
        self.layout.actuators.push(row);
        self.layout.actuators.len() - 1
    }

    fn add_actuators(&mut self) {
        let members: Vec<usize> = (0..self.layout.members.len())
            .filter(|&member| !self.layout.members[member].options.is_empty())
            .collect();
        for &member in &members {
            let MemberLayout { name, label, options, .. } = self.layout.members[member].clone();
            let loops = options
                .iter()
                .map(|&branch| self.layout.loops[self.layout.branches[branch].circuit].name.clone());
            let options: Vec<String> = std::iter::once("isolated".to_owned()).chain(loops).collect();
            let text = format!("connection of {label}");
            let row = self.row(ActuatorRow::choice(name, options, Purpose::Connection(member), text));
            self.layout.members[member].connection_row = Some(row);
        }
        for heater in 0..self.layout.heaters.len() {
            let HeaterLayout { name, label, .. } = self.layout.heaters[heater].clone();
            let options = ["off", "allowed"].map(str::to_owned).to_vec();
            let text = format!("{label} under its own PID on the cabin temperature");
            self.layout.heaters[heater].row =
                self.row(ActuatorRow::choice(name, options, Purpose::Heater(heater), text));
        }
        for place in 0..self.declaration.exchangers.len() {
            if self.declaration.exchangers[place].valve {
                let name = self.layout.exchangers[place].name.clone();
                let options = ["closed", "open"].map(str::to_owned).to_vec();
                let text = format!("refrigerant valve of the {}", name.replace('_', " "));
                let row = self.row(ActuatorRow::choice(name, options, Purpose::ExchangerValve(place), text));
                self.layout.exchangers[place].valve_row = Some(row);
            }
        }
        if self.layout.refrigerates() {
            let row = self.row(ActuatorRow {
                name: "compressor_power".to_owned(),
                unit: "W",
                scale: Scale::OffThenLogarithmic,
                description: "electrical power demand of the compressor".to_owned(),
                purpose: Purpose::Compressor,
            });
            self.layout.compressor_row = Some(row);
        }
        self.add_levels(&members);
    }

    fn add_levels(&mut self, members: &[usize]) {
        let cabins = self.layout.cabins.len();
        for cabin in 0..cabins {
            let (name, text) =
                (format!("{}recirculation", self.prefix(cabin)), "recirculated share of the supply air");
            self.layout.cabins[cabin].recirculation_row =
                self.row(ActuatorRow::level(name, "-", Purpose::Recirculation(cabin), text.to_owned()));
            let (name, text) = (
                format!("{}blower_level", self.prefix(cabin)),
                "blower level between smallest and largest air flow",
            );
            self.layout.cabins[cabin].blower_row =
                self.row(ActuatorRow::level(name, "-", Purpose::Blower(cabin), text.to_owned()));
        }
        for circuit in 0..self.layout.loops.len() {
            let LoopLayout { name, label, .. } = self.layout.loops[circuit].clone();
            let text = format!("coolant flow demand of the {label}");
            self.layout.loops[circuit].flow_row = self.row(ActuatorRow::level(
                format!("{name}_flow"),
                "kg/s",
                Purpose::LoopFlow(circuit),
                text,
            ));
        }
        for &member in members {
            let MemberLayout { name, label, .. } = self.layout.members[member].clone();
            let text = format!("heat flow requested between {label} and its loop");
            let row =
                self.row(ActuatorRow::level(format!("{name}_request"), "W", Purpose::Request(member), text));
            self.layout.members[member].request_row = Some(row);
        }
        for &member in members {
            let MemberLayout { name, label, .. } = self.layout.members[member].clone();
            let text = format!("valve of the branch of {label}: share of its open position");
            let row =
                self.row(ActuatorRow::level(format!("{name}_valve"), "-", Purpose::Valve(member), text));
            self.layout.members[member].valve_row = Some(row);
        }
        if !self.layout.heaters.is_empty() {
            let text = "cabin temperature that the heaters' PIDs aim at".to_owned();
            let row = self.row(ActuatorRow::level("cabin_set_point", "K", Purpose::CabinSetPoint, text));
            self.layout.set_point_row = Some(row);
        }
    }
}
