//! What can be seen of a vehicle: name, unit, bounds, meaning, reader, a row each, made from its architecture's layout.
//!
//! Trajectories, reports and observations are derived from these rows.

use crate::architecture::declaration::Level;
use crate::architecture::kind::Bounds;
use crate::architecture::layout::{ExchangerLayout, ExchangerSide, Layout};
use crate::architecture::ranks as rank;
use crate::components::equivalent_temperature::{air_speed_m_s, equivalent_temperature_degc};
use crate::config::ZERO_CELSIUS_K;
use crate::flows::Flow;
use crate::media::moist_air::relative_humidity;
use crate::numerics::thermal_network::Node;
use crate::plant::{Plant, StepRecord};
use crate::state::State;
use crate::surroundings::Disturbance;

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
    /// Temperature of the cabin that counts for comfort [K].
    fn cabin_k(&self) -> f64 {
        self.state.temperatures_k[self.plant.layout().cabins[0].air.index()]
    }

    fn recorded(&self, read: impl Fn(&StepRecord) -> f64) -> f64 {
        self.record.map_or(0.0, read)
    }
}

/// A quantity that can be seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Name with its unit; a trajectory column.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// Meaning.
    pub description: String,
    /// Values that an observation shows as -1 and 1.
    pub bounds: (f64, f64),
    /// Whether agents see it unless they say otherwise, and before which others.
    pub default: Option<u8>,
    /// Where it is read.
    pub reader: Reader,
}

/// Where a signal is read.
#[derive(Debug, Clone, Copy)]
pub enum Reader {
    /// A function of all that can be seen.
    Function(fn(&View<'_>) -> f64),
    /// Temperature of a node [degC].
    Temperature(Node),
    /// A flow [W].
    Flow(Flow),
    /// Number of the option that a member is connected by.
    Connection(u8),
    /// Coolant flow of a loop [kg/s].
    LoopFlow(u8),
    /// Frost on a front-end exchanger [kg].
    Frost(u8),
}

/// Functions are the same if their signals have the same name.
impl PartialEq for Reader {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Function(_), Self::Function(_)) => true,
            (Self::Temperature(a), Self::Temperature(b)) => a == b,
            (Self::Flow(a), Self::Flow(b)) => a == b,
            (Self::Connection(a), Self::Connection(b))
            | (Self::LoopFlow(a), Self::LoopFlow(b))
            | (Self::Frost(a), Self::Frost(b)) => a == b,
            _ => false,
        }
    }
}

impl Reader {
    /// Value at a view.
    #[must_use]
    #[inline]
    pub fn read(self, view: &View<'_>) -> f64 {
        match self {
            Self::Function(read) => read(view),
            Self::Temperature(node) => view.state.temperatures_k[node.index()] - ZERO_CELSIUS_K,
            Self::Flow(flow) => view.recorded(|record| record.flows[flow]),
            Self::Connection(member) => connection(view.plant.layout(), view.state, usize::from(member)),
            Self::Frost(front_end) => view.state.frosts[usize::from(front_end)].mass_kg,
            Self::LoopFlow(circuit) => view.state.pumps[usize::from(circuit)].flow_kg_s,
        }
    }
}

/// Number of the loop that a member is connected to, counted from 1; 0 is none.
fn connection(layout: &Layout, state: &State, member: usize) -> f64 {
    let connected = layout.members[member].options.iter().find(|&&branch| state.connected[branch]);
    connected.map_or(0.0, |&branch| (layout.branches[branch].circuit + 1) as f64)
}

/// Useful heat over compressor power: that of the evaporator while a cabin is cooled, that of the condenser otherwise; 0 at rest.
fn coefficient_of_performance(view: &View<'_>, record: &StepRecord) -> f64 {
    let layout = view.plant.layout();
    let by_coolant =
        || layout.cabins.iter().filter_map(|cabin| cabin.cooler).any(|b| view.state.connected[b]);
    let by_refrigerant = || {
        let cold =
            |e: &&ExchangerLayout| e.level == Level::Evaporating && matches!(e.side, ExchangerSide::Cabin(_));
        layout.exchangers.iter().filter(cold).any(|exchanger| record.flows[exchanger.flow] > 0.0)
    };
    let useful = if by_coolant() || by_refrigerant() { Flow::EVAPORATOR } else { Flow::CONDENSER };
    let power_w = record.flows[Flow::COMPRESSOR];
    if power_w > 0.0 { record.flows[useful] / power_w } else { 0.0 }
}

