//! What an environment adds to a plant step, and many environments at once: `cargo bench -p hp_episode`.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hp_episode::episode::Episode;
use hp_episode::random::Random;
use hp_episode::reference::{ReferenceConditions, ReferenceTrip};
use hp_episode::setup::{Origin, Settings, Setup, Source};
use hp_episode::vector::{Actions, Autoreset, Extras, PARTS, Results, Vector};
use std::hint::black_box;
use std::sync::Arc;

fn setup() -> (Arc<Setup>, Source) {
    let origin = Origin { distribution: Some("train-v2".to_owned()), ..Origin::default() };
    let (setup, mut sources) = Setup::new(&Settings::default(), &[origin]).expect("built in");
    (setup, sources.remove(0))
}

/// Environments on their way, with random levels for some steps.
struct Driven {
    vector: Vector,
    levels: Vec<Vec<i64>>,
    observations: Vec<f32>,
    numbers: Vec<f64>,
    flags: Vec<bool>,
    step: usize,
}

impl Driven {
    fn new(count: usize, threads: usize) -> Self {
        let (setup, source) = setup();
        let episodes = (0..count).map(|_| Episode::new(Arc::clone(&setup), source.clone())).collect();
        let mut vector = Vector::new(episodes, Autoreset::NextStep, None, threads);
        for index in 0..count {
            vector.reset(index, Some(index as u64), None).expect("built in");
        }
        let mut random = Random::seeded(1);
        let counts = setup.actions.option_counts();
        let levels = (0..20)
            .map(|_| (0..count).flat_map(|_| counts.to_vec()).map(|n| random.index(n) as i64).collect())
            .collect();
        let mut driven = Self {
            vector,
            levels,
            observations: vec![0.0; count * setup.observations.rows().len()],
            numbers: vec![0.0; count * (1 + PARTS)],
            flags: vec![false; count * 2],
            step: 0,
        };
        for _ in 0..100 {
            driven.step();
        }
        driven
    }

    fn step(&mut self) {
        let count = self.flags.len() / 2;
        let (rewards, parts) = self.numbers.split_at_mut(count);
        let (terminated, truncated) = self.flags.split_at_mut(count);
        let observations = &mut self.observations;
        let mut results =
            Results { observations, rewards, terminated, truncated, parts, extras: Extras::default() };
        let levels = &self.levels[self.step % self.levels.len()];
        self.step += 1;
        black_box(self.vector.step(Actions::Levels(levels), &mut results).expect("built in"));
    }
}

fn parts(criterion: &mut Criterion) {
    let mut driven = Driven::new(1, 1);
    let (setup, _) = setup();
    let episode = &mut driven.vector.episodes_mut()[0];
    let mut row = vec![0.0; setup.observations.rows().len()];
    criterion.bench_function("observation", |bencher| bencher.iter(|| episode.observe(black_box(&mut row))));

    let (_, experiment) = episode.trip().expect("begun");
    let conditions = ReferenceConditions::of(experiment);
    let run = episode.run().expect("begun");
    let disturbance = experiment.disturbance(run.steps);
    criterion.bench_function("second of the reference trip", |bencher| {
        bencher.iter(|| {
            let mut trip = ReferenceTrip::start(experiment, run.state.battery);
            black_box(trip.step(black_box(experiment), &conditions))
        });
    });
    let command = driven.vector.episodes_mut()[0].rule_based_command().expect("begun");
    criterion.bench_function("plant step", |bencher| {
        let (_, experiment) = driven.vector.episodes()[0].trip().expect("begun");
        let state = driven.vector.episodes()[0].run().expect("begun").state;
        bencher.iter(|| {
            let mut state = state;
            black_box(experiment.plant.step(&mut state, black_box(&command), &disturbance))
        });
    });
}

fn together(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("vector step");
    for threads in [1, 2] {
        for count in [1, 64, 1024, 4096] {
            let mut driven = Driven::new(count, threads);
            group.throughput(Throughput::Elements(count as u64));
            let id = BenchmarkId::new(format!("{threads} threads"), count);
            group.bench_function(id, |bencher| bencher.iter(|| driven.step()));
        }
    }
    group.finish();
}

fn resets(criterion: &mut Criterion) {
    let mut driven = Driven::new(1, 1);
    let episode = &mut driven.vector.episodes_mut()[0];
    criterion.bench_function("reset", |bencher| bencher.iter(|| episode.reset(None).expect("built in")));
}

criterion_group!(benches, parts, together, resets);
criterion_main!(benches);
