//! The rule-based heat pump control unit (paper section 2.4, Figure 11).
//!
//! Three purposes: constant coolant flow demands, connections of the components, compressor demand. It reads
//! the plant's temperatures as a real one does and has no way to the plant but its [`Demand`].

use super::options::Options;
use super::rule_based::{CabinMode, Comfort, ConstantSettings, Presets, RuleBased, constant_settings_of};
use crate::roles::{Connectable, Roles, Store, Way};
use crate::settings::DriverSettings;
use crate::strategy::{BatteryTreatment, ClimateControl, Strategy};
use hp_plant::architecture::layout::Layout;
use hp_plant::command::{Demand, ISOLATED};
use hp_plant::components::pid::{PidParameters, ResetGains, ResetPid};
use hp_plant::config::Celsius;
use hp_plant::numerics::thermal_network::Node;
use hp_plant::parameters;
use hp_plant::plant::{CONTROL_PERIOD_S, Plant};
use hp_plant::state::State;
use serde::{Deserialize, Serialize};

parameters! {
    /// HPCU of paper section 2.4.
    pub struct HpcuParameters {
        /// Cabin target (paper: 22 degC) [degC].
        cabin_set_point_degc: Celsius = 10.0 .. 30.0,
        /// Up to the cabin target the whole heat flow is requested; this far beyond it, none [K].
        cabin_request_band_k: f64 = 0.1 .. 10.0,
        /// Deviation from the cabin target that switches between heating and air conditioning [K] (ours).
        mode_switch_deviation_k: f64 = 0.5 .. 10.0,
        /// HTC target of the compressor control (paper: 90 degC) [degC].
        htc_set_point_degc: Celsius = 25.0 .. 95.0,
        /// Chiller target of the compressor control (paper: -10 degC) [degC].
        chiller_set_point_degc: Celsius = -40.0 .. 20.0,
        /// Chiller target while the cabin is cooled [degC] (ours).
        cooling_chiller_set_point_degc: Celsius = -10.0 .. 20.0,
        /// Constant flow demand for the HTC [kg/s].
        htc_flow_kg_s: f64 = 0.001 .. 5.0,
        /// Constant flow demand for the chiller circuit [kg/s].
        chiller_flow_kg_s: f64 = 0.001 .. 5.0,
        /// Constant blower level [-].
        blower_level: f64 = 0.0 .. 1.0,
        /// Blower level while cooling [-].
        cooling_blower_level: f64 = 0.0 .. 1.0,
        /// Recirculated share while heating [-] (paper: ambient air only, 0).
        heating_recirculation: f64 = 0.0 .. 0.95,
        /// Recirculated share while cooling [-] (ours).
        cooling_recirculation: f64 = 0.0 .. 0.95,
        /// The PTC may help while the cabin is at least this far below its target [K] (paper: always).
        ptc_from_deviation_k: f64 = -100.0 .. 100.0,
        ;
        /// Thresholds of the battery's connection.
        battery: BatteryThresholds,
        /// Compressor power against cabin temperature, W per K.
        cabin_pid: PidParameters,
        /// Compressor power against battery temperature, W per K.
        battery_pid: PidParameters,
        /// Compressor power against HTC supply, W per K.
        htc_pid: PidParameters,
        /// Compressor power against chiller supply, W per K.
        chiller_pid: PidParameters,
        /// What today's cars have beyond the paper's rules (ours); nothing where the file has no such table.
        #[serde(default)]
        options: Options,
    }
}

parameters! {
    /// Battery thresholds of the HPCU.
    pub struct BatteryThresholds {
        /// The battery is heated up to here (paper: 20 degC) [degC].
        heat_up_to_degc: Celsius = -20.0 .. 50.0,
        /// Heating starts again this far below [K].
        heating_hysteresis_k: f64 = 0.0 .. 10.0,
        /// The battery is cooled above here (paper: 30 degC) [degC].
        cool_above_degc: Celsius = 0.0 .. 60.0,
        /// Cooling ends this far below [K].
        cooling_hysteresis_k: f64 = 0.0 .. 10.0,
        /// Used as a heat source, the battery is cooled down to here (paper section 2.6: 0 degC) [degC].
        source_down_to_degc: Celsius = -40.0 .. 40.0,
        /// Above that by this much, the whole heat is requested; below it fades to none [K].
        source_request_band_k: f64 = 0.1 .. 10.0,
    }
}

/// Stage of a store (the paper's thermal battery): each is left once and never entered again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum StoreStage {
    /// Helps to warm a hot loop.
    HeatingHotLoop,
    /// Emptied into a cold loop.
    Emptying,
    /// Isolated.
    Empty,
}

