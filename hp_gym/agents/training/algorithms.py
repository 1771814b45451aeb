"""The algorithm of a training configuration, ready to learn."""

from typing import Any, Final

from hp_gym import extras
from hp_gym.agents.training import branches, environments
from hp_gym.agents.training.configuration import RecurrentPPOHyperparameters, Training

with extras.needed("train"):
    import torch
    from sb3_contrib import MaskablePPO, RecurrentPPO
    from stable_baselines3 import PPO, SAC
    from stable_baselines3.common.base_class import BaseAlgorithm
    from stable_baselines3.common.vec_env import VecEnv

_ALGORITHMS: Final[dict[str, tuple[type[BaseAlgorithm], str]]] = {
    "ppo": (PPO, "MlpPolicy"),
    "maskable-ppo": (MaskablePPO, "MlpPolicy"),
    "recurrent-ppo": (RecurrentPPO, "MlpLstmPolicy"),
    "sac": (SAC, "MlpPolicy"),
}

_ACTIVATIONS: Final[dict[str, type[torch.nn.Module]]] = {"tanh": torch.nn.Tanh, "relu": torch.nn.ReLU}

# Ours, or arguments of the network rather than of the algorithm.
_NOT_ARGUMENTS: Final = {"ent_coef_end", "lstm_hidden_size", "n_lstm_layers"}


def make(training: Training, envs: VecEnv, seed: int) -> BaseAlgorithm:
    """Returns an untrained model whose weights and trips follow from the seed."""
    algorithm, policy = _ALGORITHMS[training.algorithm]
    arguments: dict[str, Any] = training.hyperparameters.model_dump(exclude=_NOT_ARGUMENTS)
    model = algorithm(
        policy,
        envs,
        learning_rate=training.learning_rate.at,
        policy_kwargs=_network(training),
        seed=seed,
        device="cpu",
        **arguments,
    )
    branches.install(model)
    environments.seed(envs, seed)
    return model


def _network(training: Training) -> dict[str, Any]:
    sizes = training.network.hidden_sizes
    values = training.network.value_hidden_sizes or sizes
    critic = "qf" if training.algorithm == "sac" else "vf"
    told: dict[str, Any] = {
        "net_arch": {"pi": list(sizes), critic: list(values)},
        "activation_fn": _ACTIVATIONS[training.network.activation],
    }
    if isinstance(training.hyperparameters, RecurrentPPOHyperparameters):
        told["lstm_hidden_size"] = training.hyperparameters.lstm_hidden_size
        told["n_lstm_layers"] = training.hyperparameters.n_lstm_layers
    return told
