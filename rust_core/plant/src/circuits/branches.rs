//! Parallel coolant branches: what may be connected, and how much heat could pass.

use crate::command::{Connection, Demand, Member};
use crate::components::cabin::Ventilation;
use crate::components::heat_exchanger::inlet_conductance_w_k;
use crate::config::coolant::{BranchShares, ClosedBranches, LoopParameters};
use crate::config::vehicle::VehicleParameters;

/// A pair of member and loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Branch {
    /// Cabin heated by the HTC.
    CabinHtc,
    /// Battery heated by the HTC.
    BatteryHtc,
    /// HTC rejecting heat to ambient.
    AmbientHtc,
    /// Motor and inverter heating the chiller loop.
    MotorChiller,
    /// Transmission heating the chiller loop.
    TransmissionChiller,
    /// Battery cooled by the chiller loop.
    BatteryChiller,
    /// Ambient heating the chiller loop.
    AmbientChiller,
    /// Cabin cooled by the chiller loop.
    CabinChiller,
    /// Thermal battery heating the HTC.
    ThermalBatteryHtc,
    /// Thermal battery heating the chiller loop.
    ThermalBatteryChiller,
}

/// Number of branches.
pub const BRANCH_COUNT: usize = 10;

impl Branch {
    /// All branches.
    pub const ALL: [Self; BRANCH_COUNT] = [
        Self::CabinHtc,
        Self::BatteryHtc,
        Self::AmbientHtc,
        Self::MotorChiller,
        Self::TransmissionChiller,
        Self::BatteryChiller,
        Self::AmbientChiller,
        Self::CabinChiller,
        Self::ThermalBatteryHtc,
        Self::ThermalBatteryChiller,
    ];

    /// Member that it connects.
    #[must_use]
    pub fn member(self) -> Member {
        match self {
            Self::CabinHtc | Self::CabinChiller => Member::Cabin,
            Self::BatteryHtc | Self::BatteryChiller => Member::Battery,
            Self::AmbientHtc | Self::AmbientChiller => Member::Ambient,
            Self::MotorChiller => Member::Motor,
            Self::TransmissionChiller => Member::Transmission,
            Self::ThermalBatteryHtc | Self::ThermalBatteryChiller => Member::ThermalBattery,
        }
    }

    /// Loop that it belongs to.
    #[must_use]
    pub fn connection(self) -> Connection {
        match self {
            Self::CabinHtc | Self::BatteryHtc | Self::AmbientHtc | Self::ThermalBatteryHtc => Connection::Htc,
            _ => Connection::Chiller,
        }
    }

    /// The branch of a member in a loop, if there is one.
    #[must_use]
    pub fn of(member: Member, connection: Connection) -> Option<Self> {
        Self::ALL.into_iter().find(|branch| branch.member() == member && branch.connection() == connection)
    }
}

/// Temperatures that decide about connections [K].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BranchTemperatures {
    /// HTC supply, after condenser, thermal battery and PTC.
    pub htc_supply_k: f64,
    /// Condenser outlet, which the thermal battery sees.
    pub condenser_outlet_k: f64,
    /// Chiller supply, after the evaporator.
    pub chiller_supply_k: f64,
    /// Battery.
    pub battery_k: f64,
    /// Motor and inverter.
    pub motor_k: f64,
    /// Transmission.
    pub transmission_k: f64,
    /// Thermal battery.
    pub thermal_battery_k: f64,
    /// Air entering the cabin cores.
    pub core_inlet_k: f64,
    /// Ambient.
    pub ambient_k: f64,
}

impl BranchTemperatures {
    /// Temperature difference that drives a branch in its right direction [K].
    #[must_use]
    pub fn difference_k(&self, branch: Branch) -> f64 {
        match branch {
            Branch::CabinHtc => self.htc_supply_k - self.core_inlet_k,
            Branch::BatteryHtc => self.htc_supply_k - self.battery_k,
            Branch::AmbientHtc => self.htc_supply_k - self.ambient_k,
            Branch::MotorChiller => self.motor_k - self.chiller_supply_k,
            Branch::TransmissionChiller => self.transmission_k - self.chiller_supply_k,
            Branch::BatteryChiller => self.battery_k - self.chiller_supply_k,
            Branch::AmbientChiller => self.ambient_k - self.chiller_supply_k,
            Branch::CabinChiller => self.core_inlet_k - self.chiller_supply_k,
            Branch::ThermalBatteryHtc => self.thermal_battery_k - self.condenser_outlet_k,
            Branch::ThermalBatteryChiller => self.thermal_battery_k - self.chiller_supply_k,
        }
    }
}

/// Whether the plant allows a connection: enough temperature difference, with hysteresis, and the frost
/// interlock of the front-end exchanger (paper sections 2.3 and 2.4).
#[must_use]
pub fn allowed(
    vehicle: &VehicleParameters,
    branch: Branch,
    temperatures: &BranchTemperatures,
    connected: bool,
) -> bool {
    let switch = &vehicle.controls.thermal_switch;
    let needed_k = if connected { switch.opening_difference_k } else { switch.closing_difference_k };
    let frost = branch == Branch::AmbientChiller
        && temperatures.ambient_k <= vehicle.ambient_exchanger.frost_interlock_degc.kelvin();
    temperatures.difference_k(branch) > needed_k && !frost
}

