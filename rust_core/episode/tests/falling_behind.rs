//! Environments whose car cannot follow its cycle.

use hp_episode::episode::{Clock, Episode, Outcome};
use hp_episode::random::Random;
use hp_episode::reward::Terms;
use hp_episode::setup::{Origin, Settings, Setup};
use hp_episode::vector::{Actions, Autoreset, Extras, PARTS, Results, Vector};
use hp_trip::run::EndReason;
use std::sync::Arc;

/// Environments of a car with so much power on US06 at -7 degC.
fn episodes(power_w: f64, count: usize) -> (Arc<Setup>, Vec<Episode>) {
    let overrides = [
        format!("vehicle.motor.maximum_mechanical_power_w={power_w:.1}"),
        "scenario.cycle=\"us06\"".to_owned(),
        "scenario.climate.ambient_temperature_degc=-7.0".to_owned(),
        "scenario.initial.soak_temperature_degc=-7.0".to_owned(),
    ];
    let settings = Settings {
        overrides: overrides.to_vec(),
        observations: vec!["default".to_owned(), "distance_behind_m".to_owned()],
        ..Settings::default()
    };
    let origin = Origin { scenario: Some("jeffs2019/case1-4".to_owned()), ..Origin::default() };
    let (setup, sources) = Setup::new(&settings, &vec![origin; count]).expect("built in");
    let episodes = sources.into_iter().map(|source| {
        let mut episode = Episode::new(Arc::clone(&setup), source);
        episode.reset(None).expect("built in");
        episode
    });
    let episodes = episodes.collect();
    (setup, episodes)
}

/// Levels of a second, the same wherever it is asked for.
fn levels(setup: &Setup, second: usize) -> Vec<i64> {
    let mut random = Random::seeded(second as u64 / 20);
    setup.actions.option_counts().iter().map(|&count| random.index(count) as i64).collect()
}

fn values(setup: &Setup, second: usize) -> Vec<f32> {
    let levels = levels(setup, second);
    levels.iter().enumerate().map(|(column, &level)| setup.actions.value(column, level as usize)).collect()
}

/// Steps to the end, or for so many seconds.
fn drive(episode: &mut Episode, from: usize, until: usize) -> Vec<Outcome> {
    let setup = Arc::clone(episode.setup());
    (from..until).map_while(|second| episode.step(&values(&setup, second))).collect()
}

fn seconds(episode: &Episode) -> usize {
    episode.run().expect("begun").steps
}

#[test]
fn a_state_taken_while_behind_goes_on_with_the_same_bits() {
    let (_, mut episodes) = episodes(30_000.0, 1);
    let episode = &mut episodes[0];
    let duration_s = episode.facts().expect("begun").duration_s;
    let mut at = 0;
    let mut states = Vec::new();
    // Amid the cycle, and while what is missing is driven.
    for until in [duration_s / 2, duration_s + 20] {
        drive(episode, at, until);
        at = until;
        assert!(episode.run().expect("begun").pace.behind_m > 10.0);
        states.push((at, episode.to_bytes(Clock::default()).expect("plain data")));
    }
    let tail = drive(episode, at, usize::MAX);
    assert_eq!(episode.end(), Some(EndReason::Arrived));
    let terms = *episode.terms().expect("begun");
    for (at, state) in states {
        let mut other = episode.clone();
        other.restore(&state).expect("its own");
        let outcomes = drive(&mut other, at, usize::MAX);
        assert_eq!(&outcomes[outcomes.len() - tail.len()..], &tail[..]);
        assert_eq!((other.terms(), seconds(&other)), (Some(&terms), seconds(episode)));
    }
}

#[test]
fn a_vector_drives_late_cars_as_each_alone() {
    let (setup, alone) = episodes(30_000.0, 3);
    let mut single = alone[0].clone();
    let mut vector = Vector::new(alone, Autoreset::Disabled, None, 2);
    (0..3).for_each(|index| vector.reset(index, None, None).expect("built in"));
    let width = setup.observations.rows().len();
    let (mut observations, mut rewards) = (vec![0.0; 3 * width], vec![0.0; 3]);
    let (mut terminated, mut truncated) = (vec![false; 3], vec![false; 3]);
    let mut seen = vec![0.0; width];
    let mut second = 0;
    let mut furthest = -1.0_f32;
    while single.end().is_none() {
        let row = levels(&setup, second);
        let outcome = single.step(&values(&setup, second)).expect("under way");
        single.observe(&mut seen);
        let mut results = Results {
            observations: &mut observations,
            rewards: &mut rewards,
            terminated: &mut terminated,
            truncated: &mut truncated,
            parts: &mut [0.0; 3 * PARTS],
            extras: Extras::default(),
        };
        vector.step(Actions::Levels(&row.repeat(3)), &mut results).expect("built in");
        for index in 0..3 {
            assert_eq!(rewards[index], outcome.reward, "second {second}");
            assert_eq!(observations[index * width..][..width], seen, "second {second}");
            assert_eq!(terminated[index], outcome.end.is_some());
        }
        furthest = furthest.max(seen[width - 1]);
        second += 1;
    }
    assert!(second > single.facts().expect("begun").duration_s + 30, "{second} s");
    assert!(furthest > -0.9, "the distance behind is seen: {furthest}");
}

/// Slower driving saves drag; what it saves must cost more than it is worth.
#[test]
fn a_slower_car_has_no_better_score() {
    let scores: Vec<(f64, Terms)> = [180_000.0, 60_000.0, 40_000.0, 30_000.0]
        .map(|power_w| {
            let (setup, mut episodes) = episodes(power_w, 1);
            // The same reference for all: that of the car that follows.
            let score: f64 =
                drive(&mut episodes[0], 0, usize::MAX).iter().map(|outcome| outcome.reward).sum();
            assert_eq!(episodes[0].end(), Some(EndReason::Arrived));
            let terms = *episodes[0].terms().expect("begun");
            (score - setup.reward.energy_per_kwh * terms.reference_energy_kwh, terms)
        })
        .to_vec();
    for pair in scores.windows(2) {
        let ((faster, one), (slower, other)) = (&pair[0], &pair[1]);
        assert!(
            other.delay_h > one.delay_h && other.chemical_energy_kwh < one.chemical_energy_kwh,
            "{other:?}"
        );
        assert!(slower < faster, "{slower} and {faster}: {one:?} {other:?}");
    }
}
