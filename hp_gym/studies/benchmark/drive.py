"""Controllers driven over scenarios, many trips at once."""

from __future__ import annotations

import os
import threading
from collections import defaultdict
from concurrent.futures import CancelledError, ThreadPoolExecutor
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np

from hp_gym.agents.controllers import ControllerError
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv
from hp_gym.studies.benchmark.kpis import measure

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    import pandas as pd
    from numpy.typing import NDArray

    from hp_gym.agents.controllers import Controller
    from hp_gym.studies.benchmark.grid import Scenario

Row: TypeAlias = "dict[str, Any]"
Progress: TypeAlias = "Callable[[int], None]"
"""Told of trips that have ended."""

Task: TypeAlias = "tuple[Controller, Sequence[Scenario]]"
"""A controller and the scenarios that it drives."""

_ENV_SEED: Final = 0


def drive_all(
    tasks: Sequence[Task],
    files: Mapping[str, Path],
    progress: Progress = lambda _: None,
    threads: int | None = None,
) -> list[list[Row]]:
    """Drives controllers over scenarios, as many controllers at a time as there are cores.

    Args:
        tasks: Controllers, each with its scenarios.
        files: File of each scenario by name.
        progress: Told of every trip that has ended.
        threads: Controllers at a time; results do not depend on it.

    Returns:
        For each controller a row of KPIs for each of its scenarios, in their order.

    Raises:
        ControllerError: A controller's environment cannot be made, or its actions do not fit.
    """
    workers = threads or os.cpu_count() or 1
    over = threading.Event()
    with ThreadPoolExecutor(workers) as pool:
        futures = [pool.submit(drive, *task, files, progress, over) for task in tasks]
        try:
            return [future.result() for future in futures]
        except BaseException:
            # Controllers under way end with their present step, not with their last trip.
            over.set()
            pool.shutdown(cancel_futures=True)
            raise


def drive(
    controller: Controller,
    scenarios: Sequence[Scenario],
    files: Mapping[str, Path],
    progress: Progress = lambda _: None,
    over: threading.Event | None = None,
) -> list[Row]:
    """Drives one controller over scenarios; see `drive_all`.

    Args:
        controller: Who drives.
        scenarios: What.
        files: File of each scenario by name.
        progress: Told of every trip that has ended.
        over: Ends all of it, once set.

    Raises:
        ControllerError: Its environment cannot be made, or its actions do not fit.
    """
    groups: dict[str, list[int]] = defaultdict(list)
    for place, scenario in enumerate(scenarios):
        groups[scenario.cycle.name].append(place)
    rows: list[Row] = [{} for _ in scenarios]
    # Trips of a cycle take equally long, so that no environment waits for others.
    for places in groups.values():
        chosen = [scenarios[place] for place in places]
        try:
            driven = _drive_group(controller, chosen, files, progress, over)
        except (ValueError, TypeError) as error:
            raise ControllerError(f"controller `{controller.name}`: {error}") from error
        for place, row in zip(places, driven, strict=True):
            rows[place] = row
    return rows


def _drive_group(
    controller: Controller,
    scenarios: Sequence[Scenario],
    files: Mapping[str, Path],
    progress: Progress,
    over: threading.Event | None,
) -> list[Row]:
    rows: list[Row] = [{} for _ in scenarios]
    env = _environment(controller, scenarios, files)
    try:
        observations, _ = env.reset(seed=_ENV_SEED)
        act = controller.begin(env)
        left = len(rows)
        while left:
            if over is not None and over.is_set():
                raise CancelledError
            observations, _, _, _, _ = env.step(act(observations))
            for trip in env.finished:
                # A stranded trip ends early; its environment drives on from the start, unseen.
                if not rows[trip.index]:
                    rows[trip.index] = measure(
                        controller, scenarios[trip.index], trip, env.layout(trip.index)
                    )
                    left -= 1
                    progress(1)
    finally:
        env.close()
    return rows


def trajectories(
    controller: Controller, scenarios: Sequence[Scenario], files: Mapping[str, Path]
) -> dict[str, pd.DataFrame]:
    """Signals of trips second by second, the start included, by the scenario's name.

    A controller that decides less often keeps its action in between, so that these are the trips that
    `drive` drives. Each table knows its vehicle.
    """
    import pandas as pd

    from hp_gym.vehicle_layout import keep

    interval_s = int(controller.environment.get("control_interval_s", 1))
    by_second = replace(controller, environment={**controller.environment, "control_interval_s": 1})
    tables = {}
    for scenario in scenarios:
        env = _environment(by_second, [scenario], files)
        try:
            observations, _ = env.reset(seed=_ENV_SEED)
            act = controller.begin(env)
            names, layout = list(env.signals(0)), env.layout(0)
            rows = [_look(env)]
            over = False
            while not over:
                action = act(observations)
                for _ in range(interval_s):
                    observations, _, terminated, _, _ = env.step(action)
                    rows.append(_look(env))
                    over = bool(terminated[0])
                    if over:
                        break
        finally:
            env.close()
        tables[scenario.name] = keep(pd.DataFrame(np.stack(rows), columns=names), layout)
    return tables


def _look(env: EVHeatPumpVectorEnv) -> NDArray[np.float64]:
    return np.fromiter(env.signals(0).values(), dtype=np.float64)


def _environment(
    controller: Controller, scenarios: Sequence[Scenario], files: Mapping[str, Path]
) -> EVHeatPumpVectorEnv:
    paths = [os.fspath(files[scenario.name]) for scenario in scenarios]
    return EVHeatPumpVectorEnv(len(paths), scenario=paths, threads=1, **controller.environment)
