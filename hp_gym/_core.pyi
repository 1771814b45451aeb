"""The compiled core of `hp_gym` (rust_core/bindings)."""

from typing import Final

__all__ = ["__version__"]

__version__: Final[str]
