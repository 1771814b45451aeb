"""The environments that a policy is trained on, and their state."""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from hp_gym import _core, extras
from hp_gym.agents.training.configuration import Training, TrainingConfigurationError
from hp_gym.envs import settings
from hp_gym.envs.sb3 import SB3VecEnv

with extras.needed("train"):
    import torch
    from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper, VecNormalize

AMBIENT_ROW: Final = "ambient_temperature_degc"
CABIN_ROW: Final = "cabin_temperature_degc"

COMFORTABLE_DEGC: Final = 22.0


class RewardScale:
    """How rewards count in training: a factor for all or by ambient temperature, and one on discomfort alone.

    Args:
        training: The configuration.

    Raises:
        TrainingConfigurationError: The ambient or the cabin's temperature is wanted and not observed.
    """

    def __init__(self, training: Training) -> None:
        normalisation = training.normalisation
        self._factor = normalisation.reward_scale
        self._costs = _table(normalisation.typical_cost)
        constraint = training.comfort_constraint
        self._constrained_degc = np.array([0.0] if constraint is None else constraint.ambient_degc)
        self._multipliers = np.zeros(len(self._constrained_degc))
        self._allowed_k = np.ones(len(self._constrained_degc))
        self._is_convex = constraint is not None and constraint.convex
        self._by_ambient = normalisation.typical_cost is not None or constraint is not None
        if self._by_ambient:
            self._ambient = _Row(training, AMBIENT_ROW)
        if self._is_convex:
            self._cabin = _Row(training, CABIN_ROW)

    @property
    def is_one(self) -> bool:
        """Whether rewards stay as they are."""
        return not self._by_ambient and self._factor == 1.0

    def set_multipliers(self, multipliers: NDArray[np.float64], allowed_k: NDArray[np.float64]) -> None:
        """Sets what the comfort constraint adds to the weight of discomfort from now on.

        Args:
            multipliers: One for each of the constraint's ambient temperatures.
            allowed_k: Discomfort that is allowed there.
        """
        self._multipliers, self._allowed_k = multipliers, allowed_k

    def factors(self, observations: NDArray[np.float32]) -> NDArray[np.float64]:
        """Returns two rows of factors, on all and on discomfort besides, for environments that gave these.

        They are of the decision that follows the observations.
        """
        if not self._by_ambient:
            return np.tile([[self._factor], [1.0]], (1, len(observations)))
        ambient_degc = self._ambient.values(observations)
        cost = np.interp(ambient_degc, self._costs[:, 0], self._costs[:, 1])
        added = np.interp(ambient_degc, self._constrained_degc, self._multipliers)
        if self._is_convex:
            allowed_k = np.interp(ambient_degc, self._constrained_degc, self._allowed_k)
            distance_k = np.abs(self._cabin.values(observations) - COMFORTABLE_DEGC)
            added *= _convex(distance_k / np.maximum(allowed_k, 0.1))
        return np.stack([self._factor / cost, 1.0 + added])


def scaled(
    rewards: NDArray[np.float64], discomfort: NDArray[np.float64], factors: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Returns rewards as they count in training; `discomfort` is the part of them that is for discomfort."""
    counted: NDArray[np.float64] = factors[0] * (rewards + (factors[1] - 1.0) * discomfort)
    return counted


class ScaledReward(VecEnvWrapper):
    """Environments whose rewards are scaled.

    Args:
        venv: The environments.
        scale: Gives the factors.
    """

    def __init__(self, venv: SB3VecEnv, scale: RewardScale) -> None:
        super().__init__(venv)
        self._inner = venv
        self.scale = scale
        self.factors = np.zeros((2, venv.num_envs))
        """Of the decisions that come."""

    def reset(self) -> Any:
        """Begins trips."""
        observations = self.venv.reset()
        self.factors = self.scale.factors(np.asarray(observations))
        return observations

    def step_wait(self) -> Any:
        """Drives all environments on."""
        observations, rewards, done, infos = self.venv.step_wait()
        counted = scaled(rewards, self._inner.discomfort_rewards, self.factors).astype(np.float32)
        self.factors = self.scale.factors(np.asarray(observations))
        return observations, counted, done, infos


def _table(rows: list[list[float]] | None) -> NDArray[np.float64]:
    """Ambient temperatures and values; 1 everywhere by default."""
    return np.array(rows if rows is not None else [[0.0, 1.0]])


def _convex(ratio: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weight of a distance from comfort for its ratio to the allowed one.

    Distance times weight is quadratic up to the allowed distance and goes on in a straight line, as the loss
    of Huber 1964 (doi:10.1214/aoms/1177703732) does.
    """
    weight: NDArray[np.float64] = np.where(ratio <= 1.0, ratio, 2.0 - 1.0 / np.maximum(ratio, 1.0))
    return weight


class _Row:
    """A place of the observations, read in its unit."""

    def __init__(self, training: Training, name: str) -> None:
        chosen = settings.to_json(
            vehicle=training.environment.vehicle,
            actions=training.environment.actions,
            observations=training.environment.observations,
        )
        episode = _core.Episode(chosen, None, settings.DEFAULT_DISTRIBUTION)
        for index, (row, _, low, high, _) in enumerate(episode.observation_rows()):
            if row == name:
                self._index, self._low, self._span = index, low, high - low
                return
        message = f"weights by climate and comfort need {name} among the observations"
        raise TrainingConfigurationError(message)

    def values(self, observations: NDArray[np.float32]) -> NDArray[np.float64]:
        """Returns its values."""
        share: NDArray[np.float64] = 0.5 * (observations[:, self._index].astype(np.float64) + 1.0)
        return self._low + share * self._span


def make(training: Training) -> VecEnv:
    """Returns the environments of a training, wrapped as its configuration says.

    Raises:
        ConfigurationError: An argument of the environment is not accepted.
    """
    normalisation = training.normalisation
    plain = SB3VecEnv(
        training.environments.number,
        threads=training.environments.threads,
        **training.environment.model_dump(),
    )
    scale = RewardScale(training)
    envs: VecEnv = plain if scale.is_one else ScaledReward(plain, scale)
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


def scaled_reward(envs: VecEnv) -> ScaledReward | None:
    """Returns the wrapper that scales rewards, if there is one."""
    while isinstance(envs, VecEnvWrapper):
        if isinstance(envs, ScaledReward):
            return envs
        envs = envs.venv
    return None


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
    wrapped = scaled_reward(envs)
    if wrapped is not None:
        told["reward_factors"] = torch.from_numpy(wrapped.factors.copy())
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
    wrapped = scaled_reward(envs)
    if wrapped is not None:
        wrapped.factors = told["reward_factors"].numpy().copy()
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
