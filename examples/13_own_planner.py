"""A planner of one's own: every minute it tries ways to go on in copies of the car, and drives the best."""

import gymnasium as gym
import numpy as np

import hp_gym  # noqa: F401

SCENARIO = "ours/commute-minus5"
MINUTES = 15
LOOK_AHEAD_S = 300
EVERY_S = 60

# What each way changes of the rules: an actuator and its value from -1 (off) to 1.
WAYS: dict[str, tuple[str, float] | None] = {
    "rules": None,
    "without PTC": ("ptc", -1.0),
    "without heat pump": ("compressor_power", -1.0),
}


def drive(envs: gym.vector.VectorEnv, ways: list[str], seconds: int) -> np.ndarray:
    """Drives every environment on in its way; returns what each was paid."""
    core = envs.unwrapped
    paid = np.zeros(len(ways))
    for _ in range(seconds):
        actions = core.rule_based_actions()
        for row, way in enumerate(ways):
            if (change := WAYS[way]) is not None:
                actions[row, core.action_names.index(change[0])] = change[1]
        _, rewards, _, _, _ = envs.step(actions)
        paid += rewards
    return paid


def main() -> None:
    """Drives some minutes by plan, and by the rules alone from the same start."""
    ways = list(WAYS)
    envs = gym.make_vec("EVHeatPumpContinuous-v0", num_envs=len(ways), scenario=SCENARIO, actions="hpcu")
    core = envs.unwrapped
    envs.reset(seed=0)
    start = core.get_state()
    by_rules = drive(envs, ["rules"] * len(ways), 60 * MINUTES)[0]
    core.set_state(start)
    by_plan, plan = 0.0, []
    for _ in range(60 * MINUTES // EVERY_S):
        now = core.get_state([0])[0]
        best = ways[int(drive(envs, ways, LOOK_AHEAD_S).argmax())]
        core.set_state([now] * len(ways))
        by_plan += drive(envs, [best] * len(ways), EVERY_S)[0]
        plan.append(best)
    print(f"plan: {', '.join(plan)}")
    print(f"paid by the rules {by_rules:.2f}, by the plan {by_plan:.2f}")


if __name__ == "__main__":
    main()
