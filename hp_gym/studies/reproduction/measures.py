"""Figures that claims read from a run."""

import numpy as np

from hp_gym.trajectory import Trajectory

JOULE_PER_KWH = 3.6e6


def mean(run: Trajectory, column: str, start_s: float = 0.0) -> float:
    """Mean of a signal over the steps that begin at a time or later."""
    return float(np.mean(run[column][run["time_s"] > start_s]))


def value_at(run: Trajectory, column: str, time_s: float) -> float:
    """Value of a signal at a time."""
    return float(np.interp(time_s, run["time_s"], run[column]))


def energy_kwh(run: Trajectory, column: str, start_s: float = 0.0) -> float:
    """Integral of a power from a time to the end."""
    energies_j = run[column][1:] * np.diff(run["time_s"])
    return float(np.sum(energies_j[run["time_s"][1:] > start_s])) / JOULE_PER_KWH


def first_time_s(run: Trajectory, column: str, threshold: float) -> float:
    """First time at which a signal reaches a threshold, linear between samples; infinite if never."""
    values, time_s = run[column], run["time_s"]
    reached = np.flatnonzero(values >= threshold)
    if reached.size == 0:
        return float("inf")
    row = int(reached[0])
    if row == 0:
        return float(time_s[0])
    share = (threshold - values[row - 1]) / (values[row] - values[row - 1])
    return float(time_s[row - 1] + share * (time_s[row] - time_s[row - 1]))
