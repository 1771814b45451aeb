//! Cost of a plant step, in time and, under callgrind, in instructions.
//!
//! `cargo run --release -p hp_trip --example step_cost -- heating` replays the compressor-on steps of the paper's
//! nine scenarios with the HPCU; `random` drives all built-in scenarios with random actions each second, `at-rest` the same with
//! the compressor off. A second argument is the number of repetitions; of each stretch the fastest counts. A third one, `planned`
//! instead of `own`, takes the executor for any architecture, a fourth drives the paper's scenarios with another vehicle, by name
//! or path. For instructions by function:
//! `valgrind --tool=callgrind --toggle-collect='*measured*' target/release/examples/step_cost heating 1`.

#[path = "../benches/support/workload.rs"]
mod workload;

use std::time::Instant;
use workload::{Car, Executor, Segment, compressor_on_segments, random_segments};

/// The part that is timed and counted.
#[inline(never)]
fn measured(segment: &Segment) -> f64 {
    segment.replay()
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let kind = arguments.next().unwrap_or_else(|| "heating".to_owned());
    let repetitions: u32 = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(20);
    let executor = match arguments.next().as_deref() {
        None | Some("own") => Executor::Own,
        Some("planned") => Executor::Planned,
        Some(other) => panic!("`{other}` is no executor; there are own and planned"),
    };
    let car = Car { executor, vehicle: arguments.next() };
    let segments = match kind.as_str() {
        "heating" => compressor_on_segments(&car),
        "random" => random_segments(&car, true),
        "at-rest" => random_segments(&car, false),
        other => panic!("`{other}` is no workload; there are heating, random and at-rest"),
    };
    let steps: usize = segments.iter().map(|segment| segment.steps).sum();
    // The fastest repetition of each stretch: other work on the machine rarely spares a whole round.
    let mut fastest_s = vec![f64::INFINITY; segments.len()];
    let mut checksum = 0.0;
    for _ in 0..repetitions {
        for (segment, fastest_s) in segments.iter().zip(&mut fastest_s) {
            let start = Instant::now();
            checksum += measured(segment);
            *fastest_s = fastest_s.min(start.elapsed().as_secs_f64());
        }
    }
    let microseconds = fastest_s.iter().sum::<f64>() * 1e6 / steps as f64;
    println!("{kind}: {steps} steps, {microseconds:.3} us a step (checksum {checksum})");
    if let Some((nodes, links)) = segments.first().map(Segment::network) {
        println!("network of {nodes} nodes and {links} links");
    }
}
