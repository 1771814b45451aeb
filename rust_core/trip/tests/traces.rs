//! Traces: what a file of a measured trip may look like, and what is told of one that cannot be trusted.

use hp_trip::drive_cycle::DriveCycle;
use hp_trip::trace::Trace;
use hp_trip::trace::columns::Quantity;
use proptest::prelude::*;
use std::fmt::Write as _;

fn trace(text: &str) -> Trace {
    Trace::from_csv("mine.csv", text).unwrap_or_else(|error| panic!("{error}"))
}

fn told(text: &str) -> String {
    Trace::from_csv("mine.csv", text).expect_err(text).to_string()
}

#[test]
fn a_speed_counts_in_the_unit_that_its_column_names() {
    for (column, fast) in [("speed_km_h", "90"), ("speed_m_s", "25"), ("speed_mph", "55.923407")] {
        let cycle = DriveCycle::from_csv("mine.csv", &format!("time_s,{column}\n0,0\n1,{fast}\n2,{fast}\n"));
        let speeds_m_s = cycle.expect("a cycle").speeds_m_s().to_vec();
        assert!((speeds_m_s[2] - 25.0).abs() < 1e-6, "{column}: {speeds_m_s:?}");
    }
}

#[test]
fn columns_are_found_by_name_in_any_order_with_all_that_spreadsheets_add() {
    let text = "\u{feff}# a log\r\n\"ambient_degc\" , time_s,\"speed_m_s\",measured_heater_power_w\r\n\r\n\
                -7,100, 0,5000\r\n# under way\r\n-6,101,\"4\",4000\r\n-5,102,8,3000\r\n";
    let trace = trace(text);
    assert_eq!(trace.duration_s(), 2);
    assert_eq!(trace.values(Quantity::Ambient).expect("there")[..], [-7.0, -6.0, -5.0]);
    assert_eq!(trace.values(Quantity::HeaterPower).expect("there")[..], [5000.0, 4000.0, 3000.0]);
    assert_eq!(trace.speeds_m_s().expect("there")[..], [0.0, 4.0, 8.0]);
    assert!(trace.values(Quantity::Grade).is_none());
}

#[test]
fn time_counts_from_the_first_row_even_on_a_clock_of_many_digits() {
    let mut text = "time_s,speed_m_s\n".to_owned();
    for row in 0..=600 {
        writeln!(text, "{},{}", 1_763_000_000.0 + 0.1 * f64::from(row), 10).expect("a string");
    }
    let trace = trace(&text);
    assert_eq!(trace.duration_s(), 60);
    assert!(trace.speeds_m_s().expect("there").iter().all(|speed| (speed - 10.0).abs() < 1e-12));
}

#[test]
fn fast_samples_are_averaged_around_each_second() {
    // 2 Hz: 0, 6, 0, 6, ... m/s; half a second before and after each full second the line between rows has the mean 3.
    let rows: String = (0..=8).map(|row| format!("{},{}\n", 0.5 * f64::from(row), 6 * (row % 2))).collect();
    let speeds = trace(&format!("time_s,speed_m_s\n{rows}")).speeds_m_s().expect("there");
    assert!(speeds.iter().all(|speed| (speed - 3.0).abs() < 1e-12), "{speeds:?}");
    // A single spike of 10 Hz counts as what it adds in the mean, and not as if it had lasted.
    let rows: String = (0..=40)
        .map(|row| format!("{},{}\n", f64::from(row) / 10.0, if row == 20 { 8 } else { 0 }))
        .collect();
    let speeds = trace(&format!("time_s,speed_m_s\n{rows}")).speeds_m_s().expect("there");
    assert!((speeds[2] - 0.8).abs() < 1e-9, "{speeds:?}");
}

#[test]
fn slow_samples_are_interpolated() {
    let speeds = trace("time_s,speed_m_s\n0,1.1\n2,3.3\n4,0.7\n").speeds_m_s().expect("there");
    for (second, expected) in [1.1, 2.2, 3.3, 2.0, 0.7].into_iter().enumerate() {
        assert!((speeds[second] - expected).abs() < 1e-12, "{speeds:?}");
    }
}

proptest! {
    /// Means over a second around each full second leave the way as long as the samples say.
    #[test]
    fn averaging_keeps_the_distance(
        speeds in prop::collection::vec(0.0..40.0_f64, 11..300), per_second in 2_u32..10,
    ) {
        let step_s = 1.0 / f64::from(per_second);
        let whole = (speeds.len() - 1) / per_second as usize * per_second as usize;
        prop_assume!(whole > 0);
        let mut text = "time_s,speed_m_s\n".to_owned();
        for (row, speed) in speeds[..=whole].iter().enumerate() {
            writeln!(text, "{},{speed}", row as f64 * step_s).expect("a string");
        }
        let sampled_m: f64 = speeds[..=whole].windows(2).map(|pair| 0.5 * (pair[0] + pair[1]) * step_s).sum();
        let cycle = DriveCycle::from_csv("mine.csv", &text).expect("a cycle");
        prop_assert!((cycle.distance_m() - sampled_m).abs() < 1e-6 * (1.0 + sampled_m));
    }

    #[test]
    fn no_text_makes_it_panic(text in "[-0-9a-z_,.#\" \n\r\u{feff}]{0,200}", header in 0_usize..3) {
        let header = ["", "time_s,speed_km_h\n", "time_s,ambient_degc,solar_w_m2\n"][header];
        let _ = Trace::from_csv("any.csv", &format!("{header}{text}"));
    }
}

