//! The soak of `examples/soak.rs`, small.

#[path = "support/soak.rs"]
mod soak;

#[test]
fn adversarial_steps_leave_nothing_that_must_not_be() {
    let seen = soak::soak(60_000, 7);
    assert!(seen.sound(), "{seen}");
    // It went where it hurts.
    assert!(seen.trips >= 40 && seen.solves > 3000, "{seen}");
}
