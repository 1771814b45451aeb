//! Drives all built-in vehicles under adversarial commands and tells what was seen; fails where something must not be.
//!
//! `cargo run --release -p hp_episode --example soak -- --steps 10000000`; a seed may follow as `--seed 2`.

#[path = "../tests/support/soak.rs"]
mod soak;

use std::process::ExitCode;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let (mut steps, mut seed) = (200_000, 1);
    while let Some(name) = arguments.next() {
        let number = arguments.next().and_then(|text| text.replace('_', "").parse().ok());
        match (name.as_str(), number) {
            ("--steps", Some(number)) => steps = number,
            ("--seed", Some(number)) => seed = number,
            _ => {
                eprintln!("soak: `{name}` is no option with a whole number; there are --steps and --seed");
                return ExitCode::from(2);
            }
        }
    }
    let seen = soak::soak(steps, seed);
    print!("{seen}");
    if seen.sound() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
