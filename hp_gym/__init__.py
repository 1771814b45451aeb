"""An electric vehicle's heat pump and thermal system as a Gymnasium environment."""

from hp_gym import (
    ctrl_c,  # noqa: F401, first: Ctrl-C may come while the rest is loaded
    native,  # noqa: F401, first: it looks whether the extension can run here, and makes it ready
)
from hp_gym._core import ConfigurationError, Experiment, Run, __version__, names
from hp_gym.command import encode
from hp_gym.registration import register_envs
from hp_gym.signals import observe
from hp_gym.simulation import Controller, simulate
from hp_gym.trajectory import Trajectory

__all__ = [
    "ConfigurationError",
    "Controller",
    "Experiment",
    "Run",
    "Trajectory",
    "__version__",
    "encode",
    "names",
    "observe",
    "register_envs",
    "simulate",
]

register_envs()
