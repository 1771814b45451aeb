//! Plant step and whole runs: `cargo bench -p hp_plant`.

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use hp_plant::simulation::Experiment;
use std::hint::black_box;

fn whole_runs(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("run");
    group.sample_size(20);
    for name in ["jeffs2019/case1-1", "jeffs2019/case1-4", "ours/hot-soak-plus35"] {
        let experiment = Experiment::load(name, None, &[]).expect("built-in scenario");
        group.bench_function(name, |bencher| bencher.iter(|| black_box(experiment.totals())));
    }
    group.finish();
}

fn single_step(criterion: &mut Criterion) {
    let experiment = Experiment::load("jeffs2019/case1-4", None, &[]).expect("built-in scenario");
    let mut run = experiment.start();
    for _ in 0..600 {
        let command = experiment.rule_based_command(&mut run);
        experiment.step(&mut run, &command);
    }
    let command = experiment.rule_based_command(&mut run);
    let disturbance = experiment.disturbance(run.steps);
    criterion.bench_function("plant step, compressor on", |bencher| {
        bencher.iter_batched_ref(
            || run.state,
            |state| black_box(experiment.plant.step(state, &command, &disturbance)),
            BatchSize::SmallInput,
        );
    });
    criterion.bench_function("HPCU", |bencher| {
        bencher.iter_batched_ref(
            || run,
            |run| black_box(experiment.rule_based_command(run)),
            BatchSize::SmallInput,
        );
    });
}

criterion_group!(benches, whole_runs, single_step);
criterion_main!(benches);
