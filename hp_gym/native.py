"""Native calls that Ctrl-C can stop, and that a forked process can make."""

import os
import signal
import sys
import threading
from collections.abc import Sequence
from concurrent.futures import CancelledError
from typing import Final

import numpy as np
from numpy.typing import NDArray

from hp_gym import _core

_TRIPS_AT_ONCE: Final = 64
"""Trips of one native call, a few tenths of a second; between two calls Python sees signals."""

_SUBSTEPS_AT_ONCE: Final = 500_000
"""Steps of the plant in one native call, as well some tenths of a second."""

_forked = False


def totals(scenarios: Sequence[str], overrides: Sequence[str] = ()) -> list[tuple[dict[str, float], str]]:
    """Totals of several scenarios with the same overrides, run side by side.

    In a forked process they run one after the other: threads do not outlive a fork, so that the core's own
    would be waited for without end.

    Args:
        scenarios: Names or paths.
        overrides: `key=value` replacements for all of them.

    Returns:
        For each scenario its totals by name, and why it ended.

    Raises:
        ConfigurationError: A name, key or value is not accepted.
    """
    if _forked:
        return [_core.Experiment(scenario, None, list(overrides)).totals() for scenario in scenarios]
    found = []
    for first in range(0, len(scenarios), _TRIPS_AT_ONCE):
        found += _core.totals(scenarios[first : first + _TRIPS_AT_ONCE], overrides)
    return found


def simulate(
    experiment: _core.Experiment, substeps: int = 1, over: threading.Event | None = None
) -> tuple[NDArray[np.float64], dict[str, float], str]:
    """Drives a scenario to its end with its own controller; the same whether in one native call or in many.

    Args:
        experiment: What is driven.
        substeps: Steps of the plant in a second, with which the experiment was made.
        over: Ends a long run early, once set.

    Returns:
        One row a second, totals, and why it ended.

    Raises:
        CancelledError: `over` was set.
    """
    if experiment.duration_s * substeps <= _SUBSTEPS_AT_ONCE:
        return experiment.simulate()
    run = experiment.start()
    rows = [run.look()]
    end_reason = None
    while end_reason is None:
        if over is not None and over.is_set():
            raise CancelledError
        end_reason = run.step(run.rule_based_command())
        rows.append(run.look())
    return np.stack(rows), run.summary(), end_reason


def _load_numpy_interface() -> None:
    """Lets the core find NumPy's C interface now.

    It looks for it the first time that it makes or takes an array, by way of Python, where a waiting signal
    is an error that the core cannot hand on.
    """
    blocked = None
    if sys.platform != "win32":
        blocked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        run = _core.Experiment(_core.names("scenario")[0]).start()
        run.look()
        run.step(run.rule_based_command())
    finally:
        if sys.platform != "win32" and blocked is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, blocked)


def _note_fork() -> None:
    global _forked  # noqa: PLW0603, a process is forked once and for all
    _forked = True


_load_numpy_interface()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_note_fork)
