//! What rules speak of, found in a vehicle's architecture: which option of which actuator heats the cabin, cools the battery,
//! lets a source feed the heat pump.

use crate::strategy::Strategy;
use hp_plant::architecture::declaration::{Level, Side};
use hp_plant::architecture::kind::Role;
use hp_plant::architecture::layout::{BranchLayout, BranchSide, ExchangerSide, Layout};
use hp_plant::command::{Demand, ISOLATED, MAXIMUM_REQUEST_W};
use hp_plant::numerics::thermal_network::Node;

/// A branch with what connects it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Way {
    /// Branch.
    pub branch: usize,
    /// Number of the member's option.
    pub option: usize,
}

/// A member with a connection, and its ways to heat and to cool it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Connectable {
    /// Row of its connection.
    pub row: usize,
    /// Row of its requested heat flow.
    pub request_row: usize,
    /// Heats it.
    pub heats: Option<Way>,
    /// Cools it.
    pub cools: Option<Way>,
}

impl Connectable {
    /// Connects a way, or isolates the member where there is none.
    #[inline]
    pub fn connect(&self, demand: &mut Demand, way: Option<Way>) {
        demand[self.row] = way.map_or(ISOLATED, |way| way.option as f64);
    }
}

/// A heat store.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Store {
    /// Member, whose name the strategy uses.
    pub member: usize,
    /// Row of its connection.
    pub row: usize,
    /// Way into a hot loop.
    pub into_hot: Option<Way>,
    /// Way into a cold loop.
    pub into_cold: Option<Way>,
}

/// A front-end exchanger that heat pumps use both ways.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrontEnd {
    /// Row of its connection.
    pub row: usize,
    /// Row of its requested heat flow.
    pub request_row: usize,
    /// Way in which it feeds a chilled loop, if it may.
    pub source: Option<Way>,
    /// Way in which it takes heat from a hot loop.
    pub rejects: Option<Way>,
}

/// What rules speak of in one vehicle, what they may not use left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Roles {
    /// Cabins with coolant cores.
    pub cabins: Vec<Connectable>,
    /// Air of the cabin that counts for comfort.
    pub cabin_air: Node,
    /// Battery, where it can be connected.
    pub battery: Option<Connectable>,
    /// Node of the battery.
    pub battery_node: Node,
    /// Rows and options of motor, transmission and the like that may feed the heat pump.
    pub sources: Vec<(usize, f64)>,
    /// Front-end exchangers of the heat pump's loops.
    pub front_ends: Vec<FrontEnd>,
    /// Rows and options that are connected whenever there is a temperature difference: radiators of other loops, and what they
    /// cool besides the battery.
    pub always: Vec<(usize, f64)>,
    /// Rows and options of plates that cool the battery's loop.
    pub plates: Vec<(usize, f64)>,
    /// Stores that may be used.
    pub stores: Vec<Store>,
    /// Rows of heaters.
    pub heaters: Vec<usize>,
    /// Rows of refrigerant valves that are open while heating, and those while cooling.
    pub heating_valves: Vec<usize>,
    /// Rows of refrigerant valves that are open while cooling.
    pub cooling_valves: Vec<usize>,
    /// Row of the compressor.
    pub compressor_row: Option<usize>,
    /// Supplies of the loops that condensers heat.
    pub hot_supplies: Vec<Node>,
    /// Supplies of the loops that evaporators cool.
    pub cold_supplies: Vec<Node>,
    /// Rows of the coolant flow of hot loops, and of cold ones.
    pub hot_flow_rows: Vec<usize>,
    /// Rows of the coolant flow of cold loops.
    pub cold_flow_rows: Vec<usize>,
    /// Rows of recirculation and blower of each cabin.
    pub recirculation_rows: Vec<usize>,
    /// Rows of blowers.
    pub blower_rows: Vec<usize>,
    /// Rows of the share of air that is blown at windscreens.
    pub windscreen_rows: Vec<usize>,
    /// Row of the cabin temperature that heaters aim at.
    pub set_point_row: Option<usize>,
}

