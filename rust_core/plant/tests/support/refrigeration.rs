//! A refrigeration loop with round numbers, shared by tests and examples; not a vehicle of the paper.

use hp_plant::circuits::refrigeration_cycle::RefrigerationCycle;
use hp_plant::circuits::refrigeration_cycle::RefrigerationParameters;
use hp_plant::circuits::refrigeration_loop::{LoopBoundary, SupplyLimit};
use hp_plant::circuits::vapour_injection::{EconomiserParameters, InjectionParameters};
use hp_plant::components::compressor::CompressorParameters;
use hp_plant::components::heat_exchanger::inlet_conductance_w_k;
use hp_plant::media::refrigerant::RefrigerantTable;

/// Conductances of its condenser and its evaporator [W/K].
pub const CONDENSER_UA_W_K: f64 = 700.0;
pub const EVAPORATOR_UA_W_K: f64 = 600.0;

/// Parameters of the test loop.
pub fn parameters() -> RefrigerationParameters {
    RefrigerationParameters {
        superheat_k: 5.0,
        subcooling_k: 5.0,
        maximum_pressure_bar: 30.0,
        minimum_suction_pressure_bar: 0.2,
        compressor: CompressorParameters {
            displacement_cm3: 33.0,
            minimum_speed_rev_s: 13.3,
            maximum_speed_rev_s: 140.0,
            speed_ramp_rev_s2: 20.0,
            maximum_power_w: 5000.0,
            minimum_power_w: 30.0,
            minimum_on_time_s: 30.0,
            minimum_off_time_s: 60.0,
            start_loss_j: 2000.0,
            maximum_discharge_temperature_degc: 130.0,
            volumetric_efficiency_at_unity: 1.0,
            volumetric_efficiency_slope: 0.02,
            leakage_share: 0.1,
            isentropic_efficiency_peak: 0.72,
            isentropic_peak_pressure_ratio: 2.5,
            isentropic_pressure_ratio_loss: 0.35,
            isentropic_speed_loss: 0.6,
            electrical_efficiency: 0.9,
            loss_to_gas_share: 0.0,
            settling_time_s: 0.0,
            migration_time_s: 120.0,
            minimum_pressure_ratio: 1.1,
        },
        injection: None,
    }
}

/// Vapour injection from an economiser or a flash tank.
#[allow(dead_code, reason = "not every user of this file needs it")]
pub fn injection(economiser: bool) -> InjectionParameters {
    let exchanger = EconomiserParameters { effectiveness: 0.85, superheat_k: 5.0 };
    InjectionParameters { pressure_position: 0.5, economiser: economiser.then_some(exchanger) }
}

/// The test loop with R134a.
#[allow(dead_code, reason = "not every user of this file needs it")]
pub fn cycle() -> RefrigerationCycle {
    let table = RefrigerantTable::load("R134a").expect("R134a is built in");
    RefrigerationCycle::new(parameters(), table).expect("the parameters fit the table")
}

/// Coolants without supply limits in reach; temperatures in degC.
#[allow(dead_code, reason = "not every user of this file needs it")]
pub fn boundary(hot_return_degc: f64, cold_return_degc: f64, hot_w_k: f64, cold_w_k: f64) -> LoopBoundary {
    let (hot_return_k, cold_return_k) = (hot_return_degc + 273.15, cold_return_degc + 273.15);
    LoopBoundary {
        hot_return_k,
        cold_return_k,
        hottest_inlet_k: hot_return_k,
        coldest_inlet_k: cold_return_k,
        hot_conductance_w_k: inlet_conductance_w_k(hot_w_k, CONDENSER_UA_W_K),
        cold_conductance_w_k: inlet_conductance_w_k(cold_w_k, EVAPORATOR_UA_W_K),
        hot_capacity_rate_w_k: hot_w_k,
        cold_capacity_rate_w_k: cold_w_k,
        hot_supply: SupplyLimit { base_k: hot_return_k, sensitivity_k_w: 0.0, limit_k: 500.0 },
        cold_supply: SupplyLimit { base_k: cold_return_k, sensitivity_k_w: 0.0, limit_k: 100.0 },
    }
}
