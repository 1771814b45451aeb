"""Checksums of policies: they guard against damage, not intent."""

import hashlib
import warnings
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from hp_gym.agents.policies.errors import PolicyError
from hp_gym.messages import UncheckedFileWarning

CHECKSUM_KEY: Final = "hp_gym_sha256"
"""Key of the checksum beside the metadata."""

OLDEST_WITH_CHECKSUM: Final = 2
"""Format version since which a file has one."""


def checksum(text: str, tensors: Mapping[str, NDArray[Any]]) -> str:
    """Returns the SHA-256 of a policy, whatever the kind of file.

    Args:
        text: Metadata in JSON.
        tensors: Numbers by name.
    """
    digest = hashlib.sha256(text.encode("utf-8"))
    for name, tensor in sorted(tensors.items()):
        digest.update(f"\n{name} {tensor.dtype.str} {tensor.shape}\n".encode())
        digest.update(np.ascontiguousarray(tensor).data)
    return digest.hexdigest()


def verify(
    name: str, version: int, found: str | None, text: str, tensors: Mapping[str, NDArray[Any]]
) -> None:
    """Checks what was read against the checksum beside it; older files have none, which is noted.

    Args:
        name: The file, for messages.
        version: Format version of its metadata.
        found: The checksum in it.
        text: Metadata in JSON.
        tensors: Numbers by name.

    Raises:
        PolicyError: The file is damaged.
    """
    if found is None and version < OLDEST_WITH_CHECKSUM:
        warnings.warn(
            f"{name}: without checksum, only its values are checked", UncheckedFileWarning, stacklevel=2
        )
    elif found is None:
        message = f"{name}: its checksum is missing, but files of format version {version} have one"
        raise PolicyError(message)
    elif found != checksum(text, tensors):
        message = f"{name}: damaged: its checksum is another than the one written in it"
        raise PolicyError(message)