/// First way of a member among those that fit.
fn way(layout: &Layout, member: usize, fits: impl Fn(&BranchLayout) -> bool) -> Option<Way> {
    let branch =
        layout.members[member].options.iter().copied().find(|&branch| fits(&layout.branches[branch]))?;
    Some(Way { branch, option: layout.branches[branch].option })
}

/// Whether an exchanger of the refrigerant loop tempers a branch's loop.
fn tempered(layout: &Layout, branch: &BranchLayout) -> bool {
    layout.loops[branch.circuit].exchanger.is_some()
}

fn connectable(layout: &Layout, member: usize) -> Option<Connectable> {
    let (row, request_row) = (layout.members[member].connection_row?, layout.members[member].request_row?);
    let heats = way(layout, member, |branch| branch.out_of_loop);
    let cools = way(layout, member, |branch| !branch.out_of_loop);
    Some(Connectable { row, request_row, heats, cools })
}

impl Roles {
    /// Roles in a layout under a strategy.
    #[must_use]
    pub fn of(layout: &Layout, strategy: &Strategy) -> Self {
        let of_role = |role: Role| {
            (0..layout.members.len()).filter(move |&m| layout.members[m].kind.data().role == Some(role))
        };
        let allowed = |member: usize| strategy.uses(&layout.members[member].name);
        let flow_rows = |side: Side| {
            let own = layout.loops.iter().filter(move |circuit| circuit.side == side);
            own.map(|circuit| circuit.flow_row).collect()
        };
        let supplies = |side: Side| {
            let own = layout.loops.iter().filter(move |c| c.side == side && c.exchanger.is_some());
            own.map(|circuit| circuit.supply).collect()
        };
        let (sources, always) = sources(layout, &allowed);
        Self {
            cabins: of_role(Role::Cabin).filter_map(|member| connectable(layout, member)).collect(),
            cabin_air: layout.cabins[0].air,
            battery: of_role(Role::Battery).find_map(|member| connectable(layout, member)),
            battery_node: layout.battery,
            sources,
            front_ends: of_role(Role::FrontEnd)
                .filter_map(|member| front_end(layout, member, allowed(member)))
                .collect(),
            always,
            plates: of_role(Role::Plate)
                .filter_map(|member| Some((layout.members[member].connection_row?, 1.0)))
                .collect(),
            stores: of_role(Role::Store)
                .filter(|&member| allowed(member))
                .filter_map(|member| store(layout, member))
                .collect(),
            heaters: layout.heaters.iter().map(|heater| heater.row).collect(),
            heating_valves: valves(layout, true),
            cooling_valves: valves(layout, false),
            compressor_row: layout.compressor_row,
            hot_supplies: supplies(Side::Hot),
            cold_supplies: supplies(Side::Cold),
            hot_flow_rows: flow_rows(Side::Hot),
            cold_flow_rows: flow_rows(Side::Cold),
            recirculation_rows: layout.cabins.iter().map(|cabin| cabin.recirculation_row).collect(),
            blower_rows: layout.cabins.iter().map(|cabin| cabin.blower_row).collect(),
            windscreen_rows: layout.cabins.iter().map(|cabin| cabin.windscreen_row).collect(),
            set_point_row: layout.set_point_row,
        }
    }

    /// Rows and values of the connections of everything but battery and stores: cabins on what heats or cools them, sources and
    /// front-end exchangers as the mode has it, radiators, valves of exchangers.
    #[must_use]
    pub fn connections(&self, heating: bool) -> Vec<(usize, f64)> {
        let option = |way: Option<Way>| way.map_or(ISOLATED, |way| way.option as f64);
        let mut rows = Vec::new();
        rows.extend(self.sources.iter().map(|&(row, option)| (row, if heating { option } else { ISOLATED })));
        // Air conditioning rejects its heat through the front-end exchanger.
        rows.extend(self.front_ends.iter().map(|front_end| {
            (front_end.row, option(if heating { front_end.source } else { front_end.rejects }))
        }));
        rows.extend(&self.always);
        rows.extend(
            self.cabins
                .iter()
                .map(|cabin| (cabin.row, option(if heating { cabin.heats } else { cabin.cools }))),
        );
        let valves = if heating { &self.heating_valves } else { &self.cooling_valves };
        rows.extend(valves.iter().map(|&row| (row, 1.0)));
        rows
    }

