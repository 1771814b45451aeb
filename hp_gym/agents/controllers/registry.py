"""Controllers by name."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

from hp_gym.agents.controllers import learned, plain, python_class, rule_based
from hp_gym.agents.controllers.controller import Controller, ControllerError

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

DEFAULTS: Final = ("off", "random", "ptc-only", *rule_based.FILES, learned.REFERENCE)
"""Controllers of the comparison by name."""

RULES_SUFFIX: Final = ".toml"
POLICY_SUFFIXES: Final = (".safetensors", ".onnx", ".zip")


def resolve(
    name: str, *, seed: int = 0, seeds: Collection[int] | None = None, allow_code: bool = False
) -> list[Controller]:
    """Finds a controller.

    Args:
        name: One of `DEFAULTS`, the path of a policy (.safetensors, .onnx; .zip if allowed) or of a
            controller file (.toml), or `module:Class`.
        seed: Seed of the controller `random`.
        seeds: Training seeds of the reference policies to take; all by default.
        allow_code: Whether zip files of stable-baselines3 are loaded, which can run code.

    Returns:
        One controller; for the reference policies one for each training seed.

    Raises:
        ControllerError: There is none of that name, or it cannot be used; the message says what there is.
    """
    makers: dict[str, Callable[[], Controller]] = {
        "off": plain.off,
        "random": lambda: plain.random(seed),
        "ptc-only": rule_based.ptc_only,
        **{file: partial(rule_based.shipped, file) for file in rule_based.FILES},
    }
    if name == learned.REFERENCE:
        return learned.reference(seeds)
    if name in makers:
        return [makers[name]()]
    path = Path(name)
    if path.suffix in {*POLICY_SUFFIXES, RULES_SUFFIX}:
        if not path.is_file():
            raise ControllerError(f"controller `{name}`: there is no such file")
        if path.suffix == RULES_SUFFIX:
            return [rule_based.rules(path.stem, path)]
        return [learned.from_file(name, allow_code=allow_code)]
    if ":" in name:
        return [python_class.load(name)]
    message = (
        f"unknown controller `{name}`; available: {', '.join(DEFAULTS)}, the path of a policy "
        "(.safetensors, .onnx) or of a controller file (.toml), or module:Class"
    )
    raise ControllerError(message)
