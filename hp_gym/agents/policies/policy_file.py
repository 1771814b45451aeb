"""Policy files: tensors and metadata in one safetensors file."""

import json
import os
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError
from safetensors import SafetensorError
from safetensors.numpy import load as from_bytes
from safetensors.numpy import save as to_bytes

from hp_gym import ConfigurationError
from hp_gym.agents.policies.checksum import CHECKSUM_KEY, checksum, verify
from hp_gym.agents.policies.errors import PolicyError
from hp_gym.agents.policies.saved_policy import FORMAT_VERSION, Metadata, Normalisation, SavedPolicy
from hp_gym.files import atomic_write, read_bytes, require_suffix
from hp_gym.messages import FileError
from hp_gym.pydantic_errors import one_line

METADATA_KEY: Final = "hp_gym_policy"
"""Key of the JSON text in the header."""

LARGEST_BYTES: Final = 256 * 2**20

Tensors = Mapping[str, NDArray[Any]]


def save(path: str | os.PathLike[str], policy: SavedPolicy) -> None:
    """Writes a policy whole or not at all.

    Raises:
        ValueError: The name does not end with `.safetensors`.
        OSError: The file cannot be written; what was there before is intact.
    """
    require_suffix(path, [".safetensors"])
    tensors, text = tensors_of(policy), metadata_text(policy)
    data = to_bytes(tensors, {METADATA_KEY: text, CHECKSUM_KEY: checksum(text, tensors)})
    with atomic_write(path) as temporary:
        temporary.write_bytes(data)


def read(path: str | os.PathLike[str]) -> SavedPolicy:
    """Reads a policy and checks all of it; never runs code.

    Raises:
        PolicyError: The file is truncated, foreign, or does not fit this version of hp_gym.
        OSError: The file cannot be read.
    """
    return parse(os.fspath(path), file_bytes(path))


def file_bytes(path: str | os.PathLike[str]) -> bytes:
    """Reads a policy file of any kind.

    Raises:
        PolicyError: It is no regular file, or too large for a policy.
        OSError: It cannot be read.
    """
    try:
        return read_bytes(path, LARGEST_BYTES)
    except FileError as error:
        raise PolicyError(str(error)) from error


def metadata_text(policy: SavedPolicy) -> str:
    """Returns the metadata of a policy as a file of today holds them."""
    return policy.metadata.model_copy(update={"format_version": FORMAT_VERSION}).model_dump_json()


def parse(name: str, data: bytes) -> SavedPolicy:
    """Makes a policy of the bytes of a policy file and checks all of it; never runs code.

    Args:
        name: The file, for messages.
        data: What it holds.

    Raises:
        PolicyError: It is truncated, foreign, or does not fit this version of hp_gym.
    """
    try:
        tensors = from_bytes(data)
        notes = _header(data).get("__metadata__", {})
    # A type of number that numpy lacks is a KeyError of the library.
    except (SafetensorError, KeyError, ValueError, TypeError) as error:
        message = f"{name}: no complete safetensors file ({error})"
        raise PolicyError(message) from error
    text = notes.get(METADATA_KEY)
    if text is None:
        message = f"{name}: a safetensors file, but no policy of hp_gym (no `{METADATA_KEY}` in its header)"
        raise PolicyError(message)
    return assemble(name, text, tensors, notes.get(CHECKSUM_KEY))


def _header(data: bytes) -> dict[str, Any]:
    """The header of a safetensors file that the library has found to be complete."""
    length = int.from_bytes(data[:8], "little")
    header: dict[str, Any] = json.loads(data[8 : 8 + length])
    return header


def tensors_of(policy: SavedPolicy) -> dict[str, NDArray[Any]]:
    """Returns the numbers of a policy by name."""
    tensors: dict[str, NDArray[Any]] = {}
    for index, (weight, bias) in enumerate(policy.layers):
        tensors[f"layers.{index}.weight"] = np.ascontiguousarray(weight)
        tensors[f"layers.{index}.bias"] = np.ascontiguousarray(bias)
    if policy.normalisation is not None:
        tensors["observation.mean"] = np.ascontiguousarray(policy.normalisation.mean)
        tensors["observation.variance"] = np.ascontiguousarray(policy.normalisation.variance)
        tensors["observation.clip"] = np.array([policy.normalisation.clip])
        tensors["observation.epsilon"] = np.array([policy.normalisation.epsilon])
    return tensors


