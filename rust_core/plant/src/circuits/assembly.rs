//! The vehicle's thermal network: which nodes there are and what connects them.

use super::branches::{Branch, BranchValues};
use crate::components::cabin::Ventilation;
use crate::components::exhaust_recovery::ExhaustRecovery;
use crate::components::thermal_battery;
use crate::config::vehicle::VehicleParameters;
use crate::flows::{Flow, Flows};
use crate::numerics::thermal_network::{LinkPorts, LinkState, Node, NodeValues, ThermalNetwork, Topology};

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
    pub branches_w_k: BranchValues,
    /// Air flows.
    pub ventilation: Ventilation,
    /// Exhaust recovery.
    pub recovery: ExhaustRecovery,
    /// Mean vehicle speed [m/s].
    pub speed_m_s: f64,
    /// Conductance between battery and ambient [W/K].
    pub battery_ambient_w_k: f64,
    /// Ambient temperature [K].
    pub ambient_k: f64,
}

/// The vehicle's nodes.
pub const NODES: Nodes = Nodes {
    htc_supply: Node::new(0),
    htc_return: Node::new(1),
    chiller_supply: Node::new(2),
    chiller_return: Node::new(3),
    battery: Node::new(4),
    motor: Node::new(5),
    transmission: Node::new(6),
    cabin: Node::new(7),
    exhaust: Node::new(8),
    soft: Node::new(9),
    hard: Node::new(10),
    thermal_battery: Node::new(11),
};

/// Nodes and links of the vehicle.
#[derive(Debug)]
pub struct VehicleTopology;

/// Exhaust recovery: the exhaust enters at cabin temperature and meets whichever is warmer, ambient (only heat above
/// ambient is "exhaust heat") or the chiller supply.
const RECOVERY_FROM_AMBIENT: LinkPorts = LinkPorts {
    loses: Some(NODES.exhaust),
    gains: Some(NODES.chiller_return),
    hot: Some(NODES.cabin),
    cold: None,
};

impl Topology for VehicleTopology {
    const NODES: usize = 12;

    // The order is that of `Assembly::links` and of `LINK_FLOWS`.
    const LINKS: &'static [LinkPorts] = &[
        LinkPorts::between(NODES.htc_supply, NODES.htc_return),
        LinkPorts::between(NODES.chiller_supply, NODES.chiller_return),
        LinkPorts::to_surroundings(NODES.htc_supply),
        LinkPorts::to_surroundings(NODES.htc_return),
        LinkPorts::to_surroundings(NODES.chiller_supply),
        LinkPorts::to_surroundings(NODES.chiller_return),
        branch_ports(Branch::CabinHtc),
        branch_ports(Branch::BatteryHtc),
        branch_ports(Branch::AmbientHtc),
        branch_ports(Branch::MotorChiller),
        branch_ports(Branch::TransmissionChiller),
        branch_ports(Branch::BatteryChiller),
        branch_ports(Branch::AmbientChiller),
        branch_ports(Branch::CabinChiller),
        branch_ports(Branch::ThermalBatteryHtc),
        branch_ports(Branch::ThermalBatteryChiller),
        RECOVERY_FROM_AMBIENT,
        LinkPorts { cold: Some(NODES.chiller_supply), ..RECOVERY_FROM_AMBIENT },
        LinkPorts::to_surroundings(NODES.battery),
        LinkPorts::to_surroundings(NODES.motor),
        LinkPorts::to_surroundings(NODES.transmission),
        LinkPorts::to_surroundings(NODES.thermal_battery),
        LinkPorts::to_surroundings(NODES.cabin),
        LinkPorts::between(NODES.cabin, NODES.soft),
        LinkPorts::between(NODES.cabin, NODES.hard),
        LinkPorts { gains: Some(NODES.exhaust), ..LinkPorts::to_surroundings(NODES.cabin) },
        LinkPorts::to_surroundings(NODES.exhaust),
    ];

    // The refrigerant loop asks for the supplies before the step is solved.
    const KNOWN_FIRST: &'static [Node] = &[NODES.chiller_supply, NODES.htc_supply];
}