    /// Lets air conditioning reject all its heat.
    #[inline]
    pub fn unlimit_rejection(&self, demand: &mut Demand) {
        for front_end in &self.front_ends {
            demand[front_end.request_row] = MAXIMUM_REQUEST_W;
        }
    }

    /// Whether there is a heat pump that a strategy allows.
    #[must_use]
    pub fn heat_pump(&self, strategy: &Strategy) -> bool {
        strategy.heat_pump && self.compressor_row.is_some()
    }

    /// Sets all blowers to a level.
    #[inline]
    pub fn blow(&self, level: f64, demand: &mut Demand) {
        for &row in &self.blower_rows {
            demand[row] = level;
        }
    }

    /// Allows heaters to heat, or does not.
    #[inline]
    pub fn allow_heaters(&self, allowed: bool, demand: &mut Demand) {
        for &row in &self.heaters {
            demand[row] = f64::from(u8::from(allowed));
        }
    }
}

/// Rows of connections, each with the number of an option.
type Options = Vec<(usize, f64)>;

/// Members that may feed the heat pump, and those that other loops cool.
fn sources(layout: &Layout, allowed: &impl Fn(usize) -> bool) -> (Options, Options) {
    let (mut sources, mut always) = (Vec::new(), Vec::new());
    for (member, declared) in layout.members.iter().enumerate() {
        let Some(row) = declared.connection_row else { continue };
        let cooled = |chilled: bool| {
            way(layout, member, |branch| !branch.out_of_loop && tempered(layout, branch) == chilled)
        };
        match declared.kind.data().role {
            Some(Role::HeatSource) => {
                if let Some(way) = cooled(true).filter(|_| allowed(member)) {
                    sources.push((row, way.option as f64));
                } else if let Some(way) = cooled(false) {
                    always.push((row, way.option as f64));
                }
            }
            Some(Role::FrontEnd) => {
                let radiator = way(layout, member, |branch| {
                    branch.out_of_loop && layout.loops[branch.circuit].side == Side::Cold
                });
                if let Some(way) = radiator {
                    always.push((row, way.option as f64));
                }
            }
            _ => {}
        }
    }
    (sources, always)
}

fn front_end(layout: &Layout, member: usize, allowed: bool) -> Option<FrontEnd> {
    let (row, request_row) = (layout.members[member].connection_row?, layout.members[member].request_row?);
    let source = way(layout, member, |branch| !branch.out_of_loop && tempered(layout, branch));
    let rejects =
        way(layout, member, |branch| branch.out_of_loop && layout.loops[branch.circuit].side == Side::Hot);
    if source.is_none() && rejects.is_none() {
        return None;
    }
    Some(FrontEnd { row, request_row, source: source.filter(|_| allowed), rejects })
}

fn store(layout: &Layout, member: usize) -> Option<Store> {
    let row = layout.members[member].connection_row?;
    let into = |side: Side| {
        way(layout, member, |branch| {
            !branch.out_of_loop
                && matches!(branch.side, BranchSide::Mass(_))
                && layout.loops[branch.circuit].side == side
        })
    };
    Some(Store { member, row, into_hot: into(Side::Hot), into_cold: into(Side::Cold) })
}

/// Valves that are open while the cabin is heated: condensers at cabin or coolant, evaporators at ambient or coolant. The other
/// way round while it is cooled.
fn valves(layout: &Layout, heating: bool) -> Vec<usize> {
    let open = |level: Level, side: ExchangerSide| match side {
        ExchangerSide::Loop(_) => true,
        ExchangerSide::Cabin(_) => (level == Level::Condensing) == heating,
        ExchangerSide::FrontEnd(_) => (level == Level::Evaporating) == heating,
    };
    let own = layout.exchangers.iter().filter(|exchanger| open(exchanger.level, exchanger.side));
    own.filter_map(|exchanger| exchanger.valve_row).collect()
}