/// Which branches are connected, given what is asked and what was connected.
#[must_use]
pub fn grant(
    vehicle: &VehicleParameters,
    connections: &[Connection; 6],
    temperatures: &BranchTemperatures,
    connected: &[bool; BRANCH_COUNT],
) -> [bool; BRANCH_COUNT] {
    std::array::from_fn(|i| {
        let branch = Branch::ALL[i];
        connections[branch.member() as usize] == branch.connection()
            && allowed(vehicle, branch, temperatures, connected[i])
    })
}

/// Coolant capacity rates of the loops and the air flows that the branches exchange heat with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BranchFlows {
    /// HTC coolant [W/K].
    pub htc_rate_w_k: f64,
    /// Chiller coolant [W/K].
    pub chiller_rate_w_k: f64,
    /// Cabin air.
    pub ventilation: Ventilation,
    /// Mean vehicle speed [m/s].
    pub speed_m_s: f64,
}

/// Share of a branch in its loop's flow.
fn share(shares: &BranchShares, member: Member) -> f64 {
    match member {
        Member::Cabin => shares.cabin,
        Member::Battery => shares.battery,
        Member::Ambient => shares.ambient,
        Member::Motor => shares.motor,
        Member::Transmission => shares.transmission,
        Member::ThermalBattery => shares.thermal_battery,
    }
}

/// Share of a loop's flow that its open branches have together, 1 where closed branches keep theirs.
fn open_share(circuit: &LoopParameters, connection: Connection, connected: &[bool; BRANCH_COUNT]) -> f64 {
    let cooling = match connection {
        Connection::Htc => connected[Branch::AmbientHtc as usize],
        _ => connected[Branch::CabinChiller as usize],
    };
    let redistributes = match circuit.branch_shares.closed_branches {
        ClosedBranches::Bypass => false,
        ClosedBranches::Redistribute => true,
        ClosedBranches::RedistributeInCooling => cooling,
    };
    if !redistributes {
        return 1.0;
    }
    let open: f64 = Branch::ALL
        .iter()
        .zip(connected)
        .filter(|(branch, on)| **on && branch.connection() == connection)
        .map(|(branch, _)| share(&circuit.branch_shares, branch.member()))
        .sum();
    if open > 0.0 { open } else { 1.0 }
}

/// Largest conductance of each branch between its two inlet temperatures [W/K] (effectiveness-NTU).
#[must_use]
pub fn largest_conductances_w_k(
    vehicle: &VehicleParameters,
    demand: &Demand,
    flows: &BranchFlows,
    connected: &[bool; BRANCH_COUNT],
) -> [f64; BRANCH_COUNT] {
    let htc_open = open_share(&vehicle.htc.circuit, Connection::Htc, connected);
    let chiller_open = open_share(&vehicle.chiller.circuit, Connection::Chiller, connected);
    std::array::from_fn(|i| {
        if !connected[i] {
            return 0.0;
        }
        let branch = Branch::ALL[i];
        let member = branch.member();
        let (circuit, rate_w_k, open) = match branch.connection() {
            Connection::Htc => (&vehicle.htc.circuit, flows.htc_rate_w_k, htc_open),
            _ => (&vehicle.chiller.circuit, flows.chiller_rate_w_k, chiller_open),
        };
        let valve = circuit.valve_closed
            + demand.valves[member as usize] * (circuit.valve_open - circuit.valve_closed);
        // The thermal battery is in series in the HTC: it sees the whole flow.
        let flow_share = if branch == Branch::ThermalBatteryHtc {
            1.0
        } else {
            share(&circuit.branch_shares, member) / open
        };
        let coolant_w_k = rate_w_k * flow_share * valve;
        match branch {
            Branch::CabinHtc => vehicle.cabin.heater_core_conductance_w_k(coolant_w_k, &flows.ventilation),
            Branch::CabinChiller => {
                vehicle.cabin.cooling_core_conductance_w_k(coolant_w_k, &flows.ventilation)
            }
            Branch::BatteryHtc | Branch::BatteryChiller => {
                inlet_conductance_w_k(coolant_w_k, vehicle.battery.coolant_ua_w_k)
            }
            Branch::AmbientHtc => {
                inlet_conductance_w_k(coolant_w_k, vehicle.ambient_exchanger.radiator_ua_w_k(flows.speed_m_s))
            }
            Branch::AmbientChiller => {
                inlet_conductance_w_k(coolant_w_k, vehicle.ambient_exchanger.source_ua_w_k(flows.speed_m_s))
            }
            Branch::MotorChiller => inlet_conductance_w_k(coolant_w_k, vehicle.motor.coolant_ua_w_k),
            Branch::TransmissionChiller => {
                inlet_conductance_w_k(coolant_w_k, vehicle.transmission.coolant_ua_w_k)
            }
            Branch::ThermalBatteryHtc | Branch::ThermalBatteryChiller => {
                inlet_conductance_w_k(coolant_w_k, vehicle.thermal_battery.coolant_ua_w_k)
            }
        }
    })
}
