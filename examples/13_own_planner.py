"""A planner of one's own: every minute it tries ways to go on in forks of the car, and drives the best."""

import gymnasium as gym
import numpy as np

import hp_gym  # noqa: F401

# What each way changes of the rules: an actuator and its value from -1 (off) to 1.
WAYS = {
    "rules": None,
    "without PTC": ("ptc", -1.0),
    "without heat pump": ("compressor_power", -1.0),
}
MINUTES, LOOK_AHEAD_S, EVERY_S = 15, 300, 60


def drive(core: gym.vector.VectorEnv, ways: list[str], seconds: int) -> np.ndarray:
    """Drives every environment on in its way; returns what each was paid."""
    paid = np.zeros(len(ways))
    for _ in range(seconds):
        actions = core.rule_based_actions()
        for row, way in enumerate(ways):
            if (change := WAYS[way]) is not None:
                actions[row, core.action_names.index(change[0])] = change[1]
        paid += core.step(actions)[1]
    return paid


def main() -> None:
    """Drives some minutes by plan, and by the rules alone from the same snapshot."""
    ways, rules, plan, paid = list(WAYS), ["rules"] * len(WAYS), [], 0.0
    options = {"scenario": "ours/commute-minus5", "actions": "hpcu"}
    core = gym.make_vec("EVHeatPumpContinuous-v0", num_envs=len(ways), **options).unwrapped
    core.reset(seed=0)
    core.fork([0] * len(ways))
    start = core.get_state()
    by_rules = drive(core, rules, 60 * MINUTES)[0]
    core.set_state(start)
    for _ in range(60 * MINUTES // EVERY_S):
        now = core.get_state()
        plan.append(ways[drive(core, ways, LOOK_AHEAD_S).argmax()])
        core.set_state(now)
        paid += drive(core, [plan[-1]] * len(ways), EVERY_S)[0]
    print(f"plan: {', '.join(plan)}")
    print(f"paid by the rules {by_rules:.2f}, by the plan {paid:.2f}")


if __name__ == "__main__":
    main()
