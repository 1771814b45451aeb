"""The vector environment for stable-baselines3."""

from collections.abc import Iterable, Sequence
from typing import Any, Final

import gymnasium as gym
import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from hp_gym import extras
from hp_gym.envs import settings
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

with extras.needed("train"):
    from stable_baselines3.common.vec_env.base_vec_env import VecEnv, VecEnvIndices

DISCOMFORT: Final = "reward_discomfort"
"""Name of the reward's part for discomfort."""


class SB3VecEnv(VecEnv):
    """An `EVHeatPumpVectorEnv` as stable-baselines3 and sb3-contrib want it.

    Trips are reset within the step that ends them; `terminal_observation` and `TimeLimit.truncated` are in
    the infos, as algorithms need them to bootstrap. `venv.finished` tells of the trips that ended in the
    last step.

    Args:
        num_envs: Number of environments.
        **kwargs: Arguments of `EVHeatPumpVectorEnv` except `autoreset_mode`.
    """

    def __init__(self, num_envs: int = 1, **kwargs: Any) -> None:
        self.venv = EVHeatPumpVectorEnv(num_envs, autoreset_mode=AutoresetMode.SAME_STEP, **kwargs)
        self.render_mode = self.venv.render_mode
        told = settings.told(kwargs)
        asked = [name for name in told if name != "terms"] + (list(settings.TERMS) if "terms" in told else [])
        self._asked = [key for name in asked for key in (name, f"_{name}")]
        self._actions: NDArray[Any] = np.empty(0)
        self._returns = np.zeros(num_envs)
        self._lengths = np.zeros(num_envs, dtype=np.int64)
        self.discomfort_rewards: NDArray[np.float64] = np.zeros(num_envs)
        """The part of the last rewards that is for discomfort."""
        super().__init__(num_envs, self.venv.single_observation_space, self.venv.single_action_space)

    def reset(self) -> NDArray[np.float32]:
        """Begins a trip in every environment, with the seeds and options set before."""
        seeds = list(self._seeds) if any(seed is not None for seed in self._seeds) else None
        observations, infos = self.venv.reset(seed=seeds, options=self._merged_options())
        self.reset_infos = self._split(infos)
        self._reset_seeds()
        self._reset_options()
        self._returns[:], self._lengths[:] = 0.0, 0
        return observations

    def _nothing(self) -> list[dict[str, Any]]:
        return [{} for _ in range(self.num_envs)]

    def step_async(self, actions: NDArray[Any]) -> None:
        """Takes the actions of the coming step."""
        self._actions = actions

    def step_wait(
        self,
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Drives all environments on."""
        observations, rewards, terminated, truncated, infos = self.venv.step(self._actions)
        done = terminated | truncated
        self._returns += rewards
        self._lengths += 1
        # The parts of rewards are left to the ends of trips: so many dictionaries would cost more than steps.
        told = self._split({key: infos[key] for key in self._asked}) if self._asked else self._nothing()
        self.discomfort_rewards = infos[DISCOMFORT].copy()
        for index in np.flatnonzero(done).tolist():
            final = _one(infos["final_info"], index)
            final["terminal_observation"] = infos["final_obs"][index]
            final["TimeLimit.truncated"] = bool(truncated[index] and not terminated[index])
            final["episode"] = {"r": float(self._returns[index]), "l": int(self._lengths[index])}
            self._returns[index], self._lengths[index] = 0.0, 0
            self.discomfort_rewards[index] = final[DISCOMFORT]
            told[index] = final
            self.reset_infos[index] = _one(infos, index)
        return observations, rewards.astype(np.float32), done, told

    def episodes_so_far(self) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Returns returns and lengths of the trips under way."""
        return self._returns.copy(), self._lengths.copy()

    def set_episodes_so_far(self, returns: NDArray[np.float64], lengths: NDArray[np.int64]) -> None:
        """Restores what `episodes_so_far` returned, after `venv.set_state`."""
        self._returns[:], self._lengths[:] = returns, lengths

    def close(self) -> None:
        """Ends all environments."""
        self.venv.close()

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Returns an attribute, the same for all environments."""
        chosen = list(self._get_indices(indices))
        if attr_name == "action_masks":
            return [lambda index=index: self.venv.action_masks()[index] for index in chosen]
        if attr_name == "spec":
            return [gym.spec("EVHeatPump-v0") for _ in chosen]
        return [getattr(self.venv, attr_name) for _ in chosen]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        """Sets an attribute of all environments.

        Raises:
            ValueError: Only some environments are meant.
        """
        if len(list(self._get_indices(indices))) != self.num_envs:
            message = f"{attr_name}: attributes can be set for all environments only"
            raise ValueError(message)
        setattr(self.venv, attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: VecEnvIndices = None, **method_kwargs: Any
    ) -> list[Any]:
        """Calls a method of environments.

        `action_masks`, `rule_based_action`, `get_state`, `set_state`, `signals`, `kpis`, `summary`, `trip`,
        `end_reason` and `clipped_shares` are those of the single environment.

        Raises:
            AttributeError: There is no such method.
        """
        chosen = list(self._get_indices(indices))
        match method_name:
            case "action_masks":
                masks = self.venv.action_masks()
                return [masks[index] for index in chosen]
            case "rule_based_action":
                actions = self.venv.rule_based_actions()
                return [actions[index] for index in chosen]
            case "get_state":
                return list(self.venv.get_state(chosen))
            case "set_state":
                self.venv.set_state([method_args[0]] * len(chosen), chosen)
                return [None] * len(chosen)
            case "signals" | "kpis" | "summary" | "trip" | "end_reason" | "clipped_shares":
                return [getattr(self.venv, method_name)(index, **method_kwargs) for index in chosen]
        message = f"the environments have no method `{method_name}` that can be called one by one"
        raise AttributeError(message)

    def env_is_wrapped(
        self, wrapper_class: type[gym.Wrapper[Any, Any, Any, Any]], indices: VecEnvIndices = None
    ) -> list[bool]:
        """Tells that no environment is wrapped; episodes are monitored all the same."""
        from stable_baselines3.common.monitor import Monitor

        return [wrapper_class is Monitor for _ in self._get_indices(indices)]

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """Returns a picture of each environment."""
        pictures = self.venv.render()
        return pictures if pictures is not None else [None] * self.num_envs

    def _merged_options(self) -> dict[str, Any] | None:
        given: Iterable[dict[str, Any]] = self._options
        merged: dict[str, list[Any]] = {}
        for index, options in enumerate(given):
            for key, value in (options or {}).items():
                merged.setdefault(key, [None] * self.num_envs)[index] = value
        return dict(merged) or None

    def _split(self, infos: dict[str, Any]) -> list[dict[str, Any]]:
        return [_one(infos, index) for index in range(self.num_envs)]


def _one(infos: dict[str, Any], index: int) -> dict[str, Any]:
    """The info of one environment out of those of all."""
    single: dict[str, Any] = {}
    for key, mask in infos.items():
        name = key.removeprefix("_")
        if not key.startswith("_") or not isinstance(mask, np.ndarray) or not mask[index]:
            continue
        value = infos[name]
        if name in {"final_obs", "final_info"}:
            continue
        single[name] = _one(value, index) if isinstance(value, dict) else value[index]
    return single
