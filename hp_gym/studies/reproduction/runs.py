"""The simulated counterparts of the paper's scenarios."""

import os
import threading
from collections.abc import Mapping, Sequence
from concurrent.futures import CancelledError, ThreadPoolExecutor
from time import perf_counter
from typing import TypeAlias

from hp_gym._core import Experiment
from hp_gym.trajectory import Trajectory

Runs: TypeAlias = Mapping[str, Trajectory]
"""Runs by the short names of the claims (S1..S5, D1..D4)."""


def simulate_all(
    scenarios: Sequence[str], overrides: Sequence[str] = (), substeps: int = 1
) -> tuple[list[Trajectory], float]:
    """Simulates scenarios side by side.

    Args:
        scenarios: Scenario names.
        overrides: `key=value` replacements for all of them.
        substeps: Steps of the plant in a second.

    Returns:
        Runs in the order of the scenarios, and the seconds that the simulations took, loading excluded.
    """
    experiments = [Experiment(scenario, None, overrides, substeps) for scenario in scenarios]
    over = threading.Event()

    def check() -> None:
        if over.is_set():
            raise CancelledError

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        start_s = perf_counter()
        futures = [pool.submit(experiment.simulate, check) for experiment in experiments]
        try:
            results = [future.result() for future in futures]
        except BaseException:
            over.set()
            pool.shutdown(cancel_futures=True)
            raise
        wall_s = perf_counter() - start_s
    runs = [
        Trajectory(
            scenario,
            experiment.controller,
            end,
            summary,
            experiment.limits(),
            values,
            tuple(experiment.signals()),
            experiment.layout(),
        )
        for scenario, experiment, (values, summary, end) in zip(scenarios, experiments, results, strict=True)
    ]
    return runs, wall_s
