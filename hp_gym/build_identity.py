"""Which build of the compiled core runs: the same build gives the same bits."""

import hashlib
from functools import cache
from pathlib import Path

from hp_gym import _core


@cache
def build() -> str:
    """Returns version and the beginning of the checksum of the compiled core."""
    digest = hashlib.sha256(Path(str(_core.__file__)).read_bytes()).hexdigest()
    return f"{_core.__version__}+{digest[:16]}"
