use hp_plant::simulation::Experiment;
fn main() {
    for id in ["case1-1","case1-2","case1-3","case1-4","case1-5","case2-1","case2-2","case2-3","case2-4"] {
        let e = Experiment::load(&format!("jeffs2019/{id}"), None, &[]).unwrap_or_else(|e| panic!("{e}"));
        let t = std::time::Instant::now();
        let (s, end) = e.totals();
        let us = t.elapsed().as_secs_f64()*1e6/1800.0;
        let v: std::collections::HashMap<_,_> = s.values().into_iter().collect();
        println!("{id} {end:?} E {:.3} SOC {:.2} cmp {:.2} ptc {:.2} disc {:.2} pmax {:.2} htc {:.2} chl {:.2} starts {} trips {} breaches {} resid {:.1e} {:.2} us/step", v["energy_kwh"], v["final_soc_pct"], v["compressor_energy_kwh"], v["ptc_energy_kwh"], v["discomfort_k"], v["highest_pressure_bar"], v["highest_htc_supply_degc"], v["lowest_chiller_supply_degc"], v["compressor_starts"], v["protection_trips"], v["limit_breaches"], v["worst_relative_residual"], us);
    }
}
