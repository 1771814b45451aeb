"""Controllers by name."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

from agents.controllers import plain, policy, python_class, rules
from agents.controllers.controller import Controller, ControllerError

if TYPE_CHECKING:
    from collections.abc import Collection

DEFAULTS: Final = ("off", "random", "ptc-only", *rules.FILES, policy.REFERENCE)
"""Controllers of the comparison by name."""

POLICY_SUFFIXES: Final = (".safetensors", ".onnx", ".zip")


def resolve(name: str, *, seed: int = 0, seeds: Collection[int] | None = None) -> list[Controller]:
    """Finds a controller.

    Args:
        name: One of `DEFAULTS`, the path of a policy (.safetensors, .onnx) or of a controller file (.toml), or
            `module:Class`.
        seed: Seed of the controller `random`.
        seeds: Training seeds of the reference policies to take; all by default.

    Returns:
        One controller; for the reference policies one for each training seed.

    Raises:
        ControllerError: There is none of that name, or it cannot be used; the message says what there is.
    """
    if name == "off":
        return [plain.off()]
    if name == "random":
        return [plain.random(seed)]
    if name == "ptc-only":
        return [rules.ptc_only()]
    if name in rules.FILES:
        return [rules.shipped(name)]
    if name == policy.REFERENCE:
        return policy.reference(seeds)
    suffix = Path(name).suffix
    if suffix in {*POLICY_SUFFIXES, ".toml"} and not Path(name).is_file():
        raise ControllerError(f"controller `{name}`: there is no such file")
    if suffix in POLICY_SUFFIXES:
        return [policy.from_file(name)]
    if suffix == ".toml":
        return [rules.rules(Path(name).stem, name)]
    if ":" in name:
        return [python_class.load(name)]
    known = ", ".join(DEFAULTS)
    message = (
        f"unknown controller `{name}`; available: {known}, the path of a policy (.safetensors, .onnx) "
        "or of a controller file (.toml), or module:Class"
    )
    raise ControllerError(message)