def assemble(name: str, text: str, tensors: Tensors, found: str | None) -> SavedPolicy:
    """Makes a policy of metadata in JSON and tensors, and checks that they fit each other and hp_gym.

    Args:
        name: The file, for messages.
        text: Metadata.
        tensors: Numbers by name.
        found: The checksum in the file; none in older ones.

    Raises:
        PolicyError: Something does not fit, or is damaged.
    """
    try:
        metadata = Metadata.model_validate_json(text)
    except ValidationError as error:
        message = f"{name}: metadata: {one_line(error)}"
        raise PolicyError(message) from error
    verify(name, metadata.format_version, found, text, tensors)
    try:
        counts = metadata.environment.option_counts()
    except ConfigurationError as error:
        message = f"{name}: does not fit this version of hp_gym: {error}"
        raise PolicyError(message) from error
    if counts != metadata.option_counts:
        message = (
            f"{name}: has {list(metadata.option_counts)} options, but its actions have {list(counts)} in "
            "this version of hp_gym"
        )
        raise PolicyError(message)
    if metadata.environment.continuous is (metadata.output == "argmax"):
        message = f"{name}: metadata: `output` {metadata.output} does not fit the kind of actions"
        raise PolicyError(message)
    if metadata.masked and metadata.environment.continuous:
        message = f"{name}: metadata: `masked`, but continuous actions have no masks"
        raise PolicyError(message)
    _check_tensors(name, metadata, tensors)
    bounds = metadata.environment.observation_bounds
    if bounds is not None and set(bounds) != set(metadata.environment.observations):
        apart = sorted(set(bounds) ^ set(metadata.environment.observations))
        message = f"{name}: metadata: `observation_bounds` and `observations` differ in `{apart[0]}`"
        raise PolicyError(message)
    layers = tuple(
        (tensors[f"layers.{i}.weight"], tensors[f"layers.{i}.bias"])
        for i in range(len(metadata.network.hidden_sizes) + 1)
    )
    if "observation.mean" not in tensors:
        return SavedPolicy(metadata, layers)
    normalisation = Normalisation(
        tensors["observation.mean"],
        tensors["observation.variance"],
        float(tensors["observation.clip"][0]),
        float(tensors["observation.epsilon"][0]),
    )
    if normalisation.variance.min() < 0.0 or normalisation.epsilon <= 0.0 or normalisation.clip <= 0.0:
        message = f"{name}: tensor `observation.*`: variance below 0, or epsilon or clip not above 0"
        raise PolicyError(message)
    return SavedPolicy(metadata, layers, normalisation)


def _check_tensors(name: str, metadata: Metadata, tensors: Tensors) -> None:
    expected = _expected_shapes(metadata, normalised=any(key.startswith("observation.") for key in tensors))
    for key in sorted(expected.keys() | tensors.keys()):
        if key not in tensors:
            message = f"{name}: tensor `{key}` is missing"
        elif key not in expected:
            message = f"{name}: tensor `{key}` is unknown"
        else:
            tensor, (dtype, shape) = tensors[key], expected[key]
            if tensor.dtype == dtype and tensor.shape == shape and np.isfinite(tensor).all():
                continue
            given = f"{tensor.dtype}{list(tensor.shape)}"
            wanted = f"{dtype}{list(shape)}"
            message = f"{name}: tensor `{key}` is {given}, but must be {wanted} of finite numbers"
        raise PolicyError(message)


def _expected_shapes(
    metadata: Metadata, *, normalised: bool
) -> dict[str, tuple[np.dtype[Any], tuple[int, ...]]]:
    single, double = np.dtype(np.float32), np.dtype(np.float64)
    rows = len(metadata.environment.observations)
    outputs = sum(metadata.option_counts) or len(metadata.environment.actions)
    sizes = [rows, *metadata.network.hidden_sizes, outputs]
    shapes: dict[str, tuple[np.dtype[Any], tuple[int, ...]]] = {}
    for index in range(len(sizes) - 1):
        shapes[f"layers.{index}.weight"] = single, (sizes[index + 1], sizes[index])
        shapes[f"layers.{index}.bias"] = single, (sizes[index + 1],)
    if normalised:
        shapes["observation.mean"] = shapes["observation.variance"] = double, (rows,)
        shapes["observation.clip"] = shapes["observation.epsilon"] = double, (1,)
    return shapes
