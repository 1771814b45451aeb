//! Prints the refrigeration loop at 20 operating points as CSV, parameters first as commented TOML; takes the name of the
//! refrigerant and, for vapour injection, `economiser` or `flash-tank`.
//!
//! With a third argument, `-` for no injection before it: the share of the motor's loss that heats the gas.
//!
//! `scripts/check_refrigeration_cycle.py` compares them with CoolProp and TESPy, `scripts/check_vapour_injection.py` with vclibpy.

#[path = "../tests/support/refrigeration.rs"]
mod support;

use hp_plant::circuits::refrigeration_cycle::RefrigerationCycle;
use hp_plant::circuits::refrigeration_loop::LoopDemand;
use hp_plant::media::refrigerant::RefrigerantTable;

/// Displacement of a machine for R290, whose vapour carries about 1.7 times as much heat per volume [cm3/rev].
const R290_DISPLACEMENT_CM3: f64 = 18.0;

/// Hot and cold coolant returns [degC], their capacity rates [W/K] and the power demand [W].
const POINTS: [[f64; 5]; 20] = [
    [10.0, -10.0, 900.0, 800.0, 600.0],
    [20.0, -10.0, 900.0, 800.0, 900.0],
    [30.0, -15.0, 900.0, 800.0, 900.0],
    [35.0, -5.0, 900.0, 800.0, 1200.0],
    [40.0, -10.0, 1100.0, 900.0, 1200.0],
    [40.0, 0.0, 900.0, 800.0, 800.0],
    [40.0, 0.0, 900.0, 800.0, 1500.0],
    [40.0, 10.0, 700.0, 1200.0, 2000.0],
    [45.0, -5.0, 1200.0, 1200.0, 1400.0],
    [50.0, 0.0, 900.0, 800.0, 600.0],
    [50.0, 5.0, 500.0, 500.0, 1500.0],
    [50.0, 15.0, 900.0, 800.0, 1200.0],
    [55.0, -5.0, 900.0, 800.0, 1000.0],
    [55.0, 20.0, 900.0, 800.0, 2500.0],
    [60.0, 0.0, 900.0, 800.0, 1200.0],
    [60.0, 20.0, 1500.0, 1500.0, 1800.0],
    [65.0, 10.0, 900.0, 800.0, 1500.0],
    [70.0, 25.0, 900.0, 800.0, 1500.0],
    [75.0, 15.0, 900.0, 800.0, 900.0],
    [78.0, 30.0, 1200.0, 800.0, 1200.0],
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let fluid = std::env::args().nth(1).unwrap_or_else(|| "R134a".to_owned());
    let table = RefrigerantTable::load(&fluid)?;
    let mut parameters = support::parameters();
    // What fluids can at all is compared, so nothing is a limit but the ends of their tables.
    parameters.compressor.maximum_discharge_temperature_degc = 150.0;
    parameters.maximum_pressure_bar = table.saturation_pressure_pa(table.highest_saturation_k()) / 1e5;
    let lowest_bar = table.saturation_pressure_pa(table.lowest_saturation_k()) / 1e5;
    parameters.minimum_suction_pressure_bar = parameters.minimum_suction_pressure_bar.max(lowest_bar);
    if fluid.eq_ignore_ascii_case("R290") {
        parameters.compressor.displacement_cm3 = R290_DISPLACEMENT_CM3;
    }
    parameters.injection = match std::env::args().nth(2).as_deref() {
        Some("economiser") => Some(support::injection(true)),
        Some("flash-tank") => Some(support::injection(false)),
        _ => None,
    };
    println!("# condenser_ua_w_k = {:?}", support::CONDENSER_UA_W_K);
    println!("# evaporator_ua_w_k = {:?}", support::EVAPORATOR_UA_W_K);
    if let Some(share) = std::env::args().nth(3) {
        parameters.compressor.loss_to_gas_share = share.parse()?;
    }
    for line in toml::to_string(&parameters)?.lines() {
        println!("# {line}");
    }
    println!(
        "hot_return_k,cold_return_k,hot_capacity_rate_w_k,cold_capacity_rate_w_k,power_limit_w,status,\
         evaporating_temperature_k,condensing_temperature_k,speed_rev_s,mass_flow_kg_s,electric_power_w,\
         condenser_heat_flow_w,evaporator_heat_flow_w,discharge_temperature_k,superheat_k,subcooling_k,\
         injected_mass_flow_kg_s"
    );
    let cycle = RefrigerationCycle::new(parameters, table).map_err(|violation| violation.in_file(&fluid))?;
    for [hot_degc, cold_degc, hot_w_k, cold_w_k, power_limit_w] in POINTS {
        let boundary = support::boundary(hot_degc, cold_degc, hot_w_k, cold_w_k);
        let demand = LoopDemand { power_limit_w, speed_limit_rev_s: 140.0, hold_minimum_speed: false };
        let r = cycle.solve(&boundary, &demand, None);
        println!(
            "{},{},{hot_w_k},{cold_w_k},{power_limit_w},{:?},{},{},{},{},{},{},{},{},{},{},{}",
            boundary.hot_return_k,
            boundary.cold_return_k,
            r.status,
            r.evaporating_temperature_k,
            r.condensing_temperature_k,
            r.speed_rev_s,
            r.mass_flow_kg_s,
            r.electric_power_w,
            r.condenser_heat_flow_w,
            r.evaporator_heat_flow_w,
            r.discharge_temperature_k,
            r.superheat_k,
            r.subcooling_k,
            r.injected_mass_flow_kg_s
        );
    }
    Ok(())
}
