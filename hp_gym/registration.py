"""Registration with Gymnasium."""

from collections.abc import Mapping
from typing import Any, Final

from gymnasium.envs.registration import register, registry

from hp_gym import _core

ENV_ID: Final = "EVHeatPump-v0"
"""The default: one choice for each component."""

LONGEST_TRIP_STEPS: Final = 1_000_900
"""Seconds of the longest cycle and the longest delay there can be: cuts no trip, whatever the interval."""

_DEFAULT: Final = ("env:EVHeatPumpEnv", "vector_env:EVHeatPumpVectorEnv")

_VARIANTS: Final[Mapping[str, tuple[tuple[str, str], Mapping[str, Any]]]] = {
    ENV_ID: (_DEFAULT, {}),
    "EVHeatPumpContinuous-v0": (_DEFAULT, {"continuous": True}),
    "EVHeatPumpFlat-v0": (("flat_env:EVHeatPumpFlatEnv", "flat_env:EVHeatPumpFlatVectorEnv"), {}),
    "EVHeatPumpMO-v0": (
        ("multi_objective_env:EVHeatPumpMOEnv", "multi_objective_env:EVHeatPumpMOVectorEnv"),
        # Gymnasium's checker knows no vector of rewards.
        {"disable_env_checker": True},
    ),
}
"""Classes of the single and the vector environment, and arguments, by id."""


def ids() -> tuple[str, ...]:
    """Returns all ids: the variants, then for each distribution of trips `EVHeatPump/<name>-v<version>`."""
    return (*_VARIANTS, *(f"EVHeatPump/{name}" for name in _core.names("distribution of episodes")))


def register_envs() -> None:
    """Makes the environments known to `gymnasium.make` and `make_vec`; repeated calls do nothing."""
    for env_id in ids():
        if env_id in registry:
            continue
        distribution = env_id.partition("/")[2]
        (single, vector), chosen = _VARIANTS.get(env_id, (_DEFAULT, {"distribution": distribution}))
        arguments = dict(chosen)
        register(
            id=env_id,
            entry_point=f"hp_gym.envs.{single}",
            vector_entry_point=f"hp_gym.envs.{vector}",
            max_episode_steps=LONGEST_TRIP_STEPS,
            disable_env_checker=arguments.pop("disable_env_checker", False),
            kwargs=arguments,
        )