/// What a row's bounds are where nothing else is said, by unit.
fn bounds_of_unit(unit: &str) -> (f64, f64) {
    match unit {
        "degC" => (-60.0, 140.0),
        "W" => (-50_000.0, 50_000.0),
        "A" => (-500.0, 500.0),
        "bar" => (0.0, 32.0),
        "kg/s" => (0.0, 0.5),
        _ => (0.0, 10.0),
    }
}

/// All signals of a vehicle.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SignalTable {
    rows: Vec<Signal>,
}

/// Adds a row with what is usual for its unit.
fn plain(
    name: impl Into<String>,
    unit: &'static str,
    description: impl Into<String>,
    reader: Reader,
) -> Signal {
    let bounds = bounds_of_unit(unit);
    Signal { name: name.into(), unit, description: description.into(), bounds, default: None, reader }
}

fn function(
    name: &'static str,
    unit: &'static str,
    description: &'static str,
    read: fn(&View<'_>) -> f64,
) -> Signal {
    plain(name, unit, description, Reader::Function(read))
}

impl Signal {
    fn within(mut self, low: f64, high: f64) -> Self {
        self.bounds = (low, high);
        self
    }

    fn seen(mut self, rank: u8) -> Self {
        self.default = Some(rank);
        self
    }
}

impl SignalTable {
    /// The signals of a layout, in column order.
    #[must_use]
    pub fn of(layout: &Layout) -> Self {
        let mut table = Self::default();
        table.add_motion();
        table.add_temperatures(layout);
        table.add_battery();
        table.add_loops(layout);
        if layout.refrigerates() {
            table.add_refrigeration();
            table.add_refrigerant_solve();
        }
        table.add_cabin_air();
        table.add_checks();
        table.add_connections(layout);
        table.add_frost(layout);
        table.add_flows(layout);
        table
    }

    /// Rows in column order.
    #[must_use]
    pub fn rows(&self) -> &[Signal] {
        &self.rows
    }

    /// The signal of a name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&Signal> {
        self.rows.iter().find(|signal| signal.name == name)
    }

    fn add_motion(&mut self) {
        let speed =
            |v: &View<'_>| v.record.map_or(v.disturbance.start_speed_m_s, |record| record.end_speed_m_s);
        self.rows.extend([
            function("time_s", "s", "time since the start", |v| v.state.time_s)
                .within(0.0, 7200.0)
                .seen(rank::TIME),
            function("speed_m_s", "m/s", "vehicle speed at the end of the step", speed)
                .within(0.0, 50.0)
                .seen(rank::SPEED),
            function("ambient_temperature_degc", "degC", "ambient air", |v| {
                v.disturbance.air.temperature_k - ZERO_CELSIUS_K
            })
            .within(-40.0, 50.0)
            .seen(rank::AMBIENT),
            function("grade_pct", "%", "rise of the road over its horizontal length", |v| {
                100.0 * v.disturbance.grade
            })
            .within(-20.0, 20.0),
            function("headwind_m_s", "m/s", "wind against the vehicle", |v| v.disturbance.headwind_m_s)
                .within(-20.0, 20.0),
        ]);
    }

    /// Cabins, powertrain, stores, loops.
    fn add_temperatures(&mut self, layout: &Layout) {
        let row = |node: Node, bounds: Option<Bounds>| {
            let named = &layout.nodes[node.index()];
            let name = format!("{}_temperature_degc", named.stem);
            let signal = plain(name, "degC", named.description.clone(), Reader::Temperature(node));
            match bounds {
                Some(Bounds { low, high, rank }) => signal.within(low, high).seen(rank),
                None => signal,
            }
        };
        for cabin in &layout.cabins {
            let kind = layout.members[cabin.member].kind.data();
            self.rows.push(row(cabin.air, Some(kind.temperature)));
            self.rows.extend([cabin.exhaust, cabin.soft, cabin.hard].map(|node| row(node, None)));
        }
        for mass in &layout.masses {
            let kind = layout.members[mass.member].kind.data();
            self.rows.push(row(mass.node, Some(kind.temperature)));
        }
        for circuit in &layout.loops {
            let hot = circuit.side == crate::architecture::declaration::Side::Hot;
            let bounds = Bounds::new(-40.0, if hot { 100.0 } else { 60.0 }, rank::LOOP);
            self.rows.extend([circuit.supply, circuit.back].map(|node| row(node, Some(bounds))));
        }
    }

    fn add_battery(&mut self) {
        let usable = |v: &View<'_>| {
            let battery_k = v.state.temperatures_k[v.plant.layout().battery.index()];
            v.plant.battery.usable_state_of_charge(&v.state.battery, battery_k)
        };
        self.rows.extend([
            function(
                "soc",
                "-",
                "state of charge of equation (6), against the capacity usable at the present temperature",
                usable,
            )
            .within(0.0, 1.0)
            .seen(rank::CHARGE),
            function("charge_soc", "-", "state of charge by charge alone", |v| {
                v.plant.battery.charge_left(&v.state.battery)
            })
            .within(0.0, 1.0),
            function(
                "battery_voltage_v",
                "V",
                "mean terminal voltage; without a current before the first step",
                |v| {
                    let at_rest = || v.plant.battery.open_circuit_voltage_v(&v.state.battery);
                    v.record.map_or_else(at_rest, |r| r.battery_voltage_v)
                },
            )
            .within(250.0, 500.0),
            function("battery_current_a", "A", "mean pack current, positive while discharging", |v| {
                v.recorded(|r| r.battery_current_a)
            }),
            function("battery_charge_limit_w", "W", "largest charging power", |v| {
                v.recorded(|r| r.power_limits.charge_w)
            })
            .within(0.0, 150_000.0)
            .seen(rank::CHARGE_LIMIT),
            function("battery_discharge_limit_w", "W", "largest discharging power", |v| {
                v.recorded(|r| r.power_limits.discharge_w)
            })
            .within(0.0, 250_000.0)
            .seen(rank::DISCHARGE_LIMIT),
            function("auxiliary_power_w", "W", "12 V load, pumps, blower and fan", |v| {
                v.recorded(|r| r.flows.sum_w(&v.plant.layout().base_loads))
            })
            .within(0.0, 2000.0)
            .seen(rank::AUXILIARY),
        ]);
    }

    fn add_loops(&mut self, layout: &Layout) {
        for (place, circuit) in layout.loops.iter().enumerate() {
            let (name, text) =
                (format!("{}_flow_kg_s", circuit.name), format!("{} coolant flow", circuit.label));
            let signal = plain(name, "kg/s", text, Reader::LoopFlow(place as u8));
            self.rows.push(signal.within(0.0, 0.5).seen(rank::LOOP_FLOW));
        }
    }

    fn add_refrigeration(&mut self) {
        self.rows.extend([
            function("compressor_demand_w", "W", "compressor power asked for", |v| {
                v.recorded(|r| r.demanded_w)
            }),
            function("compressor_speed_rev_s", "rev/s", "compressor speed", |v| {
                v.recorded(|r| r.refrigeration.speed_rev_s)
            })
            .within(0.0, 150.0)
            .seen(rank::COMPRESSOR_SPEED),
            function("compressor_starts", "-", "compressor starts so far", |v| {
                f64::from(v.state.refrigeration.compressor.starts)
            })
            .within(0.0, 100.0),
            function("protection_trips", "-", "compressor stops forced by a limit so far", |v| {
                f64::from(v.state.refrigeration.compressor.protection_trips)
            })
            .within(0.0, 100.0),
            function("condensing_pressure_bar", "bar", "condensing pressure", |v| {
                v.recorded(|r| r.refrigeration.condensing_pressure_pa * 1e-5)
            })
            .seen(rank::CONDENSING),
            function("evaporating_pressure_bar", "bar", "evaporating pressure", |v| {
                v.recorded(|r| r.refrigeration.evaporating_pressure_pa * 1e-5)
            })
            .within(0.0, 16.0)
            .seen(rank::EVAPORATING),
            function("condensing_temperature_degc", "degC", "condensing temperature", |v| {
                v.recorded(|r| r.refrigeration.condensing_temperature_k - ZERO_CELSIUS_K)
            }),
            function("evaporating_temperature_degc", "degC", "evaporating temperature", |v| {
                v.recorded(|r| r.refrigeration.evaporating_temperature_k - ZERO_CELSIUS_K)
            }),
            function("discharge_temperature_degc", "degC", "gas at the compressor outlet", |v| {
                v.recorded(|r| r.refrigeration.discharge_temperature_k - ZERO_CELSIUS_K)
            })
            .within(-40.0, 160.0)
            .seen(rank::DISCHARGE),
            function("refrigerant_flow_kg_s", "kg/s", "refrigerant mass flow", |v| {
                v.recorded(|r| r.refrigeration.mass_flow_kg_s)
            })
            .within(0.0, 0.1),
        ]);
    }

    /// How the refrigerant solve went, and what came of it.
    fn add_refrigerant_solve(&mut self) {
        self.rows.extend([
            function(
                "refrigeration_status",
                "-",
                "how the refrigerant solve ended, position in its list of statuses",
                |v| v.recorded(|r| f64::from(r.refrigeration.status as u8)),
            ),
            function(
                "solver_residual",
                "-",
                "largest error that the refrigerant solve left: balances in K, the limit that holds in 1 % of its range",
                |v| v.recorded(|r| r.refrigeration.residual),
            )
            .within(0.0, 1e-6),
            function("solver_bracketed", "-", "1 where the refrigerant solve was by bracketing, not by Newton", |v| {
                v.recorded(|r| f64::from(u8::from(r.refrigeration.bracketed)))
            })
            .within(0.0, 1.0),
            function(
                "cop",
                "-",
                "condenser heat flow over compressor power, evaporator heat flow while a cabin is cooled; 0 at rest",
                |v| v.recorded(|r| coefficient_of_performance(v, r)),
            ),
        ]);
    }

    /// Air of the cabin that counts for comfort.
    fn add_cabin_air(&mut self) {
        self.rows.extend([
            function("ambient_humidity_ratio", "kg/kg", "water in a kilogram of dry ambient air", |v| {
                v.disturbance.ambient_humidity_ratio
            })
            .within(0.0, 0.04)
            .seen(rank::CABIN_AIR),
            function("cabin_humidity_ratio", "kg/kg", "water in a kilogram of dry cabin air", |v| {
                v.state.cabin_air[0].humidity_ratio
            })
            .within(0.0, 0.04)
            .seen(rank::CABIN_AIR),
            function(
                "cabin_relative_humidity",
                "-",
                "relative humidity of the cabin air, against ice below 0 degC",
                |v| relative_humidity(v.state.cabin_air[0].humidity_ratio, v.cabin_k()),
            )
            .within(0.0, 1.0),
            function("cabin_co2_ppm", "ppm", "carbon dioxide in the cabin air", |v| {
                v.state.cabin_air[0].co2 * 1e6
            })
            .within(400.0, 5000.0)
            .seen(rank::CABIN_AIR),
            function("windscreen_temperature_degc", "degC", "inner surface of the windscreen", |v| {
                v.state.cabin_air[0].windscreen_k - ZERO_CELSIUS_K
            }),
            function(
                "windscreen_fog_margin_k",
                "K",
                "inner surface of the windscreen less dew point of the cabin air; fog below 0",
                |v| v.state.cabin_air[0].fog_margin_k(),
            )
            .within(-40.0, 60.0)
            .seen(rank::CABIN_AIR),
            function("windscreen_water_kg", "kg", "water on the inner surface of the windscreen", |v| {
                v.state.cabin_air[0].film_kg
            })
            .within(0.0, 0.1),
            function(
                "cabin_equivalent_temperature_degc",
                "degC",
                "uniform room with still air that takes as much heat from the occupants (ISO 14505-2)",
                |v| {
                    let cabin = &v.plant.layout().cabins[0];
                    let degc = |node: Node| v.state.temperatures_k[node.index()] - ZERO_CELSIUS_K;
                    let speed_m_s = air_speed_m_s(v.recorded(|record| record.supply_air_kg_s));
                    let radiant_degc = 0.5 * (degc(cabin.soft) + degc(cabin.hard));
                    equivalent_temperature_degc(degc(cabin.air), radiant_degc, speed_m_s)
                },
            ),
            function("supply_air_flow_kg_s", "kg/s", "air that the blower of the cabin moves", |v| {
                v.recorded(|record| record.supply_air_kg_s)
            })
            .within(0.0, 0.2),
        ]);
        self.add_water_flows();
    }

    fn add_water_flows(&mut self) {
        let water = |name, description, read: fn(&View<'_>) -> f64| {
            function(name, "kg/s", description, read).within(-0.005, 0.005)
        };
        self.rows.extend([
            water("fresh_air_water_flow_kg_s", "water that comes in with fresh air", |v| {
                v.recorded(|r| r.water[0].fresh_kg_s)
            }),
            water("occupant_water_flow_kg_s", "water that the occupants give off", |v| {
                v.recorded(|r| r.water[0].occupants_kg_s)
            }),
            water("exhaust_water_flow_kg_s", "water that leaves with the exhaust", |v| {
                v.recorded(|r| r.water[0].exhaust_kg_s)
            }),
            water("cooling_core_water_flow_kg_s", "water that condenses on the cooling core", |v| {
                v.recorded(|r| r.water[0].core_kg_s)
            }),
            water("windscreen_water_flow_kg_s", "water that condenses on the windscreen", |v| {
                v.recorded(|r| r.water[0].windscreen_kg_s)
            }),
            function("water_residual_kg_s", "kg/s", "residual of the ledger of water", |v| {
                v.recorded(|r| r.water_ledger.residual_kg_s)
            }),
        ]);
    }

    fn add_checks(&mut self) {
        self.rows.extend([
            function(
                "loads_shed",
                "-",
                "1 while thermal loads are cut because the battery cannot feed them",
                |v| v.recorded(|r| f64::from(u8::from(r.loads_shed))),
            )
            .within(0.0, 1.0),
            function("energy_residual_w", "W", "residual of the energy ledger", |v| {
                v.recorded(|r| r.ledger.residual_w)
            }),
            function("energy_scale_w", "W", "power in play that the residual is compared with", |v| {
                v.recorded(|r| r.ledger.scale_w)
            }),
        ]);
    }

    fn add_connections(&mut self, layout: &Layout) {
        let loops = layout.loops.iter().enumerate();
        let loops =
            loops.map(|(place, circuit)| format!("{} {}", place + 1, circuit.label)).collect::<Vec<_>>();
        let text = format!("loop that it is connected to: 0 none, {}", loops.join(", "));
        for (place, member) in
            layout.members.iter().enumerate().filter(|(_, member)| !member.options.is_empty())
        {
            let name = format!("{}_connection", member.name);
            self.rows.push(plain(name, "-", text.clone(), Reader::Connection(place as u8)));
        }
    }

    fn add_frost(&mut self, layout: &Layout) {
        for (place, front_end) in layout.front_ends.iter().enumerate() {
            let member = &layout.members[front_end.member];
            let name = format!("{}_frost_kg", member.name);
            let text = format!("frost on the {}", member.label);
            self.rows.push(plain(name, "kg", text, Reader::Frost(place as u8)).within(0.0, 2.0));
        }
    }

    fn add_flows(&mut self, layout: &Layout) {
        for row in &layout.flows {
            let signal = plain(row.column.clone(), "W", row.description.clone(), Reader::Flow(row.flow));
            self.rows.push(match seen_flow(layout, row.flow) {
                Some(Bounds { low, high, rank }) => signal.within(low, high).seen(rank),
                None => signal,
            });
        }
    }
}

