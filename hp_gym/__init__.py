"""An electric vehicle's heat pump and thermal system as a Gymnasium environment."""

from hp_gym import (  # isort: skip
    ctrl_c,  # noqa: F401, first: Ctrl-C may come while the rest is loaded
    processor,  # noqa: F401, second: it refuses to load an extension that cannot run here
)
from hp_gym._core import ConfigurationError, Experiment, InternalError, Run, StateError, __version__, names
from hp_gym.command import encode
from hp_gym.registration import register_envs
from hp_gym.signals import observe
from hp_gym.simulation import Controller, simulate
from hp_gym.trajectory import Trajectory

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

register_envs()