/// Flow that each link carries.
const LINK_FLOWS: [Flow; VehicleTopology::LINKS.len()] = [
    Flow::HtcAdvection,
    Flow::ChillerAdvection,
    Flow::HtcSupplyHose,
    Flow::HtcReturnHose,
    Flow::ChillerSupplyHose,
    Flow::ChillerReturnHose,
    branch_flow(Branch::CabinHtc),
    branch_flow(Branch::BatteryHtc),
    branch_flow(Branch::AmbientHtc),
    branch_flow(Branch::MotorChiller),
    branch_flow(Branch::TransmissionChiller),
    branch_flow(Branch::BatteryChiller),
    branch_flow(Branch::AmbientChiller),
    branch_flow(Branch::CabinChiller),
    branch_flow(Branch::ThermalBatteryHtc),
    branch_flow(Branch::ThermalBatteryChiller),
    Flow::ExhaustRecovery,
    Flow::ExhaustRecovery,
    Flow::BatteryAmbient,
    Flow::MotorAmbient,
    Flow::TransmissionAmbient,
    Flow::ThermalBatteryAmbient,
    Flow::PanelAmbient,
    Flow::Soft,
    Flow::Hard,
    Flow::CabinExhaust,
    Flow::ExhaustAmbient,
];

/// Position of the first of the two recovery links.
const RECOVERY_LINK: usize = 16;

/// State of each link, in the order of [`VehicleTopology`].
pub type LinkStates = [LinkState; VehicleTopology::LINKS.len()];

/// Network of a vehicle.
#[derive(Debug, Clone)]
pub struct Assembly {
    /// Network.
    pub network: ThermalNetwork<VehicleTopology>,
    /// Nodes, the same in every vehicle.
    pub nodes: Nodes,
}

impl Assembly {
    /// Assembles a vehicle.
    #[must_use]
    pub fn of(vehicle: &VehicleParameters) -> Self {
        let half_htc_j_k = 0.5 * vehicle.htc.circuit.heat_capacity_j_k;
        let half_chiller_j_k = 0.5 * vehicle.chiller.circuit.heat_capacity_j_k;
        let mut capacities_j_k = NodeValues::default();
        for (node, capacity_j_k) in [
            (NODES.htc_supply, half_htc_j_k),
            (NODES.htc_return, half_htc_j_k),
            (NODES.chiller_supply, half_chiller_j_k),
            (NODES.chiller_return, half_chiller_j_k),
            (NODES.battery, vehicle.battery.heat_capacity_j_k()),
            (NODES.motor, vehicle.motor.heat_capacity_j_k),
            (NODES.transmission, vehicle.transmission.heat_capacity_j_k),
            (NODES.cabin, vehicle.cabin.air_heat_capacity_j_k),
            (NODES.exhaust, vehicle.cabin.exhaust_heat_capacity_j_k),
            (NODES.soft, vehicle.cabin.soft_heat_capacity_j_k),
            (NODES.hard, vehicle.cabin.hard_heat_capacity_j_k),
            (NODES.thermal_battery, vehicle.thermal_battery.heat_capacity_j_k),
        ] {
            capacities_j_k[node.index()] = capacity_j_k;
        }
        Self { network: ThermalNetwork::new(capacities_j_k), nodes: NODES }
    }

