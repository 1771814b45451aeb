"""How often default observations are beyond their bounds, under adversarial actions on all built-in vehicles.

uv run python scripts/measure_clipping.py
"""

import argparse
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Final

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

import hp_gym
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

DISTRIBUTIONS: Final = ("train-v2", "test-v1")

Actions = Iterator[NDArray[np.int64]]


def at_random(counts: NDArray[np.int64], number: int, chance: np.random.Generator) -> Actions:
    """Other options every second."""
    while True:
        yield chance.integers(counts, size=(number, len(counts)))


def held(counts: NDArray[np.int64], number: int, chance: np.random.Generator) -> Actions:
    """Random options, each held for 10 minutes: long enough for temperatures to follow."""
    while True:
        chosen = chance.integers(counts, size=(number, len(counts)))
        for _ in range(600):
            yield chosen


def at_ends(counts: NDArray[np.int64], number: int, chance: np.random.Generator) -> Actions:
    """The first or the last option of everything, changed every minute."""
    while True:
        chosen = chance.integers(2, size=(number, len(counts))) * (counts - 1)
        for _ in range(60):
            yield chosen


def all_last(counts: NDArray[np.int64], number: int, chance: np.random.Generator) -> Actions:
    """Full power, random connections held for 5 minutes."""
    while True:
        chosen = chance.integers(counts, size=(number, len(counts)))
        chosen[:, -2:] = counts[-2:] - 1
        for _ in range(300):
            yield chosen


POLICIES: Final[dict[str, Callable[..., Actions]]] = {
    "random": at_random,
    "held": held,
    "ends": at_ends,
    "full power": all_last,
}


def clipped(
    vehicle: str, distribution: str, policy: str, number: int, steps: int
) -> tuple[float, Counter[str]]:
    """Drives environments.

    Returns:
        The share of observations with any value beyond its bounds, and that of each row.
    """
    envs = EVHeatPumpVectorEnv(
        number, vehicle=vehicle, distribution=distribution, autoreset_mode=AutoresetMode.DISABLED
    )
    envs.reset(seed=0)
    counts = envs.single_action_space.nvec  # type: ignore[attr-defined]
    actions = POLICIES[policy](counts, number, np.random.default_rng(1))
    seen, any_row, rows = 0.0, 0.0, Counter[str]()
    for step in range(steps):
        ended = envs.step(next(actions))[2]
        over = np.ones(number, dtype=np.bool_) if step == steps - 1 else ended
        for index in np.flatnonzero(over).tolist():
            summary = envs.summary(index)
            observations = summary["duration_s"] + 1.0
            seen += observations
            any_row += observations * summary["clipped_share"]
            rows.update({row: observations * share for row, share in envs.clipped_shares(index).items()})
        if ended.any() and step < steps - 1:
            envs.reset(options={"reset_mask": ended.copy()})
    envs.close()
    return any_row / seen, Counter({row: value / seen for row, value in rows.items() if value > 0.0})


def main() -> None:
    """Reads the command line and prints a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--environments", type=int, default=16)
    parser.add_argument("--steps", type=int, default=3600)
    arguments = parser.parse_args()
    shares = []
    print(f"{'vehicle':36} {'trips':10} {'actions':12} observations clipped, rows")
    for vehicle in hp_gym.names("vehicle"):
        for distribution in DISTRIBUTIONS:
            for policy in POLICIES:
                share, rows = clipped(vehicle, distribution, policy, arguments.environments, arguments.steps)
                shares.append(share)
                told = ", ".join(f"{row} {value:.3%}" for row, value in rows.most_common(4))
                print(f"{vehicle:36} {distribution:10} {policy:12} {share:.4%} {told}", flush=True)
    print(f"mean {np.mean(shares):.4%}, largest {np.max(shares):.4%}")


if __name__ == "__main__":
    main()
