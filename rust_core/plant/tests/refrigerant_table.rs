//! The Rust evaluation of the refrigerant tables against CoolProp states written by `make_table.py --reference`.

use hp_plant::config::kinds::REFRIGERANT;
use hp_plant::config::library;
use hp_plant::media::refrigerant::RefrigerantTable;

const RELATIVE: f64 = 5e-4;
const ENTHALPY_FLOOR_J_KG: f64 = 20.0;

/// Every built-in fluid with its states.
const FLUIDS: [(&str, &str, usize); 4] = [
    ("r1234yf", include_str!("data/r1234yf_reference.csv"), 150),
    ("r134a", include_str!("data/r134a_reference.csv"), 400),
    ("r152a", include_str!("data/r152a_reference.csv"), 150),
    ("r290", include_str!("data/r290_reference.csv"), 150),
];

#[test]
fn tables_agree_with_coolprop_between_nodes() {
    assert_eq!(
        FLUIDS.map(|(name, ..)| name).to_vec(),
        library::names(REFRIGERANT),
        "a fluid has no reference"
    );
    for (name, text, count) in FLUIDS {
        let table = RefrigerantTable::load(name).expect("built in");
        let states: Vec<&str> = text.lines().skip(2).collect();
        assert_eq!(states.len(), count, "{name}");
        for line in states {
            check_state(&table, line);
        }
    }
}

fn check_state(table: &RefrigerantTable, line: &str) {
    let fields: Vec<f64> = line.split(',').map(|field| field.parse().expect("a number")).collect();
    let [te, superheat, p_e, h_1, rho_1, s_1, tc, subcooling, p_c, h_3, h_is, h_2, t_2] = fields[..] else {
        panic!("13 columns expected: {line}");
    };
    let close = |what: &str, value: f64, exact: f64, tolerance: f64| {
        let name = table.name();
        assert!((value - exact).abs() <= tolerance, "{name}, {what}: {value} against {exact} in {line}");
    };
    let suction = table.suction_state(te, superheat);
    let isobar = table.condensing_isobar(tc);
    close("p_e", suction.pressure_pa, p_e, RELATIVE * p_e);
    close("p_c", isobar.pressure_pa, p_c, RELATIVE * p_c);
    close("rho", suction.density_kg_m3, rho_1, RELATIVE * rho_1);
    close("h_1", suction.enthalpy_j_kg, h_1, ENTHALPY_FLOOR_J_KG);
    close("s_1", suction.entropy_j_kg_k, s_1, 0.05);
    close("h_3", isobar.liquid_enthalpy_j_kg(subcooling), h_3, ENTHALPY_FLOOR_J_KG);
    let work = isobar.enthalpy_at_entropy_j_kg(suction.entropy_j_kg_k) - suction.enthalpy_j_kg;
    close("work", work, h_is - h_1, (RELATIVE * (h_is - h_1)).max(ENTHALPY_FLOOR_J_KG));
    close("T_2", table.discharge_temperature_k(&isobar, h_2), t_2, 0.01_f64.max(RELATIVE * (t_2 - tc)));
}

#[test]
fn limits_of_every_built_in_fluid_lie_within_its_table() {
    for (name, ..) in FLUIDS {
        let table = RefrigerantTable::load(name).expect("built in");
        let limits = table.limits().expect("each has them");
        let highest_bar = table.saturation_pressure_pa(table.highest_saturation_k()) / 1e5;
        let lowest_bar = table.saturation_pressure_pa(table.lowest_saturation_k()) / 1e5;
        assert!(limits.maximum_pressure_bar <= highest_bar && highest_bar < limits.critical_pressure_bar);
        assert!(limits.minimum_suction_pressure_bar >= lowest_bar);
        let gap_k = limits.critical_temperature_degc + 273.15 - table.highest_saturation_k();
        assert!((5.0..9.0).contains(&gap_k), "{name}: {gap_k}");
    }
}
