"""A car at rest in a chamber: how it warms up, what it takes to keep it warm, how it cools down."""

from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from hp_gym import _core
from hp_gym.overrides import assignments
from hp_gym.studies import car_settings
from hp_gym.studies.published_values import speed_traces
from hp_gym.studies.published_values.published import ParkedExperiment, Published
from hp_gym.studies.published_values.rigs import Figures

AIR_J_KG_K: Final = 1006.0
"""Specific heat of air, the plant's."""

_WARM_DEGC: Final = 20.0
_HALF_HOUR_S: Final = 1800


def run(published: Published, experiment: ParkedExperiment, vehicle: str, folder: Path) -> Figures:
    """Lets a car stand and returns its figures.

    Args:
        published: The file.
        experiment: What is done.
        vehicle: Name or path of the car.
        folder: For the trace.
    """
    duration_s = round(60.0 * experiment.minutes)
    trace = speed_traces.write(folder / f"parked-{duration_s}.csv", speed_traces.constant(0.0, duration_s))
    changes = _changes(experiment, vehicle, trace)
    loaded = _core.Experiment(published.scenario, published.controller, assignments(changes), vehicle=vehicle)
    rows = _off(loaded) if experiment.off else loaded.simulate()[0][1:]
    signals = dict(zip(loaded.signal_names, rows.T, strict=True))
    cabin_degc, power_w = signals["cabin_temperature_degc"], signals["battery_power_w"]
    if experiment.off:
        return _cooling_down(cabin_degc, experiment)
    vent_degc = supply_temperature_degc(signals, loaded.layout(), experiment.ambient_degc)
    warm = np.flatnonzero(cabin_degc >= _WARM_DEGC)
    warm_s = int(warm[0]) + 1 if warm.size and cabin_degc[0] < _WARM_DEGC else None
    return {
        "kwh_to_20_degc": float(power_w[:warm_s].sum() / 3.6e6) if warm_s else np.nan,
        "minutes_to_20_degc": warm_s / 60.0 if warm_s else np.nan,
        "vent_after_60_s_degc": float(vent_degc[59]),
        "vent_after_300_s_degc": float(vent_degc[299]),
        "power_last_30_min_w": float(power_w[-_HALF_HOUR_S:].mean()),
        "cabin_last_30_min_degc": float(cabin_degc[-_HALF_HOUR_S:].mean()),
        "mean_power_w": float(power_w.mean()),
    }


def _changes(experiment: ParkedExperiment, vehicle: str, trace: Path) -> dict[str, Any]:
    changes = car_settings.climate(
        experiment.ambient_degc, experiment.relative_humidity, experiment.solar_gain_w, occupants=0
    )
    changes |= car_settings.used(vehicle, experiment.strategy)
    changes |= {
        "scenario.cycle": str(trace),
        "scenario.initial.state_of_charge_pct": 80.0,
        "controller.cabin_set_point_degc": experiment.set_point_degc,
    }
    if experiment.blower_level is not None:
        changes["controller.blower_level"] = experiment.blower_level
    if experiment.cabin_degc is not None:
        changes["scenario.initial.cabin_temperature_degc"] = experiment.cabin_degc
    return changes


def _off(loaded: _core.Experiment) -> NDArray[np.float64]:
    """Signals of every second with nothing running and as little fresh air as there can be."""
    run = loaded.start()
    ranges = dict(zip(loaded.actuator_names, loaded.actuator_ranges(), strict=True))
    cabin = loaded.layout()["cabins"][0]
    flap = cabin["recirculation_actuator"]
    closed = {cabin["blower_actuator"]: 0.0, flap: ranges[flap][1]}
    command = loaded.encode(
        {**closed, **{heater["actuator"]: "off" for heater in loaded.layout()["heaters"]}}
    )
    rows = []
    for _ in range(loaded.duration_s):
        run.step(command)
        rows.append(run.look())
    return np.array(rows)


def _cooling_down(cabin_degc: NDArray[np.float64], experiment: ParkedExperiment) -> Figures:
    start_degc = experiment.ambient_degc if experiment.cabin_degc is None else experiment.cabin_degc
    above_k = np.array([start_degc, cabin_degc[299], cabin_degc[1799]]) - experiment.ambient_degc
    return {
        "time_constant_0_5_min_s": float(300.0 / np.log(above_k[0] / above_k[1])),
        "time_constant_5_30_min_s": float(1500.0 / np.log(above_k[1] / above_k[2])),
        "cabin_after_5_min_degc": float(cabin_degc[299]),
        "cabin_after_30_min_degc": float(cabin_degc[1799]),
    }


def supply_temperature_degc(
    signals: dict[str, NDArray[np.float64]], layout: dict[str, Any], ambient_degc: float
) -> NDArray[np.float64]:
    """Temperature of the air that a cabin's outlets blow, from its heat flows.

    Args:
        signals: Columns by name.
        layout: What the car is made of.
        ambient_degc: Ambient air.
    """
    cabin = layout["cabins"][0]
    air_degc = signals[cabin["air"]]
    supply_w_k = AIR_J_KG_K * signals["supply_air_flow_kg_s"]
    above_k = air_degc - ambient_degc
    exhaust_w = signals[f"{cabin['member']}_exhaust_heat_flow_w"]
    # Without a difference it does not matter how much of the air is fresh.
    fresh_w_k = np.divide(exhaust_w, above_k, out=supply_w_k.copy(), where=np.abs(above_k) > 0.5)
    heat_w = signals[cabin["blower_power"]].copy()
    for heater in layout["heaters"]:
        if heater["heats"] == cabin["member"]:
            heat_w += signals[heater["power"]]
    for branch in layout["branches"]:
        if branch["member"] == cabin["member"]:
            heat_w += signals[branch["flow"]] * (1.0 if branch["direction"] == "out-of-loop" else -1.0)
    for exchanger in layout["exchangers"]:
        if exchanger["side"] == "cabin":
            sign = 1.0 if exchanger["level"] == "condensing" else -1.0
            heat_w += sign * signals[exchanger["flow"]]
    inlet_degc = air_degc - np.clip(fresh_w_k / supply_w_k, 0.0, 1.0) * above_k
    return np.asarray(inlet_degc + heat_w / supply_w_k, dtype=np.float64)