/// Stores that the HPCU can look after.
const STORE_PLACES: usize = 4;

/// Memory of the HPCU.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HpcuMemory {
    /// Heating or cooling.
    pub cabin_mode: CabinMode,
    /// The battery is being heated.
    pub heats_battery: bool,
    /// The battery is being cooled.
    pub cools_battery: bool,
    /// Stores, in the order of the roles.
    pub stores: [StoreStage; STORE_PLACES],
    /// Compressor power demanded last [W].
    demanded_w: f64,
    cabin_pid: ResetPid,
    battery_pid: ResetPid,
    htc_pid: ResetPid,
    chiller_pid: ResetPid,
}

/// Share of the largest compressor power up to which demands integrate while the compressor rests.
///
/// Below its lowest speed the compressor takes nothing. Without this the PIDs, reset to the applied power,
/// would forget their demand and never start it again; without a bound they would wind up.
const RESTART_SHARE: f64 = 0.25;

/// HPCU with its parameters and what it may use.
#[derive(Debug, Clone, PartialEq)]
pub struct Hpcu {
    /// Set points, thresholds, gains.
    pub parameters: HpcuParameters,
    /// Sources, battery treatment, PTC.
    pub strategy: Strategy,
    roles: Roles,
    presets: Presets,
    gains: PowerGains,
    /// How far below the cabin target the PTC's controller aims [K].
    heater_offset_k: f64,
}

/// Gains of the four PIDs of the compressor power.
#[derive(Debug, Clone, PartialEq)]
struct PowerGains {
    cabin: ResetGains,
    battery: ResetGains,
    htc: ResetGains,
    chiller: ResetGains,
}

constant_settings_of!(HpcuParameters);

impl RuleBased for Hpcu {
    type Parameters = HpcuParameters;
    type Memory = HpcuMemory;

    fn new(parameters: HpcuParameters, strategy: Strategy, layout: &Layout) -> Self {
        let gains = |pid: &PidParameters| ResetGains::new(pid, CONTROL_PERIOD_S);
        let gains = PowerGains {
            cabin: gains(&parameters.cabin_pid),
            battery: gains(&parameters.battery_pid),
            htc: gains(&parameters.htc_pid),
            chiller: gains(&parameters.chiller_pid),
        };
        let roles = Roles::of(layout, &strategy);
        let heater_offset_k = parameters.options.heater_offset_k(roles.heat_pump(&strategy));
        let mut settings = ConstantSettings::from(&parameters);
        settings.cabin_set_point_degc.0 -= heater_offset_k;
        let presets = Presets::of(&roles, &settings);
        Self { roles, presets, parameters, strategy, gains, heater_offset_k }
    }

    fn roles(&self) -> &Roles {
        &self.roles
    }

    fn constant_settings(&self) -> ConstantSettings {
        ConstantSettings::from(&self.parameters)
    }

    fn awake(&self, _: &Plant, state: &State, settings: &DriverSettings) -> HpcuMemory {
        let comfort = self.comfort(state, settings);
        let warm = comfort.cabin_k > comfort.target_k;
        HpcuMemory {
            cabin_mode: if warm { CabinMode::Cooling } else { CabinMode::Heating },
            heats_battery: false,
            cools_battery: false,
            stores: [StoreStage::HeatingHotLoop; STORE_PLACES],
            demanded_w: 0.0,
            cabin_pid: ResetPid::default(),
            battery_pid: ResetPid::default(),
            htc_pid: ResetPid::default(),
            chiller_pid: ResetPid::default(),
        }
    }

    fn demand(
        &self,
        plant: &Plant,
        state: &State,
        settings: &DriverSettings,
        memory: &mut HpcuMemory,
        demand: &mut Demand,
    ) {
        let comfort = self.comfort(state, settings);
        let mode = self.cabin_mode(&comfort, memory);
        self.connect(plant, state, &comfort, memory, mode, demand);
        let heats = self.strategy.ptc
            && mode == CabinMode::Heating
            && comfort.lack_k(mode) >= self.parameters.ptc_from_deviation_k;
        self.roles.allow_heaters(heats, demand);
        self.trim_requests(state, &comfort, memory, mode, demand);
        let (parameters, lack_k) = (&self.parameters, comfort.lack_k(mode));
        self.roles.blow(
            parameters.options.blower_level(mode, self.constant_settings().blower_level(mode), lack_k),
            demand,
        );
        parameters.options.mind_air(&self.roles, state, demand);
        settings.enter(self.heater_offset_k, &self.roles, demand);
        if let Some(row) = self.roles.compressor_row {
            demand[row] = self.compressor_power_w(plant, state, &comfort, memory, mode);
        }
    }
}

