//! The vehicle's thermal network: which nodes there are and what connects them.

use super::branches::{BRANCH_COUNT, Branch};
use crate::components::cabin::Ventilation;
use crate::config::vehicle::VehicleParameters;
use crate::flows::{Flow, Flows};
use crate::numerics::thermal_network::{
    LinkPorts, LinkState, MAXIMUM_LINKS, NetworkBuilder, Node, NodeValues, ThermalNetwork,
};

/// Heat capacities of the vehicle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nodes {
    /// HTC supply, after condenser, thermal battery and PTC.
    pub htc_supply: Node,
    /// HTC return, before the condenser.
    pub htc_return: Node,
    /// Chiller supply, after the evaporator.
    pub chiller_supply: Node,
    /// Chiller return, before the evaporator.
    pub chiller_return: Node,
    /// Battery.
    pub battery: Node,
    /// Motor and inverter.
    pub motor: Node,
    /// Transmission.
    pub transmission: Node,
    /// Cabin, large air volume.
    pub cabin: Node,
    /// Cabin, small exhaust volume.
    pub exhaust: Node,
    /// Soft furnishings.
    pub soft: Node,
    /// Hard furnishings.
    pub hard: Node,
    /// Thermal battery.
    pub thermal_battery: Node,
}

/// What the links depend on during a step.
#[derive(Debug, Clone, Copy)]
pub struct LinkConditions {
    /// Coolant capacity rate of the HTC [W/K].
    pub htc_rate_w_k: f64,
    /// Coolant capacity rate of the chiller loop [W/K].
    pub chiller_rate_w_k: f64,
    /// Conductance of each branch, its switch applied [W/K].
    pub branches_w_k: [f64; BRANCH_COUNT],
    /// Air flows.
    pub ventilation: Ventilation,
    /// Conductance of the exhaust recovery; 0 when it is off [W/K].
    pub recovery_w_k: f64,
    /// Whether the exhaust recovery is limited by the chiller supply rather than by ambient.
    pub recovery_meets_chiller: bool,
    /// Mean vehicle speed [m/s].
    pub speed_m_s: f64,
    /// Conductance between battery and ambient [W/K].
    pub battery_ambient_w_k: f64,
    /// Ambient temperature [K].
    pub ambient_k: f64,
}

/// Smallest temperature difference that the exhaust recovery leaves to the chiller supply [K] (assumed).
pub const RECOVERY_APPROACH_K: f64 = 1.0;

/// Assembled network with its nodes and the flow that each link carries.
#[derive(Debug, Clone)]
pub struct Assembly {
    /// Network.
    pub network: ThermalNetwork,
    /// Nodes.
    pub nodes: Nodes,
    link_flows: Vec<Flow>,
    recovery_from_chiller: usize,
}

impl Assembly {
    /// Assembles a vehicle.
    #[must_use]
    pub fn of(vehicle: &VehicleParameters) -> Self {
        let mut builder = NetworkBuilder::default();
        let nodes = Self::declare_nodes(&mut builder, vehicle);
        let mut link_flows = Vec::new();
        let mut link = |flow: Flow, ports: LinkPorts| {
            link_flows.push(flow);
            builder.link(ports)
        };
        let outside = LinkPorts::to_surroundings;
        link(Flow::HtcAdvection, LinkPorts::between(nodes.htc_supply, nodes.htc_return));
        link(Flow::ChillerAdvection, LinkPorts::between(nodes.chiller_supply, nodes.chiller_return));
        link(Flow::HtcSupplyHose, outside(nodes.htc_supply));
        link(Flow::HtcReturnHose, outside(nodes.htc_return));
        link(Flow::ChillerSupplyHose, outside(nodes.chiller_supply));
        link(Flow::ChillerReturnHose, outside(nodes.chiller_return));
        for branch in Branch::ALL {
            link(branch_flow(branch), branch_ports(branch, &nodes));
        }
        // Exhaust recovery: the exhaust enters at cabin temperature and meets whichever is warmer, ambient
        // (only heat above ambient is "exhaust heat") or the chiller supply.
        let recovery = LinkPorts {
            loses: Some(nodes.exhaust),
            gains: Some(nodes.chiller_return),
            hot: Some(nodes.cabin),
            cold: None,
        };
        link(Flow::ExhaustRecovery, recovery);
        let recovery_from_chiller =
            link(Flow::ExhaustRecovery, LinkPorts { cold: Some(nodes.chiller_supply), ..recovery });
        link(Flow::BatteryAmbient, outside(nodes.battery));
        link(Flow::MotorAmbient, outside(nodes.motor));
        link(Flow::TransmissionAmbient, outside(nodes.transmission));
        link(Flow::ThermalBatteryAmbient, outside(nodes.thermal_battery));
        link(Flow::PanelAmbient, outside(nodes.cabin));
        link(Flow::Soft, LinkPorts::between(nodes.cabin, nodes.soft));
        link(Flow::Hard, LinkPorts::between(nodes.cabin, nodes.hard));
        link(Flow::CabinExhaust, LinkPorts { gains: Some(nodes.exhaust), ..outside(nodes.cabin) });
        link(Flow::ExhaustAmbient, outside(nodes.exhaust));
        Self { network: builder.build(), nodes, link_flows, recovery_from_chiller }
    }

