//! Steps environments with random actions, for a profiler that counts instructions:
//!
//! `cargo build --release -p hp_episode --example steps`, then
//! `valgrind --tool=callgrind target/release/examples/steps 64 200 1` (environments, steps, threads).
//!
//! A fourth number repeats the same trips. Every call's shortest time of all rounds is what it takes undisturbed.

use hp_episode::action;
use hp_episode::episode::Episode;
use hp_episode::random::Random;
use hp_episode::setup::{Settings, Setup};
use hp_episode::vector::{Actions, Autoreset, PARTS, Results, Vector};
use hp_plant::command::ACTUATORS;
use std::sync::Arc;
use std::time::Instant;

fn main() {
    let number = |place: usize, default: usize| {
        std::env::args().nth(place).map_or(default, |text| text.parse().expect("a whole number"))
    };
    let (count, steps, threads, rounds) = (number(1, 64), number(2, 200), number(3, 1), number(4, 1));
    let names = ACTUATORS[..action::DEFAULT_ROWS].iter().map(|actuator| actuator.name.to_owned());
    let settings = Settings {
        continuous: false,
        actions: names.collect(),
        observations: vec!["default".to_owned()],
        reward: "balanced".to_owned(),
        reward_overrides: Vec::new(),
        overrides: Vec::new(),
        control_interval_s: 1,
        sensor_noise: 0.0,
    };
    let setup = Arc::new(Setup::new(&settings).expect("built in"));
    let source = setup.distribution("train-v1").expect("built in");
    let episodes = (0..count).map(|_| Episode::new(Arc::clone(&setup), source.clone())).collect();
    let mut vector = Vector::new(episodes, Autoreset::NextStep, None, threads);
    let counts = setup.actions.option_counts();
    let mut levels = vec![0; count * counts.len()];
    let mut observations = vec![0.0; count * setup.observations.rows().len()];
    let mut rewards = vec![0.0; count];
    let mut parts = vec![0.0; count * PARTS];
    let (mut terminated, mut truncated) = (vec![false; count], vec![false; count]);
    let (mut sum, mut all_s, mut shortest_s) = (0.0, 0.0, vec![f64::INFINITY; steps]);
    for _ in 0..rounds {
        sum = 0.0;
        for index in 0..count {
            vector.reset(index, Some(index as u64), None).expect("built in");
        }
        let mut random = Random::seeded(1);
        for shortest_s in &mut shortest_s {
            for (place, level) in levels.iter_mut().enumerate() {
                *level = random.index(counts[place % counts.len()]) as i64;
            }
            let mut results = Results {
                observations: &mut observations,
                rewards: &mut rewards,
                terminated: &mut terminated,
                truncated: &mut truncated,
                parts: &mut parts,
            };
            let start = Instant::now();
            vector.step(Actions::Levels(&levels), &mut results).expect("built in");
            let passed_s = start.elapsed().as_secs_f64();
            *shortest_s = shortest_s.min(passed_s);
            all_s += passed_s;
            sum += rewards.iter().sum::<f64>();
        }
    }
    let per_environment_ns = |calls_s: f64, calls: usize| calls_s / (calls * count) as f64 * 1e9;
    println!(
        "sum of rewards {sum:?}; an environment's step {:.0} ns, undisturbed {:.0} ns, in the fastest call {:.0} ns",
        per_environment_ns(all_s, steps * rounds),
        per_environment_ns(shortest_s.iter().sum(), steps),
        per_environment_ns(shortest_s.iter().copied().fold(f64::INFINITY, f64::min), 1)
    );
    println!("size of an episode {} bytes", size_of::<Episode>());
}