impl Hpcu {
    fn comfort(&self, state: &State, settings: &DriverSettings) -> Comfort {
        Comfort {
            cabin_k: temperature_k(state, self.roles.cabin_air),
            target_k: settings.target_k(self.parameters.cabin_set_point_degc),
        }
    }

    fn cabin_mode(&self, comfort: &Comfort, memory: &mut HpcuMemory) -> CabinMode {
        let above_k = comfort.cabin_k - comfort.target_k;
        memory.cabin_mode = match self.strategy.climate_control {
            ClimateControl::Heat => CabinMode::Heating,
            ClimateControl::Cool => CabinMode::Cooling,
            ClimateControl::Auto if above_k > self.parameters.mode_switch_deviation_k => CabinMode::Cooling,
            ClimateControl::Auto if above_k < -self.parameters.mode_switch_deviation_k => CabinMode::Heating,
            ClimateControl::Auto => memory.cabin_mode,
        };
        memory.cabin_mode
    }

    fn connect(
        &self,
        plant: &Plant,
        state: &State,
        comfort: &Comfort,
        memory: &mut HpcuMemory,
        mode: CabinMode,
        demand: &mut Demand,
    ) {
        self.presets.enter(mode, demand);
        if let Some(battery) = self.roles.battery {
            battery.connect(demand, self.battery_way(&battery, state, comfort, memory));
        }
        for &(row, option) in &self.roles.plates {
            demand[row] = if memory.cools_battery { option } else { ISOLATED };
        }
        for (store, stage) in self.roles.stores.iter().zip(&mut memory.stores) {
            let way = store_way(store, stage, plant, state);
            demand[store.row] = way.map_or(ISOLATED, |way| way.option as f64);
        }
    }

    fn battery_way(
        &self,
        battery: &Connectable,
        state: &State,
        comfort: &Comfort,
        memory: &mut HpcuMemory,
    ) -> Option<Way> {
        let limits = &self.parameters.battery;
        let battery_k = temperature_k(state, self.roles.battery_node);
        let heat_up_to_k = limits.heat_up_to_degc.kelvin();
        let cool_above_k = limits.cool_above_degc.kelvin();
        (memory.heats_battery, memory.cools_battery) = match self.strategy.battery {
            BatteryTreatment::Isolate => (false, false),
            BatteryTreatment::Source => (false, battery_k > limits.source_down_to_degc.kelvin()),
            BatteryTreatment::Heat => {
                let resume_k =
                    heat_up_to_k - if memory.heats_battery { 0.0 } else { limits.heating_hysteresis_k };
                let release_k =
                    cool_above_k - if memory.cools_battery { limits.cooling_hysteresis_k } else { 0.0 };
                (battery_k < resume_k && self.battery_share(state, comfort) > 0.0, battery_k > release_k)
            }
        };
        match (memory.heats_battery, memory.cools_battery) {
            (true, _) => battery.heats,
            (false, true) => battery.cools,
            (false, false) => None,
        }
    }

    /// Lets requests fade near their targets, so that neither cabin nor battery overshoots.
    fn trim_requests(
        &self,
        state: &State,
        comfort: &Comfort,
        memory: &HpcuMemory,
        mode: CabinMode,
        demand: &mut Demand,
    ) {
        let beyond_k = comfort.lack_k(mode) + self.parameters.cabin_request_band_k;
        for cabin in &self.roles.cabins {
            demand[cabin.request_row] *= (beyond_k / self.parameters.cabin_request_band_k).clamp(0.0, 1.0);
        }
        if let Some(battery) = self.roles.battery
            && self.strategy.battery == BatteryTreatment::Source
            && memory.cools_battery
        {
            let limits = &self.parameters.battery;
            let above_k = temperature_k(state, self.roles.battery_node) - limits.source_down_to_degc.kelvin();
            demand[battery.request_row] *= (above_k / limits.source_request_band_k).clamp(0.0, 1.0);
        }
        if let Some(battery) = self.roles.battery
            && memory.heats_battery
        {
            demand[battery.request_row] *= self.battery_share(state, comfort);
        }
        if mode == CabinMode::Cooling {
            self.roles.unlimit_rejection(demand);
        }
    }