/// Bounds and rank of a flow that agents see by default.
fn seen_flow(layout: &Layout, flow: Flow) -> Option<Bounds> {
    let fixed = match flow {
        Flow::TRACTION => Some(Bounds::new(-200_000.0, 200_000.0, rank::TRACTION)),
        Flow::BATTERY => Some(Bounds::new(-200_000.0, 200_000.0, rank::BATTERY_POWER)),
        Flow::COMPRESSOR => Some(Bounds::new(0.0, 8000.0, rank::COMPRESSOR_POWER)),
        Flow::CONDENSER => Some(Bounds::new(0.0, 20_000.0, rank::CONDENSER)),
        Flow::EVAPORATOR => Some(Bounds::new(0.0, 20_000.0, rank::EVAPORATOR)),
        _ => None,
    };
    if fixed.is_some() {
        return fixed;
    }
    if layout.heaters.iter().any(|heater| heater.flow == flow) {
        return Some(Bounds::new(0.0, 8000.0, rank::HEATER_POWER));
    }
    if layout.exchangers.iter().any(|exchanger| exchanger.flow == flow) {
        return Some(Bounds::new(0.0, 20_000.0, rank::EXCHANGER));
    }
    let branch = layout.branches.iter().find(|branch| branch.flow == flow)?;
    layout.members[branch.member].kind.data().branch_heat_flow
}
