"""Measures what levels and longer control intervals cost the rules.

Levels: energy of the paper's scenarios with the HPCU against continuous values. Intervals: energy and
discomfort of the tuned rules over training trips, against a decision every second.

uv run python scripts/measure_env.py
"""

from typing import Any

import gymnasium as gym

import hp_gym
from hp_gym.agents.training.trips import drive
from hp_gym.envs.hpcu_policy import HpcuPolicy
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

TRIPS = 400
FIRST_SEED = 3_000_000


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


def tuned_rules(control_interval_s: int) -> tuple[float, float]:
    """Returns the tuned rules' attributable energy a trip [kWh] and mean discomfort of trips [K]."""
    envs = EVHeatPumpVectorEnv(
        TRIPS,
        continuous=True,
        actions=HpcuPolicy.ACTIONS,
        control_interval_s=control_interval_s,
        overrides={"scenario.controller": "hpcu-tuned"},
    )
    seeds = range(FIRST_SEED, FIRST_SEED + TRIPS)
    driven = drive(envs, seeds, lambda *_: envs.rule_based_actions())
    return float(driven.attributable_energy_kwh.mean()), float(driven.discomfort_k.mean())


def main() -> None:
    """Prints everything."""
    for scenario in [name for name in hp_gym.names("scenario") if name.startswith("jeffs2019/")]:
        hpcu, default = cost_of_levels(scenario, "hpcu"), cost_of_levels(scenario, "default")
        print(f"{scenario} on levels: {hpcu:+.2f} % energy, {default:+.2f} % with the default ones")
    base_kwh, base_k = tuned_rules(1)
    for interval_s in (10, 30, 60):
        energy_kwh, discomfort_k = tuned_rules(interval_s)
        change_pct = 100.0 * (energy_kwh / base_kwh - 1.0)
        print(
            f"hpcu-tuned, a decision every {interval_s} s: {change_pct:+.2f} % attributable energy, "
            f"{discomfort_k - base_k:+.3f} K"
        )


if __name__ == "__main__":
    main()
