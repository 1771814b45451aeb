"""Learned controllers: policy files, the shipped reference policies and their ablations."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

from hp_gym.agents.controllers.controller import NO_SEED, Act, Controller, ControllerError
from hp_gym.agents.policies import PolicyError, load
from hp_gym.agents.policies import reference as shipped

if TYPE_CHECKING:
    import os
    from collections.abc import Collection

    from hp_gym.agents.policies import SavedPolicy
    from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

REFERENCE: Final = "ppo"
"""Name of the shipped policies; one controller for each training seed."""

ABLATION: Final = "ablation/"
"""How names of ablation policies begin."""


def from_file(
    path: str | os.PathLike[str], name: str | None = None, *, allow_code: bool = False
) -> Controller:
    """A policy file as a controller, deterministic.

    Args:
        path: The file.
        name: Name in tables; by default that of the file, without folder and training seed: policies that
            were trained with several seeds (`mine-seed0.safetensors`, ...) are runs of one controller.
        allow_code: Whether a zip file of stable-baselines3 is loaded, which can run code. It is taken as
            trained on `EVHeatPump-v0` or `EVHeatPumpContinuous-v0` with their defaults.

    Raises:
        ControllerError: It is no policy or does not fit; loading never runs code unless it is allowed.
    """
    zipped = allow_code and Path(path).suffix.lower() == ".zip"
    try:
        policy = _zip_file(path) if zipped else load(path)
    except (PolicyError, OSError) as error:
        raise ControllerError(str(error)) from error
    # What stable-baselines3 saves as ppo.zip is not the shipped `ppo`.
    of_file = _without_seed(Path(path).stem) + (".zip" if zipped else "")
    return _controller(policy, of_file if name is None else name)


def _zip_file(path: str | os.PathLike[str]) -> SavedPolicy:
    from hp_gym.agents.policies.sb3_zip import load_sb3_zip

    return load_sb3_zip(path, None, allow_code=True)[0]


def _without_seed(stem: str) -> str:
    return stem.rsplit("-seed", 1)[0]


def _controller(policy: SavedPolicy, name: str) -> Controller:
    def begin(env: EVHeatPumpVectorEnv) -> Act:
        if policy.needs_masks:
            return lambda observations: policy.predict(observations, env.action_masks())
        return policy.predict

    seed = policy.metadata.seed
    return Controller(
        name,
        begin,
        policy.environment,
        NO_SEED if seed is None else seed,
        learned=True,
    )


def reference(seeds: Collection[int] | None = None) -> list[Controller]:
    """The shipped reference policies, one controller for each training seed.

    Args:
        seeds: Training seeds to take; all by default.

    Raises:
        ControllerError: None is shipped, or none of a wanted seed.
    """
    try:
        found = [_controller(policy, REFERENCE) for policy in shipped.policies(REFERENCE).values()]
    except PolicyError as error:
        raise ControllerError(str(error)) from error
    if seeds is None:
        return found
    there = [controller.seed for controller in found]
    for seed in seeds:
        if seed not in there:
            message = f"no reference policy `{REFERENCE}` with seed {seed}; there are {_listed(there)}"
            raise ControllerError(message)
    return [controller for controller in found if controller.seed in seeds]


def reference_is_shipped() -> bool:
    """Whether there is a reference policy."""
    return REFERENCE in shipped.names()


def ablations() -> list[Controller]:
    """Policies that were trained with one thing changed, `ablation/<name>`; none if none is shipped.

    Raises:
        ControllerError: One cannot be loaded.
    """
    try:
        found = shipped.ablations()
    except PolicyError as error:
        raise ControllerError(str(error)) from error
    return [_controller(policy, ABLATION + _without_seed(file)) for file, policy in found.items()]


def _listed(seeds: Collection[int]) -> str:
    return ", ".join(str(seed) for seed in sorted(seeds))
