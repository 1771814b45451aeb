//! Parallel coolant branches: what may be connected, and how much heat could pass.

use crate::command::{Connection, Demand, Member};
use crate::components::cabin::Ventilation;
use crate::components::coolant_loop::{BranchShares, ClosedBranches, LoopParameters};
use crate::components::heat_exchanger::{counterflow_conductance_w_k, inlet_conductance_w_k};
use crate::config::vehicle::VehicleParameters;
use crate::numerics::elementary::fused;
use std::array::from_fn;

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

/// Places of [`BranchValues`]: branches are worked out side by side, in whole vector registers and without asking each
/// whether it is connected, which nobody could predict.
pub const BRANCH_PLACES: usize = 12;

/// One value for each branch; what stands behind them means nothing.
pub type BranchValues = [f64; BRANCH_PLACES];

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
    pub const fn member(self) -> Member {
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
    pub const fn connection(self) -> Connection {
        match self {
            Self::CabinHtc | Self::BatteryHtc | Self::AmbientHtc | Self::ThermalBatteryHtc => Connection::Htc,
            _ => Connection::Chiller,
        }
    }

    /// [`Self::member`] of each branch and whether it belongs to the HTC, looked up instead of branched on.
    const MEMBERS: [Member; BRANCH_COUNT] = Self::TABLES.0;
    const HOT: [bool; BRANCH_COUNT] = Self::TABLES.1;
    const TABLES: ([Member; BRANCH_COUNT], [bool; BRANCH_COUNT]) = {
        let mut tables = ([Member::Cabin; BRANCH_COUNT], [false; BRANCH_COUNT]);
        let mut i = 0;
        while i < BRANCH_COUNT {
            assert!(Self::ALL[i] as usize == i, "branches are listed in their order");
            tables.0[i] = Self::ALL[i].member();
            tables.1[i] = matches!(Self::ALL[i].connection(), Connection::Htc);
            i += 1;
        }
        tables
    };

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
    /// Temperature differences that drive the branches in their right direction [K].
    #[must_use]
    #[inline]
    pub fn differences_k(&self) -> BranchValues {
        [
            self.htc_supply_k - self.core_inlet_k,
            self.htc_supply_k - self.battery_k,
            self.htc_supply_k - self.ambient_k,
            self.motor_k - self.chiller_supply_k,
            self.transmission_k - self.chiller_supply_k,
            self.battery_k - self.chiller_supply_k,
            self.ambient_k - self.chiller_supply_k,
            self.core_inlet_k - self.chiller_supply_k,
            self.thermal_battery_k - self.condenser_outlet_k,
            self.thermal_battery_k - self.chiller_supply_k,
            0.0,
            0.0,
        ]
    }

    /// Temperature difference that drives a branch in its right direction [K].
    #[must_use]
    pub fn difference_k(&self, branch: Branch) -> f64 {
        self.differences_k()[branch as usize]
    }
}

/// Which branches the plant allows to be connected: enough temperature difference, with hysteresis, and the frost
/// interlock of the front-end exchanger (paper sections 2.3 and 2.4).
#[must_use]
#[inline]
pub fn allowed(
    vehicle: &VehicleParameters,
    temperatures: &BranchTemperatures,
    connected: &[bool; BRANCH_COUNT],
) -> [bool; BRANCH_COUNT] {
    let switch = &vehicle.controls.thermal_switch;
    let differences_k = temperatures.differences_k();
    let mut allowed = from_fn(|i| {
        let needed_k = if connected[i] { switch.opening_difference_k } else { switch.closing_difference_k };
        differences_k[i] > needed_k
    });
    let frost = temperatures.ambient_k <= vehicle.ambient_exchanger.frost_interlock_degc.kelvin();
    allowed[Branch::AmbientChiller as usize] &= !frost;
    allowed
}

