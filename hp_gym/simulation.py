"""Whole runs of a scenario."""

import os
from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from hp_gym._core import Experiment, Run
from hp_gym.overrides import Overrides, assignments
from hp_gym.trajectory import Trajectory

Controller: TypeAlias = Callable[[Run], NDArray[np.float32]]
"""Anything that looks at a run and returns the command for its next second.

`hp_gym.observe(run)` gives it the signals by name, `hp_gym.encode(run.experiment, {...})` makes a command of
physical values, and `run.rule_based_command()` is what the scenario's own controller would do; that one has a
memory, so ask it once a step. What a controller remembers is its own affair: make a new one for each run.
"""


def simulate(
    scenario: str | os.PathLike[str],
    controller: str | os.PathLike[str] | Controller | None = None,
    overrides: Overrides | None = None,
    *,
    vehicle: str | os.PathLike[str] | None = None,
    substeps: int = 1,
) -> Trajectory:
    """Drives a scenario to its end.

    Args:
        scenario: Name (`hp_gym.names("scenario")` lists them) or path of a scenario file.
        controller: Name or path of a controller file, or a callable that returns the command for the next
            second (see `Controller`); by default the scenario's own heat pump control unit.
        overrides: Configuration values to change, by dotted key that begins with `scenario.`, `vehicle.` or
            `controller.`, for example `{"scenario.climate.ambient_temperature_degc": -7.0}`.
        vehicle: Name or path of a vehicle; that of the scenario by default.
        substeps: Steps of the plant in each second; controllers stay at one second.

    Returns:
        Everything that can be seen of the run, second by second, and its totals.

    Raises:
        ConfigurationError: A name, key or value is not accepted; the message names the file and the key.
        ValueError: `substeps` or a command of the controller is out of range.
    """
    scenario = os.fspath(scenario)
    changes = assignments(overrides)
    car = None if vehicle is None else os.fspath(vehicle)
    if callable(controller):
        experiment = Experiment(scenario, None, changes, substeps, car)
        values, summary, end_reason = _drive(experiment, controller)
        name = getattr(controller, "__name__", type(controller).__name__)
    else:
        chosen = None if controller is None else os.fspath(controller)
        experiment = Experiment(scenario, chosen, changes, substeps, car)
        values, summary, end_reason = experiment.simulate()
        name = chosen or experiment.controller
    return Trajectory(
        scenario=scenario,
        controller=name,
        end_reason=end_reason,
        summary=summary,
        limits=experiment.limits(),
        values=values,
        signals=tuple(experiment.signals()),
        layout=experiment.layout(),
    )


def _drive(
    experiment: Experiment, controller: Controller
) -> tuple[NDArray[np.float64], dict[str, float], str]:
    run = experiment.start()
    rows = [run.look()]
    end_reason = None
    while end_reason is None:
        command = np.ascontiguousarray(controller(run), dtype=np.float32)
        end_reason = run.step(command)
        rows.append(run.look())
    return np.stack(rows), run.summary(), end_reason