    fn declare_nodes(builder: &mut NetworkBuilder, vehicle: &VehicleParameters) -> Nodes {
        let half_htc_j_k = 0.5 * vehicle.htc.circuit.heat_capacity_j_k;
        let half_chiller_j_k = 0.5 * vehicle.chiller.circuit.heat_capacity_j_k;
        Nodes {
            htc_supply: builder.node(half_htc_j_k),
            htc_return: builder.node(half_htc_j_k),
            chiller_supply: builder.node(half_chiller_j_k),
            chiller_return: builder.node(half_chiller_j_k),
            battery: builder.node(vehicle.battery.heat_capacity_j_k()),
            motor: builder.node(vehicle.motor.heat_capacity_j_k),
            transmission: builder.node(vehicle.transmission.heat_capacity_j_k),
            cabin: builder.node(vehicle.cabin.air_heat_capacity_j_k),
            exhaust: builder.node(vehicle.cabin.exhaust_heat_capacity_j_k),
            soft: builder.node(vehicle.cabin.soft_heat_capacity_j_k),
            hard: builder.node(vehicle.cabin.hard_heat_capacity_j_k),
            thermal_battery: builder.node(vehicle.thermal_battery.heat_capacity_j_k),
        }
    }

    /// Link states of a step, in the order of the links.
    #[must_use]
    pub fn links(&self, vehicle: &VehicleParameters, now: &LinkConditions) -> [LinkState; MAXIMUM_LINKS] {
        let ambient = |conductance_w_k: f64| LinkState::to_fixed(conductance_w_k, now.ambient_k);
        let mut links = [LinkState::OPEN; MAXIMUM_LINKS];
        let mut next = 0;
        let mut put = |state: LinkState| {
            links[next] = state;
            next += 1;
        };
        put(LinkState::conductance(now.htc_rate_w_k));
        put(LinkState::conductance(now.chiller_rate_w_k));
        for circuit in [&vehicle.htc.circuit, &vehicle.chiller.circuit] {
            put(ambient(0.5 * circuit.hose_conductance_w_k));
            put(ambient(0.5 * circuit.hose_conductance_w_k));
        }
        for branch in Branch::ALL {
            put(branch_state(branch, now));
        }
        let (to_ambient, to_chiller) = recovery_states(now);
        put(to_ambient);
        put(to_chiller);
        put(ambient(now.battery_ambient_w_k));
        put(ambient(vehicle.motor.ambient_conductance_w_k(now.speed_m_s)));
        put(ambient(vehicle.transmission.ambient_conductance_w_k(now.speed_m_s)));
        put(ambient(vehicle.thermal_battery.ambient_conductance_w_k));
        put(ambient(vehicle.cabin.panel_conductance_w_k(now.speed_m_s)));
        put(LinkState::conductance(vehicle.cabin.soft_conductance_w_k));
        put(LinkState::conductance(vehicle.cabin.hard_conductance_w_k));
        put(ambient(now.ventilation.fresh_rate_w_k));
        put(ambient(now.ventilation.fresh_rate_w_k));
        links
    }

    /// Heat sources of the condenser [W].
    ///
    /// The thermal battery stands in series behind the condenser and sees coolant that is warmer than the
    /// return by `Q / C`; that part of its link is a fixed flow, entered here.
    #[must_use]
    pub fn condenser_sources(&self, condenser_heat_w: f64, now: &LinkConditions) -> NodeValues {
        let mut sources = NodeValues::default();
        let through = Self::thermal_battery_share(now);
        sources[self.nodes.htc_supply.index()] = condenser_heat_w * (1.0 - through);
        sources[self.nodes.thermal_battery.index()] = condenser_heat_w * through;
        sources
    }

    /// Share of the condenser heat by which the thermal battery gives less.
    fn thermal_battery_share(now: &LinkConditions) -> f64 {
        now.branches_w_k[Branch::ThermalBatteryHtc as usize] / now.htc_rate_w_k
    }