/// Which branches are connected, given what is asked and what was connected.
#[must_use]
#[inline]
pub fn grant(
    vehicle: &VehicleParameters,
    connections: &[Connection; 6],
    temperatures: &BranchTemperatures,
    connected: &[bool; BRANCH_COUNT],
) -> [bool; BRANCH_COUNT] {
    let allowed = allowed(vehicle, temperatures, connected);
    from_fn(|i| {
        let asked = connections[Branch::MEMBERS[i] as usize];
        (asked == if Branch::HOT[i] { Connection::Htc } else { Connection::Chiller }) & allowed[i]
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

/// What conductances of branches follow from, a vehicle's parameters branch by branch.
#[derive(Debug, Clone)]
pub struct BranchTable {
    /// Share of the loop's flow.
    flow_share: BranchValues,
    /// Share of that which a closed valve lets through, and what an open one adds.
    valve_closed: BranchValues,
    valve_span: BranchValues,
    /// Coolant side of the exchanger at rest [W/K], and its rise with the vehicle's speed [W s/(K m)].
    coolant_ua_w_k: BranchValues,
    coolant_ua_per_speed_w_s_k_m: BranchValues,
    heater_core_ua_w_k: f64,
    cooling_core_ua_w_k: f64,
    /// What becomes of the flow of closed branches, HTC and chiller loop.
    closed_branches: [ClosedBranches; 2],
}

/// Branches whose exchangers have air on their other side, hence no coolant side of their own.
const CORES: [usize; 2] = [Branch::CabinHtc as usize, Branch::CabinChiller as usize];

/// Share of a member's branch in its loop's flow.
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

/// A value for each branch.
fn each(value: impl Fn(Branch) -> f64) -> BranchValues {
    from_fn(|i| Branch::ALL.get(i).map_or(0.0, |&branch| value(branch)))
}

impl BranchTable {
    /// Branches of a vehicle.
    #[must_use]
    pub fn of(vehicle: &VehicleParameters) -> Self {
        let circuit = |branch: Branch| -> &LoopParameters {
            if Branch::HOT[branch as usize] { &vehicle.htc.circuit } else { &vehicle.chiller.circuit }
        };
        let front_end = &vehicle.ambient_exchanger;
        Self {
            flow_share: each(|branch| share(&circuit(branch).branch_shares, branch.member())),
            valve_closed: each(|branch| circuit(branch).valve_closed),
            valve_span: each(|branch| circuit(branch).valve_open - circuit(branch).valve_closed),
            coolant_ua_w_k: each(|branch| match branch {
                Branch::CabinHtc | Branch::CabinChiller => 0.0,
                Branch::BatteryHtc | Branch::BatteryChiller => vehicle.battery.coolant_ua_w_k,
                Branch::AmbientHtc => front_end.radiator_ua_w_k,
                Branch::AmbientChiller => front_end.source_ua_w_k,
                Branch::MotorChiller => vehicle.motor.coolant_ua_w_k,
                Branch::TransmissionChiller => vehicle.transmission.coolant_ua_w_k,
                Branch::ThermalBatteryHtc | Branch::ThermalBatteryChiller => {
                    vehicle.thermal_battery.coolant_ua_w_k
                }
            }),
            coolant_ua_per_speed_w_s_k_m: each(|branch| match branch {
                Branch::AmbientHtc => front_end.radiator_ua_per_speed_w_s_k_m,
                Branch::AmbientChiller => front_end.source_ua_per_speed_w_s_k_m,
                _ => 0.0,
            }),
            heater_core_ua_w_k: vehicle.cabin.heater_core_ua_w_k,
            cooling_core_ua_w_k: vehicle.cabin.cooling_core_ua_w_k,
            closed_branches: [&vehicle.htc.circuit, &vehicle.chiller.circuit]
                .map(|circuit| circuit.branch_shares.closed_branches),
        }
    }

    /// Share of a loop's flow that its open branches have together, 1 where closed branches keep theirs.
    #[inline]
    fn open_share(&self, hot: bool, connected: &[bool; BRANCH_COUNT]) -> f64 {
        let cooling = if hot { Branch::AmbientHtc } else { Branch::CabinChiller };
        let redistributes = match self.closed_branches[usize::from(!hot)] {
            ClosedBranches::Bypass => false,
            ClosedBranches::Redistribute => true,
            ClosedBranches::RedistributeInCooling => connected[cooling as usize],
        };
        let counts: [f64; BRANCH_COUNT] =
            from_fn(|i| f64::from(u8::from(connected[i] & (Branch::HOT[i] == hot))));
        let open = (0..BRANCH_COUNT).fold(0.0, |sum, i| fused(counts[i], self.flow_share[i], sum));
        if redistributes & (open > 0.0) { open } else { 1.0 }
    }

    /// Largest conductance of each branch between its two inlet temperatures [W/K] (effectiveness-NTU); 0 where it is
    /// not connected.
    #[must_use]
    #[inline]
    pub fn largest_conductances_w_k(
        &self,
        demand: &Demand,
        flows: &BranchFlows,
        connected: &[bool; BRANCH_COUNT],
    ) -> BranchValues {
        let mut open = [1.0; BRANCH_PLACES];
        let mut rate_w_k = [0.0; BRANCH_PLACES];
        let mut valve = [0.0; BRANCH_PLACES];
        let (hot_open, cold_open) = (self.open_share(true, connected), self.open_share(false, connected));
        for i in 0..BRANCH_COUNT {
            (open[i], rate_w_k[i]) = if Branch::HOT[i] {
                (hot_open, flows.htc_rate_w_k)
            } else {
                (cold_open, flows.chiller_rate_w_k)
            };
            valve[i] = demand.valves[Branch::MEMBERS[i] as usize];
        }
        let mut flow_share: BranchValues = from_fn(|i| self.flow_share[i] / open[i]);
        // The thermal battery is in series in the HTC: it sees the whole flow.
        flow_share[Branch::ThermalBatteryHtc as usize] = 1.0;
        let coolant_w_k: BranchValues =
            from_fn(|i| rate_w_k[i] * flow_share[i] * (self.valve_closed[i] + valve[i] * self.valve_span[i]));
        let mut largest_w_k: BranchValues = from_fn(|i| {
            let ua_w_k = self.coolant_ua_w_k[i] + self.coolant_ua_per_speed_w_s_k_m[i] * flows.speed_m_s;
            inlet_conductance_w_k(coolant_w_k[i], ua_w_k)
        });
        let [heater, cooler] = CORES;
        // The cabin is connected to one loop at most.
        let (core, core_ua_w_k) = if connected[cooler] {
            (cooler, self.cooling_core_ua_w_k)
        } else {
            (heater, self.heater_core_ua_w_k)
        };
        largest_w_k[core] =
            counterflow_conductance_w_k(coolant_w_k[core], flows.ventilation.supply_rate_w_k, core_ua_w_k);
        for i in 0..BRANCH_COUNT {
            largest_w_k[i] = if connected[i] { largest_w_k[i] } else { 0.0 };
        }
        largest_w_k
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_branch_is_driven_by_its_member_and_its_loop() {
        let temperatures = BranchTemperatures {
            htc_supply_k: 1.0,
            condenser_outlet_k: 2.0,
            chiller_supply_k: 4.0,
            battery_k: 8.0,
            motor_k: 16.0,
            transmission_k: 32.0,
            thermal_battery_k: 64.0,
            core_inlet_k: 128.0,
            ambient_k: 256.0,
        };
        let member_k = |member: Member| match member {
            Member::Battery => temperatures.battery_k,
            Member::Motor => temperatures.motor_k,
            Member::Transmission => temperatures.transmission_k,
            Member::Ambient => temperatures.ambient_k,
            Member::ThermalBattery => temperatures.thermal_battery_k,
            Member::Cabin => temperatures.core_inlet_k,
        };
        for branch in Branch::ALL {
            let member_k = member_k(branch.member());
            let expected = match (branch, branch.connection()) {
                (Branch::ThermalBatteryHtc, _) => member_k - temperatures.condenser_outlet_k,
                (Branch::CabinChiller | Branch::AmbientChiller, _) => {
                    member_k - temperatures.chiller_supply_k
                }
                (_, Connection::Htc) => temperatures.htc_supply_k - member_k,
                _ => member_k - temperatures.chiller_supply_k,
            };
            assert_eq!(temperatures.difference_k(branch), expected, "{branch:?}");
            assert_eq!(Branch::of(branch.member(), branch.connection()), Some(branch));
        }
    }
}
