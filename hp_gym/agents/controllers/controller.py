"""What a controller is."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from hp_gym.messages import OneLineError
from hp_gym.overrides import assignments

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from hp_gym.envs.settings import Action
    from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

Act: TypeAlias = "Callable[[NDArray[np.float32]], Action]"
"""Observations of all environments, one row each, to their actions, one row each."""

NO_SEED: Final = -1
"""Seed of a controller that has none."""


class ControllerError(OneLineError):
    """There is no such controller, or it cannot be used."""


@dataclass(frozen=True)
class Controller:
    """Anything that can drive the vehicle.

    Attributes:
        name: Name in tables.
        begin: Takes a vector environment that was just reset and returns what is asked for its actions, once
            a control interval.
        environment: Arguments of `EVHeatPumpVectorEnv` that it needs: actions, observations,
            control_interval_s, overrides, ...
        seed: Seed that it was trained or is drawn with; `NO_SEED` without one.
        learned: Whether it is judged against the rules, as learned and users' controllers are.
        rules: Whether it is one of the rules, which a controller file gives.
    """

    name: str
    begin: Callable[[EVHeatPumpVectorEnv], Act]
    environment: Mapping[str, Any] = field(default_factory=dict)
    seed: int = NO_SEED
    learned: bool = False
    rules: bool = False

    def with_overrides(self, changes: Sequence[str]) -> Controller:
        """The same in a car in which values differ; what it needs itself stays.

        Args:
            changes: `key=value`, as `hp_gym.overrides.assignments` gives them.
        """
        if not changes:
            return self
        own = assignments(self.environment.get("overrides"))
        return replace(self, environment={**self.environment, "overrides": [*changes, *own]})
