"""All published values beside the model."""

import os
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from hp_gym import _core
from hp_gym.studies import planned_runs
from hp_gym.studies.published_values import driven_cars, parked, published, rigs
from hp_gym.studies.published_values.judging import Judged, judge
from hp_gym.studies.published_values.published import (
    LayoutExperiment,
    ParkedExperiment,
    Published,
    RigExperiment,
    TripExperiment,
    ValidationFileError,
)
from hp_gym.studies.published_values.rigs import Figures


def validate(
    file: str | os.PathLike[str] = published.DEFAULT_FILE,
    *,
    cars: Mapping[str, str] | None = None,
    threads: int | None = None,
) -> tuple[Published, list[Judged]]:
    """Drives all experiments of a file of published values and judges its rows.

    Args:
        file: Name of a file in `configs/validation`, or a path.
        cars: Names or paths of vehicles that stand for cars of the file.
        threads: Native threads; one a processor by default.

    Returns:
        The file, and its rows with what the model says.

    Raises:
        ValidationFileError: Something in the file is wrong, or a trip does not end as it must.
        ConfigurationError: A vehicle, rig or trip has a flaw.
        OSError: A file cannot be read or written.
    """
    loaded = published.load(os.fspath(file))
    for car in cars or {}:
        if car not in loaded.cars:
            raise ValidationFileError(f"there is no car `{car}`; available: {', '.join(loaded.cars)}")
    vehicles = {**loaded.cars, **(cars or {})}
    with TemporaryDirectory(prefix="hp-gym-validate-") as folder:
        results = drive(loaded, vehicles, Path(folder), threads or planned_runs.processors())
    return loaded, judge(loaded, results)


def drive(
    loaded: Published, vehicles: Mapping[str, str], folder: Path, threads: int
) -> dict[str, dict[str, Figures]]:
    """Drives all experiments.

    Args:
        loaded: The file.
        vehicles: Names or paths of vehicles by the file's names of cars.
        folder: For traces.
        threads: Native threads.

    Returns:
        Figures by experiment and by car (or rig).
    """
    results: dict[str, dict[str, Figures]] = {}
    of_rigs: dict[str, Figures] = {}
    planned: list[driven_cars.Trip] = []
    for experiment in loaded.experiment:
        match experiment:
            case RigExperiment():
                of_rigs[experiment.name] = rigs.run(loaded, experiment, of_rigs, folder)
                vehicle = loaded.rig[experiment.rig].vehicle
                results[experiment.name] = {vehicle: of_rigs[experiment.name]}
            case ParkedExperiment():
                results[experiment.name] = {
                    car: parked.run(loaded, experiment, vehicles[car], folder) for car in experiment.cars
                }
            case TripExperiment():
                planned += driven_cars.plan(loaded, experiment, vehicles, folder)
            case LayoutExperiment():
                results[experiment.name] = {
                    experiment.vehicle: {"sets_of_sources": sets_of_sources(experiment.vehicle)}
                }
    return results | driven_cars.run(planned, threads)


def sets_of_sources(vehicle: str) -> float:
    """Number of sets, an empty one included, of members that can heat a loop that an evaporator cools.

    The cabin is left out: it is what is heated.
    """
    layout = _core.vehicle_layout(vehicle)
    cold = {loop["name"] for loop in layout["loops"] if loop["side"] == "cold" and loop["exchanger"]}
    cabins = {cabin["member"] for cabin in layout["cabins"]}
    sources = {
        branch["member"]
        for branch in layout["branches"]
        if branch["loop"] in cold and branch["direction"] == "into-loop" and branch["member"] not in cabins
    }
    return float(2 ** len(sources))