    /// Enters the heat flows of all links at the end of a step.
    pub fn record_flows(
        &self,
        links: &[LinkState; MAXIMUM_LINKS],
        now: &LinkConditions,
        temperatures_k: &NodeValues,
        flows: &mut Flows,
    ) {
        let mut values = [0.0; MAXIMUM_LINKS];
        self.network.link_flows(links, temperatures_k, &mut values);
        for (&flow, value) in self.link_flows.iter().zip(values) {
            flows[flow] = value;
        }
        flows[Flow::ThermalBatteryHtc] -= flows[Flow::Condenser] * Self::thermal_battery_share(now);
        flows[Flow::ExhaustRecovery] =
            values[self.recovery_from_chiller] + values[self.recovery_from_chiller - 1];
    }
}

/// Flow that a branch carries.
#[must_use]
pub fn branch_flow(branch: Branch) -> Flow {
    match branch {
        Branch::CabinHtc => Flow::CabinHtc,
        Branch::BatteryHtc => Flow::BatteryHtc,
        Branch::AmbientHtc => Flow::AmbientHtc,
        Branch::MotorChiller => Flow::MotorChiller,
        Branch::TransmissionChiller => Flow::TransmissionChiller,
        Branch::BatteryChiller => Flow::BatteryChiller,
        Branch::AmbientChiller => Flow::AmbientChiller,
        Branch::CabinChiller => Flow::CabinChiller,
        Branch::ThermalBatteryHtc => Flow::ThermalBatteryHtc,
        Branch::ThermalBatteryChiller => Flow::ThermalBatteryChiller,
    }
}

/// Supply temperature drives a branch, the return takes or gives the heat.
fn branch_ports(branch: Branch, nodes: &Nodes) -> LinkPorts {
    let heated = |member: Option<Node>| LinkPorts {
        loses: Some(nodes.htc_return),
        gains: member,
        hot: Some(nodes.htc_supply),
        cold: member,
    };
    let cooled = |member: Option<Node>| LinkPorts {
        loses: member,
        gains: Some(nodes.chiller_return),
        hot: member,
        cold: Some(nodes.chiller_supply),
    };
    match branch {
        Branch::CabinHtc => heated(Some(nodes.cabin)),
        Branch::BatteryHtc => heated(Some(nodes.battery)),
        Branch::AmbientHtc => heated(None),
        Branch::MotorChiller => cooled(Some(nodes.motor)),
        Branch::TransmissionChiller => cooled(Some(nodes.transmission)),
        Branch::BatteryChiller => cooled(Some(nodes.battery)),
        Branch::AmbientChiller => cooled(None),
        Branch::CabinChiller => cooled(Some(nodes.cabin)),
        Branch::ThermalBatteryHtc => LinkPorts {
            loses: Some(nodes.thermal_battery),
            gains: Some(nodes.htc_supply),
            hot: Some(nodes.thermal_battery),
            cold: Some(nodes.htc_return),
        },
        Branch::ThermalBatteryChiller => cooled(Some(nodes.thermal_battery)),
    }
}

fn branch_state(branch: Branch, now: &LinkConditions) -> LinkState {
    let conductance_w_k = now.branches_w_k[branch as usize];
    let recirculation = now.ventilation.recirculation;
    let fresh_k = (1.0 - recirculation) * now.ambient_k;
    match branch {
        // The cabin cores see a mixture of fresh and recirculated air.
        Branch::CabinHtc => {
            LinkState { conductance_w_k, hot_weight: 1.0, cold_weight: recirculation, offset_k: -fresh_k }
        }
        Branch::CabinChiller => {
            LinkState { conductance_w_k, hot_weight: recirculation, cold_weight: 1.0, offset_k: fresh_k }
        }
        Branch::AmbientHtc => LinkState::to_fixed(conductance_w_k, now.ambient_k),
        Branch::AmbientChiller => LinkState::from_fixed(conductance_w_k, now.ambient_k),
        _ => LinkState::conductance(conductance_w_k),
    }
}

fn recovery_states(now: &LinkConditions) -> (LinkState, LinkState) {
    if now.recovery_meets_chiller {
        let to_chiller =
            LinkState { offset_k: -RECOVERY_APPROACH_K, ..LinkState::conductance(now.recovery_w_k) };
        (LinkState::OPEN, to_chiller)
    } else {
        (LinkState::to_fixed(now.recovery_w_k, now.ambient_k), LinkState::OPEN)
    }
}
