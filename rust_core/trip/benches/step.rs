//! Plant step and its expensive parts: `cargo bench -p hp_trip`.
//!
//! Step times are per second driven: criterion's "thrpt" is steps per second. Instruction counts, which a busy machine
//! does not disturb, come from `examples/step_cost.rs`.

#[path = "support/workload.rs"]
mod workload;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use hp_plant::architecture::layout::{CABIN_PLACES, FRONT_END_PLACES, WEIGHT_PLACES};
use hp_plant::circuits::refrigeration_loop::{LoopDemand, SupplyLimit, WarmStart};
use hp_plant::components::exhaust_recovery::ExhaustRecovery;
use hp_plant::network::conditions::{CabinConditions, Conditions, Constants, state};
use hp_plant::numerics::planned_network::{PlannedNetwork, PlannedStep};
use hp_plant::numerics::thermal_network::{LinkState, MAXIMUM_LINKS, NodeValues};
use hp_plant::plant::StepRecord;
use hp_trip::experiment::Experiment;
use hp_trip::run::Run;
use std::hint::black_box;
use workload::{Car, Executor, Segment, compressor_on_segments, random_segments};

/// Mean step of the paper's scenarios while the compressor runs, and of all scenarios under random actions.
fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("plant step");
    group.sample_size(10);
    let own = Car { executor: Executor::Own, vehicle: None };
    let workloads: [(&str, Vec<Segment>); 2] = [
        ("HPCU, compressor on", compressor_on_segments(&own)),
        ("random actions", random_segments(&own, true)),
    ];
    for (name, segments) in workloads {
        group.throughput(Throughput::Elements(segments.iter().map(|segment| segment.steps as u64).sum()));
        group.bench_function(name, |bencher| {
            bencher.iter(|| segments.iter().map(|segment| black_box(segment.replay())).sum::<f64>());
        });
    }
    group.finish();
}

/// A scenario some time after its start, and what happened in its last step.
fn moment(scenario: &str, after_s: usize) -> (Experiment, Run, StepRecord) {
    let experiment = Experiment::load(scenario, None, &[]).expect("built-in scenario");
    let mut run = experiment.start();
    for _ in 0..after_s {
        let command = experiment.rule_based_command(&mut run);
        experiment.step(&mut run, &command);
    }
    let record = run.record.expect("a step was made");
    (experiment, run, record)
}

fn refrigerant(criterion: &mut Criterion) {
    let (experiment, _, record) = moment("jeffs2019/case1-4", 600);
    let cycle = experiment.plant.refrigeration.as_ref().expect("it has a heat pump");
    let boundary = record.boundary;
    let demand = LoopDemand {
        power_limit_w: record.refrigeration.electric_power_w,
        speed_limit_rev_s: cycle.parameters().compressor.maximum_speed_rev_s,
        hold_minimum_speed: false,
    };
    let solution = record.refrigeration;
    // About as far away as the start value of a second.
    let near = WarmStart {
        evaporating_k: solution.evaporating_temperature_k,
        condensing_k: solution.condensing_temperature_k - 0.05,
        speed_rev_s: solution.speed_rev_s,
    };
    let mut group = criterion.benchmark_group("refrigerant solve");
    group.bench_function("warm", |b| b.iter(|| cycle.solve(&boundary, &demand, black_box(Some(&near)))));
    group.bench_function("cold", |b| b.iter(|| cycle.solve(&boundary, &demand, black_box(None))));
    // More power than the hot coolant can take at lowest speed: the start is refused.
    let (limit_k, sensitivity_k_w) = (boundary.hot_supply.limit_k, boundary.hot_supply.sensitivity_k_w);
    let mut full = boundary;
    full.hot_supply = SupplyLimit { base_k: limit_k - 100.0 * sensitivity_k_w, ..boundary.hot_supply };
    group.bench_function("refused", |b| b.iter(|| cycle.solve(&full, &demand, black_box(Some(&near)))));
    group.finish();

    let table = cycle.table();
    let mut group = criterion.benchmark_group("property look-up");
    group.bench_function("suction state", |b| {
        b.iter(|| table.suction_state(black_box(271.3), black_box(4.9)))
    });
    group.bench_function("condensing isobar", |b| b.iter(|| table.condensing_isobar(black_box(331.7))));
    group.finish();
}

