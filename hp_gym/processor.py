"""Whether this processor has what the extension was built for; looked at before any of its code runs."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

_MARK = b"hp_gym built for AVX2 and FMA"
"""What a build for such processors holds, and no other: its `__built_for__`."""

_NEEDED = ("AVX2", "FMA3")
"""Names that NumPy gives the features."""


def check(extension: Path | None = None, features: Mapping[str, bool] | None = None) -> None:
    """Checks that the extension can run here.

    The extension cannot check this itself: code that would say so is built for the same processor.

    Args:
        extension: File of the extension; that of this package by default.
        features: Features of the processor by NumPy's names; those that NumPy has found by default.

    Raises:
        ImportError: The extension needs instructions that this processor lacks.
    """
    features = _found() if features is None else features
    lacking = [name for name in _NEEDED if not features.get(name, True)]
    if not lacking:
        return
    if extension is None:
        spec = importlib.util.find_spec("hp_gym._core")
        extension = Path(spec.origin) if spec is not None and spec.origin is not None else None
    if extension is None or _MARK not in extension.read_bytes():
        return
    message = (
        f"hp_gym was built for x86-64-v3, but this processor lacks {', '.join(lacking)}; "
        'build it here with RUSTFLAGS="-C target-cpu=native" (see docs/performance.md)'
    )
    raise ImportError(message)


def _found() -> Mapping[str, bool]:
    """Features of this processor; none where this NumPy does not tell."""
    try:
        numpy = importlib.import_module("numpy._core._multiarray_umath")
    except ImportError:
        return {}
    features: Mapping[str, bool] = getattr(numpy, "__cpu_features__", {})
    return features


try:
    check()
except ImportError as error:
    # The command's own script imports this package before any of its code could catch this.
    if Path(*sys.argv[:1]).stem == "hp-gym":
        sys.exit(f"hp-gym: {error}")
    raise
