"""An electric vehicle's heat pump and thermal system as a Gymnasium environment."""

from hp_gym import (  # isort: skip
    ctrl_c,  # noqa: F401, first: Ctrl-C may come while the rest is loaded
    processor,  # noqa: F401, second: it refuses to load an extension that cannot run here
)
from typing import TYPE_CHECKING, Any

from hp_gym import later
from hp_gym._core import ConfigurationError, Experiment, InternalError, Run, StateError, __version__, names
from hp_gym.command import encode
from hp_gym.registration import register_envs
from hp_gym.signals import observe
from hp_gym.simulation import Controller, simulate
from hp_gym.trajectory import Trajectory

if TYPE_CHECKING:
    from hp_gym.studies.calibration.calibrating import calibrate as calibrate
    from hp_gym.studies.optimise.optimising import optimise as optimise
    from hp_gym.studies.replay.replaying import replay as replay
    from hp_gym.studies.sweep.sweeping import sweep as sweep

__all__ = [
    "ConfigurationError",
    "Controller",
    "Experiment",
    "InternalError",
    "Run",
    "StateError",
    "Trajectory",
    "__version__",
    "encode",
    "names",
    "observe",
    "register_envs",
    "simulate",
]


def __getattr__(name: str) -> Any:
    """Loads a function of the studies when it is asked for."""
    if name in later.FUNCTIONS:
        return later.function(later.FUNCTIONS[name], name)
    message = f"module {__name__!r} has no attribute {name!r}"
    raise AttributeError(message)


def __dir__() -> list[str]:
    """Names for completion; `from hp_gym import *` takes only those that need no extra."""
    return sorted({*globals(), *later.FUNCTIONS})


register_envs()