/// Each with what it must say: place, value, rule.
#[test]
fn what_is_wrong_with_a_trace_is_told_with_line_or_column_value_and_rule() {
    let speed = "time_s,speed_km_h\n";
    for (text, parts) in [
        (String::new(), &["no header"][..]),
        ("0,0\n1,3\n".into(), &["line 1", "`0,0`", "must name the columns"]),
        ("time_s;speed_km_h\n0;0\n1;3\n".into(), &["line 1", "';'", "must be by commas"]),
        (
            "time_s,speed_kmh\n0,0\n1,3\n".into(),
            &["line 1", "unknown column `speed_kmh`", "nearest: speed_km_h"],
        ),
        (
            "# a\ntime_s,speed_m_s,speed_mph\n0,0,0\n1,3,3\n".into(),
            &["line 2", "speed_m_s", "speed_mph", "must not both"],
        ),
        (
            "time_s,grade_pct,elevation_m\n0,0,0\n1,3,3\n".into(),
            &["grade_pct", "elevation_m", "must not both"],
        ),
        ("time_s,speed_m_s,speed_m_s\n0,0,0\n1,3,3\n".into(), &["line 1", "`speed_m_s` stands there twice"]),
        ("speed_km_h\n0\n1\n".into(), &["line 1", "no column `time_s`"]),
        ("time_s\n0\n1\n".into(), &["no column besides"]),
        (format!("{speed}0,0\n"), &["at least two rows"]),
        (format!("{speed}0,0\n1,2,3\n"), &["line 3", "`1,2,3` has 3 fields", "must have 2"]),
        (format!("{speed}0,0\n1,\n"), &["line 3", "`speed_km_h` is empty"]),
        (format!("{speed}0,0\n1,nan\n"), &["line 3", "`speed_km_h` is NaN", "finite"]),
        (format!("{speed}0,0\ninf,1\n"), &["line 3", "`time_s` is inf", "finite"]),
        (format!("{speed}0,0\n1,fast\n"), &["line 3", "`speed_km_h` is `fast`", "number"]),
        (format!("{speed}0,0\n1,-3\n"), &["line 3", "`speed_km_h` is -3", "must be between 0 and 300"]),
        (format!("{speed}0,0\n1,301\n"), &["line 3", "`speed_km_h` is 301", "must be between 0 and 300"]),
        ("time_s,speed_m_s\n0,0\n1,120\n".into(), &["line 3", "`speed_m_s` is 120", "between 0 and 83.4"]),
        (format!("{speed}0,0\n2,1\n1,1\n"), &["line 4", "`time_s` is 1 after 2", "backwards", "must rise"]),
        (format!("{speed}0,0\n1,1\n1,1\n"), &["line 4", "`time_s` is 1 after 1", "twice", "must rise"]),
        (format!("{speed}0,0\n2e6,1\n"), &["line 3", "`time_s` is 2000000", "at most 1000000"]),
        (
            format!("{speed}0,0\n1,0\n2,0\n8,0\n9,0\n"),
            &["line 5", "gap of 6 s", "8", "5 median intervals (5 s)"],
        ),
        (format!("{speed}0,0\n0.5,3\n"), &["no full second"]),
        (
            "time_s,relative_humidity_pct\n0,0.4\n1,0.85\n".into(),
            &["relative_humidity_pct", "0.85", "percent"],
        ),
        ("time_s,recirculation\n0,0\n1,70\n".into(), &["line 3", "`recirculation` is 70", "between 0 and 1"]),
        ("time_s,ambient_degc\n0,270\n1,271\n".into(), &["line 2", "`ambient_degc` is 270", "-50 and 60"]),
    ] {
        let message = told(&text);
        assert!(message.starts_with("mine.csv: ") && !message.contains('\n'), "{text}: {message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{text}: {message}");
    }
    let climate = Trace::from_csv("air.csv", "time_s,ambient_degc\n0,1\n1,2\n").expect("a trace");
    let message = DriveCycle::of(&climate).expect_err("no speed").to_string();
    assert!(
        message.starts_with("air.csv: ") && message.contains("speed_km_h, speed_m_s, speed_mph"),
        "{message}"
    );
}

#[test]
fn five_median_intervals_are_no_gap_yet() {
    let rows = "0.0,0\n0.1,0\n0.2,0\n0.7,1\n0.8,1\n0.9,1\n1.0,1\n1.1,1\n";
    assert_eq!(trace(&format!("time_s,speed_m_s\n{rows}")).duration_s(), 1);
}
