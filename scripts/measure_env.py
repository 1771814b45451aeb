"""Measures what levels cost the HPCU: energy of the paper's scenarios against continuous values.

uv run python scripts/measure_env.py
"""

from typing import Any

import gymnasium as gym

import hp_gym
from hp_gym.policies import HpcuPolicy


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
    for scenario in [name for name in hp_gym.names("scenario") if name.startswith("jeffs2019/")]:
        hpcu, default = cost_of_levels(scenario, "hpcu"), cost_of_levels(scenario, "default")
        print(f"{scenario} on levels: {hpcu:+.2f} % energy, {default:+.2f} % with the default ones")


if __name__ == "__main__":
    main()
