"""Rule-based controllers: the HPCU with the numbers of a controller file."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Final

import hp_gym
from hp_gym.agents.controllers.controller import Act, Controller, ControllerError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hp_gym.envs.vector_env import EVHeatPumpVectorEnv
    from hp_gym.overrides import Value

FILES: Final = ("hpcu", "hpcu-modern", "hpcu-best-mode", "hpcu-tuned-strict", "hpcu-tuned")
"""Rule-based controllers of the comparison, each a file in configs/controllers."""

# The PTC warms the high temperature circuit; what it warms there is to reach the cabin alone.
_NO_HEAT_PUMP: Final[Mapping[str, Value]] = {
    "scenario.strategy.heat_pump": False,
    "scenario.strategy.battery": "isolate",
    "scenario.strategy.motor": False,
    "scenario.strategy.transmission": False,
    "scenario.strategy.ambient": False,
}


def rules(
    name: str,
    file: str | os.PathLike[str] | None = None,
    overrides: Mapping[str, Value] | None = None,
) -> Controller:
    """A controller that drives exactly what `hp_gym.simulate` drives with its file.

    Args:
        name: Name in tables.
        file: Name or path of a controller file; the name itself by default.
        overrides: Further values to change.
    """
    chosen = name if file is None else os.fspath(file)

    def begin(env: EVHeatPumpVectorEnv) -> Act:
        return lambda _: env.rule_based_actions()

    environment = {
        # Whole commands in full resolution, or levels would round what the rules ask for.
        "actions": "all",
        "continuous": True,
        "overrides": {"scenario.controller": chosen, **(overrides or {})},
    }
    return Controller(name, begin, environment, rules=True)


def shipped(name: str) -> Controller:
    """A rule-based controller of this package by name.

    Raises:
        ControllerError: Its file is not there.
    """
    files = hp_gym.names("controller")
    if name not in files:
        message = (
            f"controller `{name}` has no file configs/controllers/{name}.toml; there are {', '.join(files)}"
        )
        raise ControllerError(message)
    return rules(name)


def ptc_only() -> Controller:
    """The paper's rules without heat pump: the PTC heats the cabin, and there is no air conditioning."""
    return rules("ptc-only", "hpcu", _NO_HEAT_PUMP)
