"""Optional packages: what each extra of the package brings, and the one line that tells how to get it."""

from __future__ import annotations

from contextlib import contextmanager
from importlib.util import find_spec
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Generator, Iterable, Mapping

DISTRIBUTION: Final = "ev-heat-pump-gym"
"""Name under which the package is installed."""

EXTRAS: Final[Mapping[str, tuple[str, ...]]] = {
    "benchmark": (
        "jinja2", "pandas", "plotly", "pyarrow", "pydantic", "safetensors", "threadpoolctl", "tomlkit"
    ),
    "data": ("h5py", "minari", "PIL", "pydantic", "safetensors"),
    "export": ("onnx", "onnxruntime", "pydantic", "safetensors"),
    "plot": ("matplotlib", "PIL"),
    "ray": ("pandas", "pyarrow", "ray"),
    "speed": ("fastsim",),
    "studies": ("matplotlib", "optuna", "PIL", "pydantic", "scipy", "sqlalchemy", "tomlkit"),
    "sweep": ("matplotlib", "pandas", "PIL", "pyarrow", "SALib", "scipy", "xarray"),
    "train": (
        "pydantic", "safetensors", "sb3_contrib", "stable_baselines3", "tensorboard", "tomlkit", "torch"
    ),
}  # fmt: skip
"""Import names of the packages that hp_gym itself uses, by extra (pyproject.toml)."""


class MissingExtraError(ImportError):
    """Packages that an optional part of hp_gym needs are not installed; the message says how to get them."""

    def __init__(self, extra: str, missing: Iterable[str]) -> None:
        names = ", ".join(missing)
        super().__init__(
            f"not installed: {names}; get it with the extra `{extra}`: "
            f'pip install "{DISTRIBUTION}[{extra}]" (in a clone: uv run --extra {extra} ...)'
        )
        self.extra = extra


def require(extra: str, *packages: str) -> None:
    """Checks, without importing them, that packages are installed.

    Args:
        extra: The extra that brings them, one of `EXTRAS`.
        *packages: Import names; all of the extra by default.

    Raises:
        MissingExtraError: One is not installed.
    """
    missing = [package for package in packages or EXTRAS[extra] if not _is_installed(package)]
    if missing:
        raise MissingExtraError(extra, missing)


@contextmanager
def needed(extra: str) -> Generator[None]:
    """Surrounds imports of packages that an extra brings.

    Raises:
        MissingExtraError: One of them is not installed.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        if package not in EXTRAS[extra]:
            raise
        raise MissingExtraError(extra, [package]) from error


def _is_installed(package: str) -> bool:
    try:
        return find_spec(package) is not None
    except (ImportError, ValueError):
        return False
