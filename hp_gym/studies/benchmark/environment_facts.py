"""What a benchmark ran on: figures of a run can only be repeated bit for bit by the same versions."""

import importlib.metadata
import os
import platform
from pathlib import Path
from typing import Any, Final

import hp_gym

_PACKAGES: Final = ("gymnasium", "numpy", "pandas")


def versions() -> dict[str, str]:
    """Versions of what the figures depend on."""
    found = {"hp_gym": hp_gym.__version__, "python": platform.python_version()}
    return found | {package: importlib.metadata.version(package) for package in _PACKAGES}


def hardware() -> dict[str, Any]:
    """Processor and number of cores."""
    return {"processor": _processor(), "cores": os.cpu_count(), "system": platform.system()}


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.machine()