    /// Share of its heat request that the battery gets while the cabin comes first.
    fn battery_share(&self, state: &State, comfort: &Comfort) -> f64 {
        let supplies_k = self.roles.hot_supplies.iter().map(|&node| temperature_k(state, node));
        let lack_k = comfort.lack_k(CabinMode::Heating);
        self.parameters.options.battery_share(lack_k, supplies_k.reduce(f64::max))
    }

    /// `min(max(PID battery, PID cabin), PID chiller, PID HTC)`.
    fn compressor_power_w(
        &self,
        plant: &Plant,
        state: &State,
        comfort: &Comfort,
        memory: &mut HpcuMemory,
        mode: CabinMode,
    ) -> f64 {
        let Some(refrigeration) = plant.vehicle.refrigeration.as_ref().filter(|_| self.strategy.heat_pump)
        else {
            return 0.0;
        };
        let highest_w = refrigeration.compressor.maximum_power_w;
        let applied_w = if state.refrigeration.compressor.running {
            state.compressor_power_w
        } else {
            memory.demanded_w.min(RESTART_SHARE * highest_w)
        };
        let power = |pid: &mut ResetPid, gains: &ResetGains, error_k: f64| {
            pid.applied(gains, applied_w);
            pid.output(gains, error_k, 0.0, highest_w)
        };
        let parameters = &self.parameters;
        let cabin_w = power(&mut memory.cabin_pid, &self.gains.cabin, comfort.lack_k(mode));
        let battery_w = match self.battery_error_k(state, memory) {
            Some(error_k) => power(&mut memory.battery_pid, &self.gains.battery, error_k),
            None => 0.0,
        };
        if battery_w == 0.0 {
            memory.battery_pid.clear();
        }
        let chiller_set_point = match mode {
            CabinMode::Heating => parameters.chiller_set_point_degc,
            CabinMode::Cooling => parameters.cooling_chiller_set_point_degc,
        };
        let supply_k = |nodes: &[Node], further: fn(f64, f64) -> f64| {
            nodes.iter().map(|&node| temperature_k(state, node)).reduce(further)
        };
        // Without such a loop nothing limits the compressor on that side.
        let htc_w = supply_k(&self.roles.hot_supplies, f64::max).map_or(highest_w, |supply_k| {
            let error_k = parameters.htc_set_point_degc.kelvin() - supply_k;
            power(&mut memory.htc_pid, &self.gains.htc, error_k)
        });
        let chiller_w = supply_k(&self.roles.cold_supplies, f64::min).map_or(highest_w, |supply_k| {
            power(&mut memory.chiller_pid, &self.gains.chiller, supply_k - chiller_set_point.kelvin())
        });
        memory.demanded_w = cabin_w.max(battery_w).min(htc_w).min(chiller_w);
        memory.demanded_w
    }

    /// Deviation of the battery from its target while the loops act on it [K].
    fn battery_error_k(&self, state: &State, memory: &HpcuMemory) -> Option<f64> {
        let battery_k = temperature_k(state, self.roles.battery_node);
        let limits = &self.parameters.battery;
        if memory.heats_battery {
            let heated = self.roles.battery.and_then(|battery| battery.heats)?;
            return state.connected[heated.branch].then(|| limits.heat_up_to_degc.kelvin() - battery_k);
        }
        let target_k = match self.strategy.battery {
            BatteryTreatment::Source => limits.source_down_to_degc.kelvin(),
            _ => limits.cool_above_degc.kelvin(),
        };
        self.roles.battery.and_then(|battery| battery.cools)?;
        memory.cools_battery.then_some(battery_k - target_k)
    }
}

/// First into a hot loop while it can heat that, then into a cold one until it is empty, then isolated.
fn store_way(store: &Store, stage: &mut StoreStage, plant: &Plant, state: &State) -> Option<Way> {
    let switch = &plant.vehicle.controls.thermal_switch;
    let useful = |way: Option<Way>| {
        way.is_some_and(|way| {
            let connected = state.connected[way.branch];
            let least_k = if connected { switch.opening_difference_k } else { switch.closing_difference_k };
            plant.mass_difference_k(state, way.branch) > least_k
        })
    };
    if *stage == StoreStage::HeatingHotLoop && !useful(store.into_hot) {
        *stage = StoreStage::Emptying;
    }
    if *stage == StoreStage::Emptying && !useful(store.into_cold) {
        *stage = StoreStage::Empty;
    }
    match stage {
        StoreStage::HeatingHotLoop => store.into_hot,
        StoreStage::Emptying => store.into_cold,
        StoreStage::Empty => None,
    }
}

fn temperature_k(state: &State, node: Node) -> f64 {
    state.temperatures_k[node.index()]
}