fn network(criterion: &mut Criterion) {
    let (experiment, run, _) = moment("jeffs2019/case1-4", 600);
    let plant = &experiment.plant;
    let layout = plant.layout();
    let mut branches_w_k = [0.0; _];
    for (member, circuit) in
        [("cabin", "htc"), ("motor", "chiller"), ("battery", "chiller"), ("ambient", "chiller")]
    {
        let place = layout.member(member).zip(layout.circuit(circuit));
        let branch =
            place.and_then(|(member, circuit)| layout.branch(member, circuit)).expect("the default has it");
        branches_w_k[branch] = 150.0;
    }
    let mut cabins = [CabinConditions::default(); CABIN_PLACES];
    cabins[0] = CabinConditions {
        ventilation: plant.vehicle.cabin().ventilation(0.5, 0.3, 1.0),
        recovery: ExhaustRecovery { conductance_w_k: 20.0, meets_loop: false },
        panel_w_k: plant.vehicle.cabin().panel_conductance_w_k(20.0),
    };
    let constants = Constants { half_hoses_w_k: [5.0; _], soft_w_k: [50.0; _], hard_w_k: [60.0; _] };
    let now = Conditions {
        rates_w_k: &[900.0; _],
        branches_w_k: &branches_w_k,
        masses_w_k: [10.0; _],
        cabins,
        weights: [0.0; WEIGHT_PLACES],
        front_end_air_k: &[263.15; FRONT_END_PLACES],
        ambient_k: 263.15,
    };
    let ports: Vec<_> = layout.links.iter().map(|link| link.ports).collect();
    let known_first: Vec<_> = layout.inlets.iter().rev().map(|inlet| inlet.supply).collect();
    let network = PlannedNetwork::new(layout.nodes.len(), &ports, &known_first).expect("small");
    let assemble = |now: &Conditions<'_>, step: &mut PlannedStep| {
        let mut links = [LinkState::OPEN; MAXIMUM_LINKS];
        for (place, link) in links.iter_mut().zip(&layout.links) {
            *place = state(link.law, now, &constants);
        }
        network.factorise(plant.network.capacities_j_k(), &links, 1.0, step);
    };
    let (mut factors, start_k) = (PlannedStep::default(), run.state.temperatures_k);
    let mut sources_w = NodeValues::default();
    sources_w[layout.loops[0].supply.index()] = 3000.0;
    assemble(&now, &mut factors);
    let mut group = criterion.benchmark_group("thermal network");
    group.bench_function("assemble and factorise", |b| {
        b.iter(|| assemble(black_box(&now), black_box(&mut PlannedStep::default())));
    });
    group.bench_function("solve", |b| {
        b.iter(|| network.advance(&factors, black_box(&start_k), black_box(&sources_w)));
    });
    group.finish();
}

/// A second after ten minutes, by the executor that was compiled and by the one for any architecture.
fn executors(criterion: &mut Criterion) {
    let (experiment, mut run, _) = moment("jeffs2019/case1-4", 600);
    let command = experiment.rule_based_command(&mut run);
    let disturbance = experiment.disturbance(run.steps);
    let planned = (*experiment.plant).clone().with_planned_network();
    let mut group = criterion.benchmark_group("one second");
    for (name, plant) in [("compiled", &*experiment.plant), ("planned", &planned)] {
        group.bench_function(name, |bencher| {
            bencher.iter_batched_ref(
                || run.state,
                |state| black_box(plant.step(state, &command, &disturbance)),
                BatchSize::SmallInput,
            );
        });
    }
    group.finish();
}

fn controller(criterion: &mut Criterion) {
    let (experiment, run, _) = moment("jeffs2019/case1-4", 600);
    criterion.bench_function("HPCU", |bencher| {
        bencher.iter_batched_ref(
            || run,
            |run| black_box(experiment.rule_based_command(run)),
            BatchSize::SmallInput,
        );
    });
}

criterion_group!(benches, steps, refrigerant, network, executors, controller);
criterion_main!(benches);
