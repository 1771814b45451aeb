use hp_plant::simulation::Experiment;
fn main() {
    let sub: u32 = std::env::args().nth(1).map_or(1, |s| s.parse().unwrap());
    let trace = std::env::args().nth(2);
    let over: Vec<_> = std::env::args().skip(3).map(|o| hp_plant::config::library::Override::parse(&o).unwrap()).collect();
    for id in ["case1-1","case1-2","case1-3","case1-4","case1-5","case2-1","case2-2","case2-3","case2-4"] {
        let mut e = Experiment::load(&format!("jeffs2019/{id}"), None, &over).unwrap_or_else(|e| panic!("{e}"));
        e = e.with_substeps(sub);
        let t = std::time::Instant::now();
        let (s, end) = e.totals();
        let us = t.elapsed().as_secs_f64()*1e6/1800.0;
        let v: std::collections::HashMap<_,_> = s.values().into_iter().collect();
        println!("{id} {end:?} E {:.4} SOC {:.2} cmp {:.2} ptc {:.2} disc {:.2} pmax {:.2} htc {:.2} chl {:.2} starts {} trips {} breaches {} resid {:.1e} {:.2} us/step", v["energy_kwh"], v["final_soc_pct"], v["compressor_energy_kwh"], v["ptc_energy_kwh"], v["discomfort_k"], v["highest_pressure_bar"], v["highest_htc_supply_degc"], v["lowest_chiller_supply_degc"], v["compressor_starts"], v["protection_trips"], v["limit_breaches"], v["worst_relative_residual"], us);
        if trace.as_deref() == Some(id) {
            let mut run = e.start();
            loop {
                let c = e.rule_based_command(&mut run);
                let end = e.step(&mut run, &c);
                let r = run.record.unwrap();
                if run.steps % 20 == 0 || (r.refrigeration.limited_by != hp_plant::circuits::refrigeration_loop::Limit::Power && !r.refrigeration.running()) {
                    println!("{:5} dem {:6.0} P {:6.0} {:?} by {:?} N {:.1} Te {:.1} Tc {:.1} Tdis {:.1} T0 {:.1} T1 {:.1} T2 {:.1} T3 {:.1} cab {:.1} bat {:.1} ptc {:.0}", run.steps, r.demand.compressor_power_w, r.refrigeration.electric_power_w, r.refrigeration.status, r.refrigeration.limited_by, r.refrigeration.speed_rev_s, r.refrigeration.evaporating_temperature_k-273.15, r.refrigeration.condensing_temperature_k-273.15, r.refrigeration.discharge_temperature_k-273.15, run.state.temperatures_k[0]-273.15, run.state.temperatures_k[1]-273.15, run.state.temperatures_k[2]-273.15, run.state.temperatures_k[3]-273.15, run.state.temperatures_k[7]-273.15, run.state.temperatures_k[4]-273.15, r.flows[hp_plant::flows::Flow::Ptc]);
                }
                if end.is_some() { break; }
            }
        }
    }
}
