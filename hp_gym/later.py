"""Parts of higher layers that are reached from the top of the package, loaded when they are asked for.

`hp_gym.sweep` and a trajectory's picture need packages that extras bring and seconds to import.
"""

from importlib import import_module
from typing import Any, Final

FUNCTIONS: Final = {
    "calibrate": "hp_gym.studies.calibration.calibrating",
    "optimise": "hp_gym.studies.optimise.optimising",
    "replay": "hp_gym.studies.replay.replaying",
    "sweep": "hp_gym.studies.sweep.sweeping",
}
"""Module of each function that stands at the top of the package."""


def function(module: str, name: str) -> Any:
    """Returns what a module has under a name.

    Raises:
        MissingExtraError: The module needs a package that is not installed.
    """
    return getattr(import_module(module), name)
