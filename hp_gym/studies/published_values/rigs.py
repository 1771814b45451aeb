"""A vehicle as a rig: room at a temperature, compressor at a speed, one size set to a published capacity."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np

from hp_gym import _core
from hp_gym.overrides import assignments
from hp_gym.studies.published_values import speed_traces
from hp_gym.studies.published_values.published import Published, Rig, RigExperiment

FRONT_AIR_SPEED_KM_H: Final = 72.0
"""With a ram air share of 0.2 it is 4 m/s at the front-end exchanger."""

Figures = dict[str, float]
"""What an experiment gives, by name."""

_FIRST_POWER_W: Final = 500.0
_SETTLED_S: Final = 60
_LARGEST_SPEED_ERROR: Final = 0.01
_CLOSEST: Final = 1e-4
_MOST_TRIES: Final = 12


def run(
    published: Published, experiment: RigExperiment, known: Mapping[str, Figures], folder: Path
) -> Figures:
    """Drives a rig to a steady point, setting its displacement where a capacity is published.

    Args:
        published: The file.
        experiment: What is driven.
        known: Figures of experiments above it.
        folder: For the trace.

    Returns:
        Its figures; NaN throughout where the compressor does not reach the speed.
    """
    rig = published.rig[experiment.rig]
    trace = speed_traces.write(
        folder / f"{experiment.name}.csv", speed_traces.constant(FRONT_AIR_SPEED_KM_H, experiment.duration_s)
    )
    changes = _changes(published, rig, experiment, trace)
    if experiment.displacement_of is not None:
        return _steady(rig, experiment, changes, known[experiment.displacement_of]["displacement_cm3"])
    if experiment.capacity_w is None:
        return _steady(rig, experiment, changes, None)
    return _sized(rig, experiment, changes, experiment.capacity_w)


def _sized(rig: Rig, experiment: RigExperiment, changes: Mapping[str, Any], capacity_w: float) -> Figures:
    """Capacity rises with displacement, a little less than in proportion."""
    displacement_cm3 = 27.0
    figures = _steady(rig, experiment, changes, displacement_cm3)
    for _ in range(_MOST_TRIES):
        ratio = capacity_w / figures["capacity_w"]
        if abs(ratio - 1.0) < _CLOSEST or not np.isfinite(ratio):
            break
        displacement_cm3 = float(np.clip(displacement_cm3 * ratio**1.3, 5.0, 200.0))
        figures = _steady(rig, experiment, changes, displacement_cm3)
    return figures


def _changes(published: Published, rig: Rig, experiment: RigExperiment, trace: Path) -> dict[str, Any]:
    vehicle = {**published.bench, **rig.changes, **experiment.changes}
    vehicle = {key: value for key, value in vehicle.items() if _has(rig.vehicle, key)}
    climate = {
        "ambient_temperature_degc": experiment.ambient_degc,
        "relative_humidity": 0.0,
        "solar_gain_w": 0.0,
        "occupants": 0,
    }
    initial = {"state_of_charge_pct": 80.0, "cabin_temperature_degc": experiment.room_degc}
    if experiment.bath_degc is not None:
        initial["battery_temperature_degc"] = experiment.bath_degc
    return {
        "scenario.cycle": str(trace),
        **{f"scenario.climate.{key}": value for key, value in climate.items()},
        **{f"scenario.initial.{key}": value for key, value in initial.items()},
        **{f"vehicle.{key}": value for key, value in vehicle.items()},
    }


def _has(vehicle: str, key: str) -> bool:
    """Recovery of exhaust heat is a matter of some vehicles only."""
    return key != "cabin.exhaust_recovery_share" or bool(
        _core.vehicle_layout(vehicle)["cabins"][0]["exhaust_recovery"]
    )


def _steady(
    rig: Rig, experiment: RigExperiment, changes: Mapping[str, Any], displacement_cm3: float | None
) -> Figures:
    own = (
        {}
        if displacement_cm3 is None
        else {"vehicle.refrigeration.compressor.displacement_cm3": displacement_cm3}
    )
    loaded = _core.Experiment(
        "jeffs2019/case1-1", overrides=assignments({**changes, **own}), vehicle=rig.vehicle
    )
    rows = _drive(loaded, rig, experiment)
    column = dict(zip(loaded.signal_names, rows[-_SETTLED_S:].mean(axis=0), strict=True))
    speed_rev_s = column["compressor_speed_rev_s"]
    capacity_w, power_w = column[f"{rig.judged}_heat_flow_w"], column["compressor_power_w"]
    figures = {
        "capacity_w": capacity_w,
        "power_w": power_w,
        "cop": capacity_w / power_w if power_w > 0.0 else np.nan,
        "discharge_degc": column["discharge_temperature_degc"],
        "condensing_degc": column["condensing_temperature_degc"],
        "evaporating_degc": column["evaporating_temperature_degc"],
        "speed_rev_s": speed_rev_s,
        "displacement_cm3": displacement_cm3 or np.nan,
    }
    if abs(speed_rev_s / experiment.speed_rev_s - 1.0) > _LARGEST_SPEED_ERROR:
        return dict.fromkeys(figures, np.nan)
    return {name: float(value) for name, value in figures.items()}


def _drive(
    loaded: _core.Experiment, rig: Rig, experiment: RigExperiment
) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Signals of every second; the compressor's power is led until its speed is right."""
    run = loaded.start()
    ranges = dict(zip(loaded.actuator_names, loaded.actuator_ranges(), strict=True))
    lowest_w, highest_w = ranges["compressor_power"]
    speed = loaded.signal_names.index("compressor_speed_rev_s")
    air: dict[str, float | str] = {
        "ptc": "off",
        "blower_level": 1.0,
        "recirculation": experiment.recirculation,
    }
    power_w, rows = _FIRST_POWER_W, []
    for _ in range(experiment.duration_s):
        power_w = min(max(power_w, lowest_w), highest_w)
        run.step(loaded.encode({**air, **rig.settings, "compressor_power": power_w}))
        rows.append(run.look())
        found = rows[-1][speed]
        if found > 0.0:
            power_w *= float(np.clip((experiment.speed_rev_s / found) ** 0.5, 0.98, 1.02))
    return np.array(rows)
