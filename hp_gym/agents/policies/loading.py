"""Loading a policy from any file that can be trusted not to run code."""

import os
from pathlib import Path

from hp_gym.agents.policies import policy_file
from hp_gym.agents.policies.errors import PolicyError
from hp_gym.agents.policies.saved_policy import SavedPolicy


def load(path: str | os.PathLike[str]) -> SavedPolicy:
    """Loads a `.safetensors` file or an `.onnx` file that `hp-gym export` wrote; never runs code.

    Raises:
        PolicyError: The file is no complete policy, or does not fit this version of hp_gym.
        OSError: The file cannot be read.
    """
    match Path(path).suffix.lower():
        case ".safetensors":
            return policy_file.read(path)
        case ".onnx":
            from hp_gym.agents.policies.onnx_file import read

            return read(path)
        case ".zip":
            message = (
                f"{os.fspath(path)}: loading a zip file of stable-baselines3 can run code that was put "
                "there; if you trust it, give `--allow-code` to `hp-gym benchmark`, or to `hp-gym export`, "
                "which converts it"
            )
            raise PolicyError(message)
    message = f"{os.fspath(path)}: a policy file ends with .safetensors or .onnx"
    raise PolicyError(message)
