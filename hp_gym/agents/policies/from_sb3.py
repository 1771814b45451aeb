"""Policies out of models of stable-baselines3 and sb3-contrib."""

from typing import Any

import numpy as np
from gymnasium import spaces

from hp_gym import __version__, extras
from hp_gym.agents.policies.errors import PolicyError
from hp_gym.agents.policies.saved_policy import (
    Layer,
    Metadata,
    Network,
    Normalisation,
    PolicyEnvironment,
    SavedPolicy,
)

with extras.needed("train"):
    import torch
    from stable_baselines3.common.base_class import BaseAlgorithm
    from stable_baselines3.common.torch_layers import FlattenExtractor
    from stable_baselines3.common.vec_env import VecNormalize

_ACTIVATIONS = {torch.nn.Tanh: "tanh", torch.nn.ReLU: "relu"}


def from_sb3(
    model: BaseAlgorithm,
    environment: PolicyEnvironment,
    *,
    normalisation: VecNormalize | None = None,
    seed: int | None = None,
    configuration: str = "",
) -> SavedPolicy:
    """Converts a trained model.

    Args:
        model: PPO, MaskablePPO, A2C, SAC or TD3 with an `MlpPolicy`.
        environment: What it was trained on.
        normalisation: The wrapper that normalised its observations, if any.
        seed: Seed of its training.
        configuration: Name of the training configuration.

    Raises:
        PolicyError: The network is of another kind, or does not fit the environment.
    """
    algorithm = type(model).__name__
    layers, activation, squashed = _network(model, algorithm)
    counts = environment.option_counts()
    _check_spaces(model, environment, counts)
    metadata = Metadata(
        algorithm=algorithm,
        environment=environment,
        network=Network(hidden_sizes=tuple(len(bias) for _, bias in layers[:-1]), activation=activation),
        option_counts=counts,
        output="argmax" if counts else "tanh" if squashed else "clip",
        masked=algorithm == "MaskablePPO",
        seed=seed,
        decisions=int(model.num_timesteps),
        package_version=__version__,
        configuration=configuration,
    )
    return SavedPolicy(metadata, tuple(layers), _normalisation(normalisation))


def _network(model: BaseAlgorithm, algorithm: str) -> tuple[list[Layer], Any, bool]:
    """Layers of the actor, the activation between them, and whether a tanh follows the last."""
    policy: Any = model.policy
    if hasattr(policy, "lstm_actor"):
        message = f"{algorithm}: a recurrent policy cannot be saved as a policy file, only as a zip file"
        raise PolicyError(message)
    actor = getattr(policy, "actor", policy)
    extractor = getattr(policy, "pi_features_extractor", None) or actor.features_extractor
    if type(extractor) is not FlattenExtractor:
        message = f"{algorithm}: extractor {type(extractor).__name__}, but only MlpPolicy can be saved"
        raise PolicyError(message)
    if hasattr(policy, "mlp_extractor"):  # on-policy
        modules = [*policy.mlp_extractor.policy_net, policy.action_net]
        squashed = bool(policy.squash_output)
    elif hasattr(actor, "latent_pi"):  # SAC
        modules = [*actor.latent_pi, actor.mu]
        # gSDE without squashing holds the mean by a hardtanh inside `mu`, which is no linear layer.
        squashed = True
    elif hasattr(actor, "mu"):  # TD3, DDPG: ends with a tanh of its own
        modules = list(actor.mu)
        squashed = isinstance(modules[-1], torch.nn.Tanh)
        modules = modules[:-1]
    else:
        message = f"{algorithm}: its policy {type(policy).__name__} cannot be saved as a policy file"
        raise PolicyError(message)
    linear, between = modules[0::2], modules[1::2]
    kinds = {type(module) for module in between}
    if (
        not all(type(module) is torch.nn.Linear for module in linear)
        or len(kinds) > 1
        or not kinds <= set(_ACTIVATIONS)
    ):
        found = ", ".join(type(module).__name__ for module in modules)
        message = f"{algorithm}: a network of {found}, but only Linear with Tanh or ReLU between can be saved"
        raise PolicyError(message)
    layers = [(_array(module.weight), _array(module.bias)) for module in linear]
    return layers, _ACTIVATIONS[kinds.pop()] if kinds else "tanh", squashed


def _array(parameter: torch.nn.Parameter) -> np.ndarray[Any, np.dtype[np.float32]]:
    return parameter.detach().cpu().numpy().astype(np.float32, copy=True)


def _normalisation(wrapper: VecNormalize | None) -> Normalisation | None:
    if wrapper is None or not wrapper.norm_obs:
        return None
    moments: Any = wrapper.obs_rms
    return Normalisation(
        np.array(moments.mean, dtype=np.float64),
        np.array(moments.var, dtype=np.float64),
        float(wrapper.clip_obs),
        float(wrapper.epsilon),
    )


def _check_spaces(model: BaseAlgorithm, environment: PolicyEnvironment, counts: tuple[int, ...]) -> None:
    rows = len(environment.observations)
    if model.observation_space.shape != (rows,):
        message = f"the model observes {model.observation_space.shape}, but the environment has {rows} rows"
        raise PolicyError(message)
    space = model.action_space
    if counts:
        fits = isinstance(space, spaces.MultiDiscrete) and tuple(space.nvec.tolist()) == counts
    else:
        fits = (
            isinstance(space, spaces.Box)
            and space.shape == (len(environment.actions),)
            and bool((space.low == -1.0).all() and (space.high == 1.0).all())
        )
    if not fits:
        wanted = f"MultiDiscrete({list(counts)})" if counts else f"Box(-1, 1, ({len(environment.actions)},))"
        message = f"the model acts on {space}, but the environment on {wanted}"
        raise PolicyError(message)
