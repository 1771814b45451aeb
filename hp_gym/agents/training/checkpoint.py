"""Checkpoints: everything that the rest of a training depends on, in one file that cannot run code."""

import hashlib
import json
import os
import random
import warnings
from collections import deque
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any, Final

import numpy as np

from hp_gym import extras
from hp_gym.agents.training import environments
from hp_gym.files import atomic_write, read_bytes
from hp_gym.messages import OneLineError, UncheckedFileWarning

with extras.needed("train"):
    import torch
    from stable_baselines3.common.base_class import BaseAlgorithm
    from stable_baselines3.common.buffers import ReplayBuffer

FORMAT_VERSION: Final = 2
"""Since 2 a checkpoint ends with its checksum."""

_LARGEST_BYTES: Final = 8 * 2**30
_SEAL: Final = b"\nhp_gym sha256 "
_SEAL_LENGTH: Final = len(_SEAL) + 64
_KEYS: Final = {"format_version", "notes", "model", "environments", "random"}

_COUNTERS: Final = ("num_timesteps", "_n_updates", "_episode_num", "_current_progress_remaining", "ent_coef")
_ARRAYS: Final = ("_last_obs", "_last_episode_starts", "_last_original_obs")
_REPLAY: Final = ("observations", "next_observations", "actions", "rewards", "dones", "timeouts")


class CheckpointError(OneLineError):
    """A checkpoint that is truncated, foreign, or of another version; the message says which and why."""


def encode(model: BaseAlgorithm, notes: Mapping[str, Any]) -> bytes:
    """Returns a checkpoint as the bytes of its file, which end with their checksum.

    Args:
        model: What is trained, between an update and the decisions that follow it.
        notes: What the training itself remembers; goes through JSON.
    """
    content = {
        "format_version": FORMAT_VERSION,
        "notes": json.dumps(dict(notes)),
        "model": _model_state(model),
        "environments": environments.get_state(_envs(model)),
        "random": _random_state(model),
    }
    # By way of memory: torch's own writer reports a full disk as an internal error.
    buffer = BytesIO()
    torch.save(content, buffer)
    digest = hashlib.sha256(buffer.getbuffer()).hexdigest()
    buffer.seek(0, os.SEEK_END)
    buffer.write(_SEAL + digest.encode("ascii"))
    return buffer.getvalue()


def write(path: Path, data: bytes) -> None:
    """Writes the bytes of a checkpoint whole or not at all.

    Raises:
        OSError: It cannot be written; what was there before is intact.
    """
    with atomic_write(path) as temporary:
        temporary.write_bytes(data)


def read(path: Path) -> dict[str, Any]:
    """Reads a checkpoint.

    Raises:
        CheckpointError: It is damaged, foreign or of another version.
        FileError: It is no regular file, or too large.
        OSError: It cannot be read.
    """
    data = read_bytes(path, _LARGEST_BYTES)
    place = len(data) - _SEAL_LENGTH
    sealed = place > 0 and data[place : place + len(_SEAL)] == _SEAL
    if sealed and hashlib.sha256(data[:place]).hexdigest().encode("ascii") != data[place + len(_SEAL) :]:
        message = f"{path}: no complete checkpoint (its checksum is another)"
        raise CheckpointError(message)
    try:
        content: dict[str, Any] = torch.load(
            BytesIO(data[:place] if sealed else data), map_location="cpu", weights_only=True
        )
        version = content["format_version"]
        content["notes"] = json.loads(content["notes"])
        known = content.keys() == _KEYS and isinstance(content["notes"], dict)
    # What torch raises on a damaged file differs from case to case.
    except Exception as error:
        message = f"{path}: no complete checkpoint ({type(error).__name__})"
        raise CheckpointError(message) from error
    # Up to version 1 there was no checksum.
    if not known or version != (FORMAT_VERSION if sealed else 1):
        message = f"{path}: no checkpoint of format version {FORMAT_VERSION}"
        raise CheckpointError(message)
    if not sealed:
        _require_finite(path, content, path.name)
        warnings.warn(
            f"{path}: without checksum, only its values are checked", UncheckedFileWarning, stacklevel=2
        )
    return content


