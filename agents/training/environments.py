"""The environments that a policy is trained on, and their state."""

from typing import Any

import numpy as np
import torch
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper, VecNormalize

from agents.training.configuration import Training
from hp_gym.sb3 import SB3VecEnv


class ScaledReward(VecEnvWrapper):
    """Environments whose rewards are multiplied by a factor.

    Args:
        venv: The environments.
        factor: The factor.
    """

    def __init__(self, venv: VecEnv, factor: float) -> None:
        super().__init__(venv)
        self._factor = np.float32(factor)

    def reset(self) -> Any:
        """Begins trips."""
        return self.venv.reset()

    def step_wait(self) -> Any:
        """Drives all environments on."""
        observations, rewards, done, infos = self.venv.step_wait()
        return observations, rewards * self._factor, done, infos


def make(training: Training) -> VecEnv:
    """Returns the environments of a training, wrapped as its configuration says.

    Raises:
        ConfigurationError: An argument of the environment is not accepted.
    """
    normalisation = training.normalisation
    envs: VecEnv = SB3VecEnv(
        training.environments.number,
        threads=training.environments.threads,
        **training.environment.model_dump(),
    )
    if normalisation.reward_scale != 1.0:
        envs = ScaledReward(envs, normalisation.reward_scale)
    if normalisation.observations or normalisation.rewards:
        envs = VecNormalize(
            envs,
            norm_obs=normalisation.observations,
            norm_reward=normalisation.rewards,
            clip_obs=normalisation.observation_clip,
            clip_reward=normalisation.reward_clip,
            gamma=training.hyperparameters.gamma,
        )
    return envs


def seed(envs: VecEnv, number: int) -> None:
    """Seeds environments so that trainings with neighbouring seeds share no trips."""
    # Environment i gets `first + i`: plain seeds 0 and 1 would share all trips but one environment's.
    first = int(np.random.SeedSequence(number).generate_state(1, np.uint64)[0] >> np.uint64(1))
    envs.seed(first)


def normaliser(envs: VecEnv) -> VecNormalize | None:
    """Returns the wrapper that normalises, if there is one."""
    return envs if isinstance(envs, VecNormalize) else None


def get_state(envs: VecEnv) -> dict[str, Any]:
    """Returns all that the future of environments depends on, as tensors and plain values."""
    inner = envs.unwrapped
    assert isinstance(inner, SB3VecEnv)
    states = inner.venv.get_state()
    returns, lengths = inner.episodes_so_far()
    told: dict[str, Any] = {
        "sizes": [len(state) for state in states],
        "states": torch.from_numpy(np.frombuffer(b"".join(states), dtype=np.uint8).copy()),
        "episode_returns": torch.from_numpy(returns),
        "episode_lengths": torch.from_numpy(lengths),
    }
    wrapper = normaliser(envs)
    if wrapper is not None:
        told["returns"] = torch.from_numpy(wrapper.returns.copy())
        told["moments"] = {
            name: (
                torch.from_numpy(np.array(moments.mean)),
                torch.from_numpy(np.array(moments.var)),
                moments.count,
            )
            for name, moments in _moments(wrapper).items()
        }
    return told


def set_state(envs: VecEnv, told: dict[str, Any]) -> None:
    """Lets environments go on from a state that `get_state` returned.

    Raises:
        ConfigurationError: It is not the state of such environments.
        KeyError: It is no state.
    """
    inner = envs.unwrapped
    assert isinstance(inner, SB3VecEnv)
    ends = np.cumsum(told["sizes"])
    data = told["states"].numpy().tobytes()
    inner.venv.set_state([data[end - size : end] for end, size in zip(ends, told["sizes"], strict=True)])
    inner.set_episodes_so_far(told["episode_returns"].numpy(), told["episode_lengths"].numpy())
    wrapper = normaliser(envs)
    if wrapper is not None:
        wrapper.returns = told["returns"].numpy().copy()
        for name, moments in _moments(wrapper).items():
            mean, variance, count = told["moments"][name]
            moments.mean, moments.var, moments.count = mean.numpy().copy(), variance.numpy().copy(), count


def _moments(wrapper: VecNormalize) -> dict[str, Any]:
    moments: dict[str, Any] = {"rewards": wrapper.ret_rms}
    if wrapper.norm_obs:
        moments["observations"] = wrapper.obs_rms
    return moments
