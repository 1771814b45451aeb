//! Steps environments with random actions, for a profiler that counts instructions:
//!
//! `cargo build --release -p hp_episode --example steps`, then
//! `valgrind --tool=callgrind target/release/examples/steps 64 200 1` (environments, steps, threads).
//!
//! A fourth number repeats the same trips; vehicles may follow, and at the end `--info` for costs and action masks. Every call's shortest time of all rounds is what it takes undisturbed.

use hp_episode::episode::Episode;
use hp_episode::random::Random;
use hp_episode::setup::{Origin, Settings, Setup};
use hp_episode::vector::{Actions, Autoreset, Extras, PARTS, Results, Vector};
use std::sync::Arc;
use std::time::Instant;

fn main() {
    let number = |place: usize, default: usize| {
        std::env::args().nth(place).map_or(default, |text| text.parse().expect("a whole number"))
    };
    let (count, steps, threads, rounds) = (number(1, 64), number(2, 200), number(3, 1), number(4, 1));
    // Further names are vehicles, which the environments have in turn.
    let mut vehicles: Vec<String> = std::env::args().skip(5).collect();
    let told = vehicles.pop_if(|last| last == "--info").is_some();
    let vehicle = |index: usize| vehicles.get(index % vehicles.len().max(1)).cloned();
    let origin = |index| Origin {
        distribution: Some("train-v1".to_owned()),
        vehicle: vehicle(index),
        ..Origin::default()
    };
    let origins: Vec<Origin> = (0..count).map(origin).collect();
    let (setup, sources) = Setup::new(&Settings::default(), &origins).expect("vehicles");
    let episodes = sources.into_iter().map(|source| Episode::new(Arc::clone(&setup), source)).collect();
    let mut vector = Vector::new(episodes, Autoreset::NextStep, None, threads);
    let counts = setup.actions.option_counts();
    let mut levels = vec![0; count * counts.len()];
    let mut observations = vec![0.0; count * setup.observations.rows().len()];
    let mut rewards = vec![0.0; count];
    let mut parts = vec![0.0; count * PARTS];
    let mut costs = vec![0.0; if told { count } else { 0 }];
    let mut masks = vec![false; if told { count * setup.actions.mask_length() } else { 0 }];
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
                extras: Extras { costs: &mut costs, masks: &mut masks, ..Extras::default() },
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