def _require_finite(path: Path, value: Any, place: str) -> None:
    """Checks all numbers of a checkpoint that has no checksum."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            _require_finite(path, inner, str(key))
    elif isinstance(value, list | tuple):
        for inner in value:
            _require_finite(path, inner, place)
    elif isinstance(value, torch.Tensor) and value.is_floating_point() and not torch.isfinite(value).all():
        message = f"{path}: no complete checkpoint (`{place}` holds numbers that are not finite)"
        raise CheckpointError(message)


def restore(content: Mapping[str, Any], model: BaseAlgorithm, path: str | os.PathLike[str]) -> None:
    """Lets a fresh model of the same configuration go on from a checkpoint.

    Raises:
        CheckpointError: The checkpoint is of another configuration.
    """
    try:
        _restore_model(content["model"], model)
        environments.set_state(_envs(model), content["environments"])
        _restore_random(content["random"], model)
    # Whatever a value of another kind leads to in torch, NumPy or stable-baselines3.
    except Exception as error:
        message = f"{os.fspath(path)}: does not fit the run's configuration ({error})"
        raise CheckpointError(message) from error


def _envs(model: BaseAlgorithm) -> Any:
    return model.env


def _tensor(value: Any) -> torch.Tensor | None:
    return None if value is None else torch.from_numpy(np.array(value))


def _model_state(model: BaseAlgorithm) -> dict[str, Any]:
    told: dict[str, Any] = {
        "parameters": model.get_parameters(),
        "counters": {
            name: getattr(model, name) for name in _COUNTERS if _is_plain(getattr(model, name, None))
        },
        "arrays": {name: _tensor(getattr(model, name)) for name in _ARRAYS},
        "episodes": json.dumps([{k: e[k] for k in ("r", "l")} for e in model.ep_info_buffer or ()]),
    }
    if getattr(model, "log_ent_coef", None) is not None:
        told["log_ent_coef"] = model.log_ent_coef.detach().clone()  # type: ignore[attr-defined]
    if getattr(model, "_last_lstm_states", None) is not None:
        states = model._last_lstm_states  # type: ignore[attr-defined]
        told["lstm"] = {"pi": list(states.pi), "vf": list(states.vf)}
    buffer = getattr(model, "replay_buffer", None)
    if isinstance(buffer, ReplayBuffer):
        filled = buffer.buffer_size if buffer.full else buffer.pos
        told["replay"] = {name: torch.from_numpy(getattr(buffer, name)[:filled].copy()) for name in _REPLAY}
        told["replay_place"] = (buffer.pos, buffer.full)
    return told


def _is_plain(value: object) -> bool:
    return isinstance(value, int | float)


def _restore_model(told: Mapping[str, Any], model: BaseAlgorithm) -> None:
    model.set_parameters(told["parameters"], exact_match=True, device="cpu")
    for name, value in told["counters"].items():
        setattr(model, name, value)
    for name, value in told["arrays"].items():
        setattr(model, name, None if value is None else value.numpy().copy())
    model.ep_info_buffer = deque(json.loads(told["episodes"]), maxlen=model._stats_window_size)
    model.ep_success_buffer = deque(maxlen=model._stats_window_size)
    if "log_ent_coef" in told:
        with torch.no_grad():
            model.log_ent_coef.copy_(told["log_ent_coef"])  # type: ignore[attr-defined]
    if "lstm" in told:
        states = model._last_lstm_states  # type: ignore[attr-defined]
        model._last_lstm_states = type(states)(  # type: ignore[attr-defined]
            tuple(told["lstm"]["pi"]), tuple(told["lstm"]["vf"])
        )
    buffer = getattr(model, "replay_buffer", None)
    if isinstance(buffer, ReplayBuffer):
        for name, value in told["replay"].items():
            getattr(buffer, name)[: len(value)] = value.numpy()
        buffer.pos, buffer.full = told["replay_place"]


def _random_state(model: BaseAlgorithm) -> dict[str, Any]:
    kind, keys, position, has_gauss, gauss = np.random.get_state()  # noqa: NPY002
    return {
        "torch": torch.get_rng_state(),
        "numpy": (str(kind), torch.from_numpy(np.array(keys, dtype=np.int64)), position, has_gauss, gauss),
        "python": json.dumps(random.getstate()),
        "actions": json.dumps(_generators(model)),
    }


def _restore_random(told: Mapping[str, Any], model: BaseAlgorithm) -> None:
    torch.set_rng_state(told["torch"])
    kind, keys, position, has_gauss, gauss = told["numpy"]
    np.random.set_state((kind, keys.numpy().astype(np.uint32), position, has_gauss, gauss))  # noqa: NPY002
    version, numbers, gaussian = json.loads(told["python"])
    random.setstate((version, tuple(numbers), gaussian))
    model.action_space.np_random.bit_generator.state = json.loads(told["actions"])


def _generators(model: BaseAlgorithm) -> Any:
    return model.action_space.np_random.bit_generator.state
