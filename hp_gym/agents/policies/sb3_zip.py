"""Zip files of stable-baselines3, which can run code when they are loaded."""

import json
import os
import zipfile
import zlib
from io import BytesIO
from pathlib import Path
from typing import Any, Final

from gymnasium import spaces

from hp_gym import extras
from hp_gym.agents.policies.errors import PolicyError
from hp_gym.agents.policies.from_sb3 import from_sb3
from hp_gym.agents.policies.policy_file import file_bytes
from hp_gym.agents.policies.saved_policy import PolicyEnvironment, SavedPolicy

with extras.needed("train"):
    from stable_baselines3.common.base_class import BaseAlgorithm
    from stable_baselines3.common.vec_env import VecNormalize

WARNING = "loading a zip file of stable-baselines3 can run any code that its author put there"
"""What a user is told who allows it."""

_LARGEST_DESCRIPTION_BYTES: Final = 64 * 2**20

_DAMAGED: Final = (
    zipfile.BadZipFile,
    zlib.error,
    EOFError,
    NotImplementedError,  # an unknown compression
    RuntimeError,  # encrypted
    KeyError,
    TypeError,
    ValueError,
)
"""What reading a damaged archive raises, which differs from case to case."""

_NOT_NEEDED: Final = {"learning_rate": 0.0, "lr_schedule": None}
"""What only training needs: a file names a schedule by its module, which may have moved since."""


def load_sb3_zip(
    path: str | os.PathLike[str],
    environment: PolicyEnvironment | None,
    *,
    allow_code: bool,
    normalisation: str | os.PathLike[str] | None = None,
) -> tuple[SavedPolicy, BaseAlgorithm]:
    """Loads a model and converts it.

    Args:
        path: The zip file.
        environment: What it was trained on; the file does not say. None for an id with its defaults, which of
            them its actions tell.
        allow_code: Must be true: the file is trusted.
        normalisation: Pickled `VecNormalize` of its training, if any; trusted like the file.

    Raises:
        PolicyError: Not allowed, no such file, or another kind of model.
        OSError: A file cannot be read.
    """
    name = os.fspath(path)
    if not allow_code:
        message = f"{name}: {WARNING}, so it must be allowed"
        raise PolicyError(message)
    algorithm = _algorithm(name)
    try:
        model = algorithm.load(name, device="cpu", custom_objects=_NOT_NEEDED)
        wrapper = None if normalisation is None else _wrapper(normalisation)
    # Unpickling raises whatever the pickled objects raise.
    except Exception as error:
        message = f"{name}: cannot be loaded ({type(error).__name__}: {error})"
        raise PolicyError(message) from error
    try:
        if environment is None:
            environment = PolicyEnvironment.resolve(continuous=isinstance(model.action_space, spaces.Box))
        return from_sb3(model, environment, normalisation=wrapper, seed=model.seed), model
    except PolicyError as error:
        message = f"{name}: {error}"
        raise PolicyError(message) from error


def _wrapper(path: str | os.PathLike[str]) -> VecNormalize:
    import pickle

    with Path(path).open("rb") as file:
        wrapper = pickle.load(file)
    if not isinstance(wrapper, VecNormalize):
        message = f"{os.fspath(path)} holds no VecNormalize"
        raise TypeError(message)
    return wrapper


def _algorithm(name: str) -> type[BaseAlgorithm]:
    """Tells which algorithm wrote a file, without loading what it pickled."""
    with extras.needed("train"):
        import sb3_contrib
        import stable_baselines3

    try:
        with zipfile.ZipFile(BytesIO(file_bytes(name))) as archive:
            with archive.open("data") as file:
                # A small file can unpack to a huge one.
                told: dict[str, Any] = json.loads(file.read(_LARGEST_DESCRIPTION_BYTES))
            module = str(told["policy_class"]["__module__"])
    except PolicyError:
        raise
    except _DAMAGED as error:
        message = f"{name}: no complete zip file of stable-baselines3"
        raise PolicyError(message) from error
    known: dict[str, type[BaseAlgorithm]] = {
        "stable_baselines3.sac": stable_baselines3.SAC,
        "stable_baselines3.td3": stable_baselines3.TD3,
        "sb3_contrib.common.maskable": sb3_contrib.MaskablePPO,
        "sb3_contrib.common.recurrent": sb3_contrib.RecurrentPPO,
        "stable_baselines3.common.policies": (
            stable_baselines3.PPO if "clip_range" in told else stable_baselines3.A2C
        ),
    }
    for prefix, algorithm in known.items():
        if module.startswith(prefix):
            return algorithm
    message = f"{name}: a policy of {module}, but only PPO, MaskablePPO, A2C, SAC and TD3 can be converted"
    raise PolicyError(message)
