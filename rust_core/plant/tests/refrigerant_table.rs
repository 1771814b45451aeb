//! The Rust evaluation of the R134a table against CoolProp states written by `make_table.py --reference`.

use hp_plant::media::refrigerant::RefrigerantTable;

const RELATIVE: f64 = 5e-4;
const ENTHALPY_FLOOR_J_KG: f64 = 20.0;

#[test]
fn table_agrees_with_coolprop_between_nodes() {
    let table = RefrigerantTable::load("R134a").expect("R134a is built in");
    let text = include_str!("data/r134a_reference.csv");
    let mut states = 0;
    for line in text.lines().skip(2) {
        let fields: Vec<f64> = line.split(',').map(|field| field.parse().expect("a number")).collect();
        let [te, superheat, p_e, h_1, rho_1, s_1, tc, subcooling, p_c, h_3, h_is, h_2, t_2] = fields[..]
        else {
            panic!("13 columns expected: {line}");
        };
        let close = |what: &str, value: f64, exact: f64, tolerance: f64| {
            assert!((value - exact).abs() <= tolerance, "{what}: {value} against {exact} in {line}");
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
        states += 1;
    }
    assert_eq!(states, 400);
}
