"""The warm start from a rule-based controller."""

import numpy as np
import pytest

from hp_gym import ConfigurationError
from hp_gym.agents.training import algorithms, configuration, environments, imitation

SMALL = (
    "environments.number=4",
    "hyperparameters.n_steps=16",
    "hyperparameters.batch_size=64",
    "network.hidden_sizes=[16]",
    "environment.control_interval_s=20",
    "imitation={teacher = 'hpcu', environments = 16, steps = 40, epochs = 6, learning_rate = 3e-3}",
)


def small(*changes: str, name: str = "ppo") -> imitation.OnPolicyTraining:
    training = configuration.load(name, [*SMALL, *changes])
    assert isinstance(training, configuration.PPOTraining | configuration.MaskablePPOTraining)
    return training


def test_returns_end_with_the_trip_and_are_unknown_without_an_end() -> None:
    rewards = np.array([[1.0, 1.0], [2.0, 1.0], [4.0, 1.0]])
    ends = np.array([[False, False], [True, False], [False, False]])
    returns, known = imitation._returns(rewards, ends, 0.5)
    np.testing.assert_allclose(returns[:2, 0], [2.0, 2.0])
    assert known.tolist() == [[True, False], [True, False], [False, False]]


@pytest.mark.parametrize("name", ["ppo", "maskable-ppo"])
def test_imitation_makes_the_teachers_actions_more_likely_than_those_of_an_untrained_policy(
    name: str,
) -> None:
    training = small(name=name)
    assert training.imitation is not None
    envs = environments.make(training)
    model = algorithms.make(training, envs, 0)
    shown = imitation.demonstrate(training, training.imitation, 1)
    normaliser = environments.normaliser(envs)

    def agreement() -> float:
        seen = shown.observations if normaliser is None else normaliser.normalize_obs(shown.observations)
        found, _ = model.predict(seen, deterministic=True)
        return float((found == shown.actions).mean())

    before = agreement()
    passes: list[int] = []
    imitation.warm_start(model, training, 0, lambda: passes.append(1))
    assert len(passes) == training.imitation.rounds * training.imitation.epochs
    assert agreement() > max(0.7, before + 0.1)


def test_demonstrations_repeat_with_the_seed_and_differ_with_another() -> None:
    training = small()
    assert training.imitation is not None
    one, same, other = (imitation.demonstrate(training, training.imitation, seed) for seed in (3, 3, 4))
    np.testing.assert_array_equal(one.observations, same.observations)
    np.testing.assert_array_equal(one.returns, same.returns)
    assert not np.array_equal(one.observations, other.observations)


def test_unknown_teacher_is_refused_by_name() -> None:
    training = small("imitation.teacher='nobody'")
    assert training.imitation is not None
    with pytest.raises(ConfigurationError, match="nobody"):
        imitation.demonstrate(training, training.imitation, 0)
