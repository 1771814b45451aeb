"""Commands in physical units, for controllers that need not know how a command is normalised."""

from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from hp_gym import _core

ACTUATORS: Final[tuple[str, ...]] = tuple(name for name, _, _, _ in _core.actuators())
"""Names of all actuators of the default architecture in the order of a command."""


def encode(
    experiment: _core.Experiment,
    settings: Mapping[str, float | str],
    base: NDArray[np.float32] | None = None,
) -> NDArray[np.float32]:
    """Writes settings of named actuators as a command.

    Args:
        experiment: What is run; the ranges of some actuators are those of its vehicle.
        settings: A physical value for a level (`{"compressor_power": 800.0}`, 0 is off) and an option for a
            choice (`{"cabin": "htc", "ptc": "off"}`). `experiment.actuators()` lists them all.
        base: Command whose other values are kept, for example `run.rule_based_command()`. Without it,
            everything that is not set is isolated or off, with valves open and heat requests unlimited.

    Returns:
        A new command, one value in [-1, 1] for each actuator.

    Raises:
        ConfigurationError: There is no such actuator or option, or the value is outside its range.
        ValueError: `base` is not a command.
    """
    encoded = experiment.encode(dict(settings))
    if base is None:
        return encoded
    if np.shape(base) != encoded.shape:
        message = f"base has the shape {np.shape(base)}, but a command has the shape {encoded.shape}"
        raise ValueError(message)
    command = np.array(base, dtype=np.float32)
    rows = [experiment.actuator_names.index(name) for name in settings]
    command[rows] = encoded[rows]
    return command
