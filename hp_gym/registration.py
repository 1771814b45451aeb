"""Registration with Gymnasium."""

from typing import Final

from gymnasium.envs.registration import register, registry

ENV_ID: Final = "EVHeatPump-v0"


def register_envs() -> None:
    """Makes the environment known to `gymnasium.make` and `gymnasium.make_vec`; repeated calls do nothing."""
    if ENV_ID not in registry:
        register(
            id=ENV_ID,
            entry_point="hp_gym.envs.env:EVHeatPumpEnv",
            vector_entry_point="hp_gym.envs.vector_env:EVHeatPumpVectorEnv",
        )
