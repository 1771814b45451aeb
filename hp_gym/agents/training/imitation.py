"""A warm start: the policy first imitates a rule-based controller, the value function its returns."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from hp_gym import extras
from hp_gym.agents.training import environments
from hp_gym.agents.training.configuration import ImitationSettings, MaskablePPOTraining, PPOTraining
from hp_gym.envs.sb3 import DISCOMFORT
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

with extras.needed("train"):
    import torch
    from sb3_contrib.common.maskable.policies import MaskableActorCriticPolicy
    from stable_baselines3.common.on_policy_algorithm import OnPolicyAlgorithm
    from stable_baselines3.common.policies import ActorCriticPolicy, BasePolicy
    from stable_baselines3.common.vec_env import VecNormalize

OnPolicyTraining: TypeAlias = PPOTraining | MaskablePPOTraining

Advance: TypeAlias = Callable[[], None]
"""Called after each pass over the data."""


@dataclass(frozen=True)
class Demonstrations:
    """What a teacher did or would have done, one row a decision.

    Attributes:
        observations: (n, rows), as the environment gives them.
        actions: (n, actions) of the teacher, whatever was driven.
        returns: (n,) discounted sum of the rewards that followed, up to the trip's end.
        known: (n,) whether the trip's end, and so the return, was seen.
    """

    observations: NDArray[np.float32]
    actions: NDArray[Any]
    returns: NDArray[np.float32]
    known: NDArray[np.bool_]


def warm_start(model: OnPolicyAlgorithm, training: OnPolicyTraining, seed: int, advance: Advance) -> None:
    """Fits a model to the teacher of its configuration: dataset aggregation (Ross et al. 2011, DAgger).

    A policy that only sees what the teacher drives goes astray where it differs, so in later rounds it drives
    most environments itself. The value function learns the returns of the last round. If the environments
    normalise observations, their moments become those of the first round.

    Raises:
        ConfigurationError: There is no such teacher.
    """
    settings = training.imitation
    if settings is None:
        return
    assert model.env is not None
    wrapper = environments.normaliser(model.env)
    scaled = environments.scaled_reward(model.env)
    scaling = None if scaled is None else scaled.scale
    rounds: list[Demonstrations] = []
    for number in range(settings.rounds):
        driver = model.policy if number else None
        shown = demonstrate(training, settings, seed + number * 1_000_003, driver, wrapper, scaling=scaling)
        if wrapper is not None and wrapper.norm_obs and not rounds:
            wrapper.obs_rms.update(shown.observations)
        rounds.append(shown)
        fit(model, rounds, settings, seed, advance)


def demonstrate(
    training: OnPolicyTraining,
    settings: ImitationSettings,
    seed: int,
    driver: BasePolicy | None = None,
    wrapper: VecNormalize | None = None,
    *,
    scaling: environments.RewardScale | None = None,
) -> Demonstrations:
    """Asks the teacher for its actions on training trips that it, or in part another policy, drives.

    In a share of the decisions some actuators do what chance says: their consequences, and what the teacher
    does then, are worth knowing too.

    Args:
        training: The configuration.
        settings: Its warm start.
        seed: Seed of trips and chance.
        driver: Policy that drives its share of the environments; none by default.
        wrapper: Normalises what the driver sees.
        scaling: How rewards count; by default as the configuration says, without a comfort constraint.

    Raises:
        ConfigurationError: There is no such teacher.
    """
    number = settings.environments
    envs = EVHeatPumpVectorEnv(
        number,
        autoreset_mode=AutoresetMode.SAME_STEP,
        threads=training.environments.threads,
        overrides={"scenario.controller": settings.teacher},
        **training.environment.model_dump(),
    )
    scaling = scaling or environments.RewardScale(training)
    chance = np.random.default_rng([seed, number])
    seen, _ = envs.reset(seed=int(chance.integers(2**62)))
    envs.action_space.seed(int(chance.integers(2**31)))
    driven = chance.random((number, 1)) < (0.0 if driver is None else settings.policy_share)
    observations, actions, rewards, ends = [], [], [], []
    for _ in range(settings.steps):
        wanted = envs.rule_based_actions()
        taken = wanted
        if driver is not None:
            own, _ = driver.predict(seen if wrapper is None else wrapper.normalize_obs(seen))
            taken = np.where(driven, own, taken)
        disturbed = chance.random((number, 1)) < settings.disturbed_share
        disturbed = disturbed & (chance.random(wanted.shape) < settings.disturbed_actuators)
        observations.append(seen)
        actions.append(wanted)
        factors = scaling.factors(seen)
        seen, reward, terminated, _, infos = envs.step(np.where(disturbed, envs.action_space.sample(), taken))
        # Of a trip's last decision the part is not told here; what it weighs does not matter to a warm start.
        rewards.append(environments.scaled(reward, infos[DISCOMFORT], factors))
        ends.append(terminated)
    envs.close()
    returns, known = _returns(np.array(rewards), np.array(ends), training.hyperparameters.gamma)
    return Demonstrations(
        np.concatenate(observations), np.concatenate(actions), returns.ravel(), known.ravel()
    )


def fit(
    model: OnPolicyAlgorithm,
    rounds: Sequence[Demonstrations],
    settings: ImitationSettings,
    seed: int,
    advance: Advance,
) -> None:
    """Makes the teacher's actions in all rounds likely, and the value function the last one's returns."""
    policy = model.policy
    assert isinstance(policy, ActorCriticPolicy | MaskableActorCriticPolicy)
    assert model.env is not None
    wrapper = environments.normaliser(model.env)
    seen = np.concatenate([shown.observations for shown in rounds])
    observations = torch.as_tensor(seen if wrapper is None else wrapper.normalize_obs(seen))
    actions = torch.as_tensor(np.concatenate([shown.actions for shown in rounds]))
    earlier = len(observations) - len(rounds[-1].returns)
    returns = torch.cat([torch.zeros(earlier), torch.as_tensor(rounds[-1].returns)])
    known = torch.cat([torch.zeros(earlier, dtype=torch.bool), torch.as_tensor(rounds[-1].known)])
    optimiser = torch.optim.Adam(policy.parameters(), lr=settings.learning_rate)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, settings.epochs)
    shuffle = torch.Generator().manual_seed(seed)
    policy.set_training_mode(True)
    for _ in range(settings.epochs):
        for rows in torch.split(torch.randperm(len(observations), generator=shuffle), settings.batch_size):
            values, log_likelihood, _ = policy.evaluate_actions(observations[rows], actions[rows])
            missed = (values.flatten() - returns[rows])[known[rows]]
            loss = -log_likelihood.mean() + settings.value_weight * missed.square().sum() / len(rows)
            optimiser.zero_grad()
            torch.autograd.backward(loss)
            optimiser.step()
        schedule.step()
        advance()


def _returns(
    rewards: NDArray[np.float64], ends: NDArray[np.bool_], gamma: float
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Discounted returns (steps, environments), and whether the trip's end was seen."""
    returns = np.zeros_like(rewards)
    known = np.zeros_like(ends)
    coming, seen = np.zeros(rewards.shape[1]), np.zeros(rewards.shape[1], dtype=np.bool_)
    for step in reversed(range(len(rewards))):
        coming = rewards[step] + gamma * np.where(ends[step], 0.0, coming)
        seen = seen | ends[step]
        returns[step], known[step] = coming, seen
    return returns.astype(np.float32), known