    /// Link states of a step, in the order of [`VehicleTopology`].
    #[must_use]
    #[inline]
    pub fn links(&self, vehicle: &VehicleParameters, now: &LinkConditions) -> LinkStates {
        let ambient = |conductance_w_k: f64| LinkState::to_fixed(conductance_w_k, now.ambient_k);
        let branch = |branch: Branch| branch_state(branch, now);
        let half_hose = [&vehicle.htc.circuit, &vehicle.chiller.circuit]
            .map(|circuit| ambient(circuit.half_hose_conductance_w_k()));
        let (recovery_from_ambient, recovery_from_chiller) = now.recovery.links(now.ambient_k);
        [
            LinkState::conductance(now.htc_rate_w_k),
            LinkState::conductance(now.chiller_rate_w_k),
            half_hose[0],
            half_hose[0],
            half_hose[1],
            half_hose[1],
            branch(Branch::CabinHtc),
            branch(Branch::BatteryHtc),
            branch(Branch::AmbientHtc),
            branch(Branch::MotorChiller),
            branch(Branch::TransmissionChiller),
            branch(Branch::BatteryChiller),
            branch(Branch::AmbientChiller),
            branch(Branch::CabinChiller),
            branch(Branch::ThermalBatteryHtc),
            branch(Branch::ThermalBatteryChiller),
            recovery_from_ambient,
            recovery_from_chiller,
            ambient(now.battery_ambient_w_k),
            ambient(vehicle.motor.ambient_conductance_w_k(now.speed_m_s)),
            ambient(vehicle.transmission.ambient_conductance_w_k(now.speed_m_s)),
            ambient(vehicle.thermal_battery.ambient_conductance_w_k),
            ambient(vehicle.cabin.panel_conductance_w_k(now.speed_m_s)),
            LinkState::conductance(vehicle.cabin.soft_conductance_w_k),
            LinkState::conductance(vehicle.cabin.hard_conductance_w_k),
            ambient(now.ventilation.fresh_rate_w_k),
            ambient(now.ventilation.fresh_rate_w_k),
        ]
    }

    /// Heat sources of the condenser [W].
    ///
    /// The thermal battery stands in series behind the condenser and sees coolant that is warmer than the
    /// return by `Q / C`; that part of its link is a fixed flow, entered here.
    #[must_use]
    pub fn condenser_sources(&self, condenser_heat_w: f64, now: &LinkConditions) -> NodeValues {
        let mut sources = NodeValues::default();
        let through = Self::thermal_battery_share(now);
        sources[NODES.htc_supply.index()] = condenser_heat_w * (1.0 - through);
        sources[NODES.thermal_battery.index()] = condenser_heat_w * through;
        sources
    }

    /// Share of the condenser heat by which the thermal battery gives less.
    fn thermal_battery_share(now: &LinkConditions) -> f64 {
        thermal_battery::condenser_share(
            now.branches_w_k[Branch::ThermalBatteryHtc as usize],
            now.htc_rate_w_k,
        )
    }

    /// Enters the heat flows of all links at the end of a step.
    pub fn record_flows(
        &self,
        links: &LinkStates,
        now: &LinkConditions,
        temperatures_k: &NodeValues,
        flows: &mut Flows,
    ) {
        let values = self.network.link_flows(links, temperatures_k);
        for (&flow, value) in LINK_FLOWS.iter().zip(values) {
            flows[flow] = value;
        }
        flows[Flow::ThermalBatteryHtc] -= flows[Flow::Condenser] * Self::thermal_battery_share(now);
        flows[Flow::ExhaustRecovery] = values[RECOVERY_LINK] + values[RECOVERY_LINK + 1];
    }
}

/// Flow that a branch carries.
#[must_use]
pub const fn branch_flow(branch: Branch) -> Flow {
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
const fn branch_ports(branch: Branch) -> LinkPorts {
    match branch {
        Branch::CabinHtc => heated(Some(NODES.cabin)),
        Branch::BatteryHtc => heated(Some(NODES.battery)),
        Branch::AmbientHtc => heated(None),
        Branch::MotorChiller => cooled(Some(NODES.motor)),
        Branch::TransmissionChiller => cooled(Some(NODES.transmission)),
        Branch::BatteryChiller => cooled(Some(NODES.battery)),
        Branch::AmbientChiller => cooled(None),
        Branch::CabinChiller => cooled(Some(NODES.cabin)),
        Branch::ThermalBatteryHtc => LinkPorts {
            loses: Some(NODES.thermal_battery),
            gains: Some(NODES.htc_supply),
            hot: Some(NODES.thermal_battery),
            cold: Some(NODES.htc_return),
        },
        Branch::ThermalBatteryChiller => cooled(Some(NODES.thermal_battery)),
    }
}

const fn heated(member: Option<Node>) -> LinkPorts {
    LinkPorts { loses: Some(NODES.htc_return), gains: member, hot: Some(NODES.htc_supply), cold: member }
}

const fn cooled(member: Option<Node>) -> LinkPorts {
    LinkPorts {
        loses: member,
        gains: Some(NODES.chiller_return),
        hot: member,
        cold: Some(NODES.chiller_supply),
    }
}

#[inline(always)]
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
