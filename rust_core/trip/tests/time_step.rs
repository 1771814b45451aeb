//! Step size: controllers held at 1 s, the plant integrated finer and finer.

use hp_plant::config::library::Override;
use hp_plant::flows::Flow;
use hp_trip::experiment::Experiment;
use rayon::prelude::*;

const CASES: [&str; 9] =
    ["case1-1", "case1-2", "case1-3", "case1-4", "case1-5", "case2-1", "case2-2", "case2-3", "case2-4"];

struct Outcome {
    energy_j: f64,
    /// Temperatures of all nodes at every second [K].
    temperatures_k: Vec<Vec<f64>>,
}

fn run(case: &str, substeps: u32) -> Outcome {
    run_changed(case, None, &[], substeps)
}

fn run_vehicle(case: &str, vehicle: Option<&str>, substeps: u32) -> Outcome {
    run_changed(case, vehicle, &[], substeps)
}

fn run_changed(case: &str, vehicle: Option<&str>, changes: &[Override], substeps: u32) -> Outcome {
    let experiment = Experiment::with_vehicle(&format!("jeffs2019/{case}"), vehicle, None, changes)
        .expect("built-in scenario")
        .with_substeps(substeps);
    let nodes = experiment.plant.network.nodes();
    let mut run = experiment.start();
    let mut temperatures_k = Vec::new();
    loop {
        let command = experiment.rule_based_command(&mut run);
        let end = experiment.step(&mut run, &command);
        temperatures_k.push(run.state.temperatures_k[..nodes].to_vec());
        if end.is_some() {
            return Outcome { energy_j: run.summary.energy_j(Flow::BATTERY), temperatures_k };
        }
    }
}

#[test]
fn one_second_steps_agree_with_steps_of_fifty_milliseconds() {
    let experiment = Experiment::load("jeffs2019/case1-1", None, &[]).expect("built-in scenario");
    let layout = experiment.plant.layout();
    let cabin = &layout.cabins[0];
    let bodies = [layout.battery, cabin.air, cabin.soft, cabin.hard, layout.motor, layout.transmission];
    let [htc, chiller] = [&layout.loops[0], &layout.loops[1]];
    let loops = [htc.supply, htc.back, chiller.supply, chiller.back];
    let report: Vec<String> = CASES
        .par_iter()
        .map(|case| {
            let (coarse, fine) = (run(case, 1), run(case, 20));
            let energy = (coarse.energy_j / fine.energy_j - 1.0).abs();
            let steps = fine.temperatures_k.len();
            let differences = |node: hp_plant::numerics::thermal_network::Node| -> Vec<f64> {
                let pairs = coarse.temperatures_k.iter().zip(&fine.temperatures_k);
                pairs.map(|(a, b)| (a[node.index()] - b[node.index()]).abs()).collect()
            };
            let at_end = bodies.map(|node| differences(node)[steps - 1]).into_iter().fold(0.0, f64::max);
            let at_any =
                bodies.map(|node| differences(node).into_iter().fold(0.0, f64::max)).into_iter().fold(0.0, f64::max);
            let root_mean_square = loops
                .map(|node| {
                    let squares: f64 = differences(node).iter().map(|difference| difference * difference).sum();
                    (squares / steps as f64).sqrt()
                })
                .into_iter()
                .fold(0.0, f64::max);
            assert!(energy < 1e-3, "{case}: energy differs by {energy:e}");
            assert!(at_end < 0.15, "{case}: {at_end} K at the end");
            assert!(at_any < 0.5, "{case}: {at_any} K at some time");
            assert!(root_mean_square < 0.5, "{case}: loops differ by {root_mean_square} K RMS");
            format!("{case}: energy {energy:.1e}, bodies {at_end:.3} K end, {at_any:.3} K max, loops {root_mean_square:.3} K RMS")
        })
        .collect();
    println!("{}", report.join("\n"));
}

#[test]
fn temperatures_converge_with_first_order() {
    // How a start comes in ends at a threshold (the lowest speed, the settled machine), which has no order.
    let at_once = [Override::parse("vehicle.refrigeration.compressor.settling_time_s=0.0").expect("valid")];
    let errors: Vec<f64> = {
        let reference = run_changed("case1-4", None, &at_once, 64);
        [1, 2, 4]
            .par_iter()
            .map(|&substeps| {
                let outcome = run_changed("case1-4", None, &at_once, substeps);
                let squares: f64 = outcome
                    .temperatures_k
                    .iter()
                    .flatten()
                    .zip(reference.temperatures_k.iter().flatten())
                    .map(|(a, b)| (a - b) * (a - b))
                    .sum();
                squares.sqrt()
            })
            .collect()
    };
    let orders: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
    println!("errors {errors:?}, observed orders {orders:?}");
    assert!(orders.iter().all(|&order| order >= 0.9), "orders {orders:?}");
}

/// Other architectures too; air that exchangers share, and that behind a core, is that of the second before or of the step's
/// beginning, which is of first order as well.
#[test]
fn other_architectures_agree_with_finer_steps_too() {
    let cases = [
        "jeffs2019-three-loops",
        "jeffs2019-direct",
        "jeffs2019-cabin-condenser",
        "jeffs2019-low-temperature-radiator",
    ];
    let report: Vec<String> = cases
        .par_iter()
        .flat_map_iter(|vehicle| ["case1-4", "case2-2"].map(|case| (vehicle, case)))
        .map(|(vehicle, case)| {
            let (coarse, fine) = (run_vehicle(case, Some(vehicle), 1), run_vehicle(case, Some(vehicle), 20));
            let energy = (coarse.energy_j / fine.energy_j - 1.0).abs();
            let pairs = coarse.temperatures_k.iter().flatten().zip(fine.temperatures_k.iter().flatten());
            let squares: f64 = pairs.map(|(a, b)| (a - b) * (a - b)).sum();
            let root_mean_square =
                (squares / (coarse.temperatures_k.len() * coarse.temperatures_k[0].len()) as f64).sqrt();
            assert!(energy < 1e-3, "{vehicle}, {case}: energy differs by {energy:e}");
            assert!(
                root_mean_square < 0.5,
                "{vehicle}, {case}: temperatures differ by {root_mean_square} K RMS"
            );
            format!("{vehicle}, {case}: energy {energy:.1e}, {root_mean_square:.3} K RMS")
        })
        .collect();
    println!("{}", report.join("\n"));
}

#[test]
fn repeated_runs_are_bit_identical() {
    let (first, second) = (run("case1-2", 1), run("case1-2", 1));
    assert_eq!(first.energy_j.to_bits(), second.energy_j.to_bits());
    assert_eq!(first.temperatures_k, second.temperatures_k);
}
