"""What a training needs of memory, before any of it is asked for."""

from itertools import pairwise
from typing import Any, Final

from hp_gym.agents.policies import PolicyEnvironment
from hp_gym.agents.training.configuration import SACTraining, Training, TrainingConfigurationError
from hp_gym.memory import shortage

_ENVIRONMENT_BYTES: Final = 4096
_NUMBER_BYTES: Final = 4
# Rewards, values, advantages, returns, ends, log-likelihoods; those that SAC keeps are fewer.
_OTHER_COLUMNS: Final = 6
# Weights, their gradients, and two moments of each.
_COPIES_OF_WEIGHTS: Final = 4


def require_memory(training: Training) -> None:
    """Checks that the largest parts of a training fit into memory.

    Raises:
        TrainingConfigurationError: They do not; the message names the largest.
        ConfigurationError: The environment's actions or observations are not known.
    """
    needs = _needs(training)
    largest = max(needs, key=lambda name: needs[name])
    lacking = shortage(sum(needs.values()))
    if lacking is not None:
        message = f"the training {lacking}; most of it is for `{largest}`"
        raise TrainingConfigurationError(message)


def _needs(training: Training) -> dict[str, int]:
    """Bytes by the key in the configuration that they come from."""
    chosen = training.environment
    environment = PolicyEnvironment.resolve(
        continuous=chosen.continuous, actions=chosen.actions, observations=chosen.observations
    )
    rows, actions = len(environment.observations), len(environment.actions)
    number = training.environments.number
    needs = {
        "environments.number": number * _ENVIRONMENT_BYTES,
        "validation.trips": training.validation.trips * _ENVIRONMENT_BYTES,
        "network": _NUMBER_BYTES * _COPIES_OF_WEIGHTS * _weights(training, rows),
    }
    if training.comfort_constraint is not None:
        needs["comfort_constraint.trips"] = training.comfort_constraint.trips * _ENVIRONMENT_BYTES
    if isinstance(training, SACTraining):
        columns = 2 * rows + actions + _OTHER_COLUMNS // 2
        needs["hyperparameters.buffer_size"] = (
            max(training.hyperparameters.buffer_size, number) * columns * _NUMBER_BYTES
        )
        return needs
    columns = rows + actions + _OTHER_COLUMNS
    needs["hyperparameters.n_steps"] = training.hyperparameters.n_steps * number * columns * _NUMBER_BYTES
    imitation: Any = training.imitation
    if imitation is not None and imitation.rounds:
        decisions = imitation.rounds * imitation.steps * imitation.environments
        needs["imitation"] = (
            decisions * (rows + 2 * actions + 2) * _NUMBER_BYTES + imitation.environments * _ENVIRONMENT_BYTES
        )
    return needs


def _weights(training: Training, rows: int) -> int:
    policy = training.network.hidden_sizes
    value = training.network.value_hidden_sizes or policy
    return sum(before * after for sizes in (policy, value) for before, after in pairwise([rows, *sizes]))
