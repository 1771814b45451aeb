"""Measures the environments: steps per second against CartPole-v1, and what levels cost the HPCU.

uv run python scripts/measure_env.py
"""

import time
from collections.abc import Callable
from typing import Any, Final

import gymnasium as gym

import hp_gym
from hp_gym.policies import HpcuPolicy

STEPS: Final = 60_000
REPEATS: Final = 3


def best(measure: Callable[[], float]) -> float:
    """Returns the best of several measurements: others disturb, none helps."""
    return max(measure() for _ in range(REPEATS))


def single(env_id: str) -> float:
    """Returns steps per second of one environment with random actions."""
    env: gym.Env[Any, Any] = gym.make(env_id)
    env.action_space.seed(0)
    actions = [env.action_space.sample() for _ in range(1000)]
    env.reset(seed=0)
    start = time.perf_counter()
    for step in range(STEPS):
        _, _, terminated, truncated, _ = env.step(actions[step % 1000])
        if terminated or truncated:
            env.reset()
    return STEPS / (time.perf_counter() - start)


def vector(env_id: str, count: int) -> tuple[float, float]:
    """Returns steps per second, by the clock and by processor time, of many environments at once."""
    envs = gym.make_vec(env_id, num_envs=count)
    envs.action_space.seed(0)
    actions = [envs.action_space.sample() for _ in range(20)]
    envs.reset(seed=0)
    envs.step(actions[0])
    rounds = max(20, 200_000 // count)
    clock, processor = time.perf_counter(), time.process_time()
    for step in range(rounds):
        envs.step(actions[step % 20])
    steps = rounds * count
    return steps / (time.perf_counter() - clock), steps / (time.process_time() - processor)


def cost_of_levels(scenario: str, actions: str) -> float:
    """Returns by how many percent the energy of the rule-based controller differs on levels."""
    env = gym.make("EVHeatPump-v0", scenario=scenario, actions=actions)
    policy = HpcuPolicy(env)
    env.reset()
    over = False
    while not over:
        _, _, over, _, _ = env.step(policy())
    inner: Any = env.unwrapped
    energy_kwh: float = inner.summary()["energy_kwh"]
    return 100.0 * (energy_kwh / hp_gym.simulate(scenario).summary["energy_kwh"] - 1.0)


def main() -> None:
    """Prints everything."""
    cart_pole = best(lambda: single("CartPole-v1"))
    ours = best(lambda: single("EVHeatPump-v0"))
    print(f"single: {ours:,.0f} steps/s, CartPole-v1 {cart_pole:,.0f}, ratio {ours / cart_pole:.2f}")
    for count in (64, 1024):
        results = [vector("EVHeatPump-v0", count) for _ in range(REPEATS)]
        clock, processor = max(result[0] for result in results), max(result[1] for result in results)
        print(
            f"{count} at once: {clock:,.0f} steps/s ({processor:,.0f} a core), "
            f"ratio to a single CartPole-v1 {clock / cart_pole:.2f}"
        )
    for scenario in [name for name in hp_gym.names("scenario") if name.startswith("jeffs2019/")]:
        hpcu, default = cost_of_levels(scenario, "hpcu"), cost_of_levels(scenario, "default")
        print(f"{scenario} on levels: {hpcu:+.2f} % energy, {default:+.2f} % with the default ones")


if __name__ == "__main__":
    main()
