"""The configuration files that a calibration starts from and returns to."""

import re
from collections.abc import Mapping, MutableMapping
from pathlib import Path
from typing import Any, Final

import tomlkit
from tomlkit.items import Item

import hp_gym
from hp_gym import _core, toml_files
from hp_gym.files import atomic_write
from hp_gym.studies.calibration.problem import CalibrationError, Problem

FOLDERS: Final = {"vehicle": "vehicles", "controller": "controllers", "scenario": "scenarios"}


def current_values(problem: Problem) -> dict[str, float]:
    """Present value of each parameter, by its first key.

    Raises:
        CalibrationError: A key is not in the files.
    """
    values = {}
    for parameter in problem.parameters:
        kind, name, path = _address(problem, parameter.name, _scenarios(problem)[0])
        file, table = _owner(kind, name, path)
        value = _find(table, path)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise CalibrationError(f"{file}: `{'.'.join(path)}` is {value!r}, but must be a number")
        values[parameter.name] = float(value)
    return values


def write_back(problem: Problem, values: Mapping[str, float]) -> list[Path]:
    """Replaces the values in the checkout's files and leaves all else, comments included, as it is.

    Args:
        problem: The calibration.
        values: New value of every key.

    Returns:
        Files that were written.

    Raises:
        CalibrationError: This is no checkout, or it differs from what is compiled in.
    """
    configs = checkout() / "configs"
    documents: dict[Path, tomlkit.TOMLDocument] = {}
    for key, value in values.items():
        scenarios = _scenarios(problem)
        for scenario in scenarios if key.startswith("scenario.") else scenarios[:1]:
            kind, name, path = _address(problem, key, scenario)
            file, _ = _owner(kind, name, path)
            place = configs / FOLDERS[kind] / f"{file}.toml"
            if place not in documents:
                text = place.read_text(encoding="utf-8")
                if text != _core.config_text(kind, file):
                    raise CalibrationError(f"{place} is not what is compiled in; build first (`uv sync`)")
                documents[place] = tomlkit.parse(text)
            _replace(documents[place], path, value)
    for place, document in documents.items():
        with atomic_write(place) as temporary:
            temporary.write_text(tomlkit.dumps(document), encoding="utf-8")
    return list(documents)


def checkout() -> Path:
    """Folder of the checkout that this package runs from.

    Raises:
        CalibrationError: It runs from somewhere else.
    """
    root = Path(hp_gym.__file__).resolve().parent.parent
    if not (root / "configs" / "vehicles").is_dir() or not (root / "Cargo.toml").is_file():
        raise CalibrationError("values can only be written back in a checkout of the repository")
    return root


def _scenarios(problem: Problem) -> list[str]:
    targets = [target.scenario for target in problem.targets]
    return targets + [one.scenario for one in problem.measurements]


def _address(problem: Problem, key: str, scenario: str) -> tuple[str, str, list[str]]:
    """Kind of file, its name and the path in it of a dotted key; `share[2]` becomes two steps."""
    kind, _, rest = key.partition(".")
    names = {"vehicle": problem.vehicle, "controller": problem.controller, "scenario": scenario}
    if kind not in names or not rest:
        raise CalibrationError(
            f"key `{key}` must begin with one of {', '.join(f'{name}.' for name in names)}"
        )
    return kind, names[kind], re.findall(r"[^.\[\]]+", rest)


def _owner(kind: str, name: str, path: list[str]) -> tuple[str, Mapping[str, Any]]:
    """File that holds a value, the file itself or one of its bases."""
    for file, table in toml_files.chain(kind, name):
        if _find(table, path) is not None:
            return file, table
    raise CalibrationError(f"{name}: there is no `{'.'.join(path)}` in this {kind}")


def _find(table: Mapping[str, Any], path: list[str]) -> Any:
    place: Any = table
    for step in path:
        if isinstance(place, Mapping):
            place = place.get(step)
        elif isinstance(place, list) and step.isdecimal() and int(step) < len(place):
            place = place[int(step)]
        else:
            return None
    return place


def _replace(document: MutableMapping[str, Any], path: list[str], value: float) -> None:
    place: Any = document
    for step in path[:-1]:
        place = place[int(step) if isinstance(place, list) else step]
    last: Any = int(path[-1]) if isinstance(place, list) else path[-1]
    old = place[last]
    place[last] = value
    new = place[last]
    if isinstance(new, Item) and isinstance(old, Item) and new.trivia.comment:
        shift = len(old.as_string()) - len(new.as_string())
        new.trivia.comment_ws = " " * max(1, len(new.trivia.comment_ws) + shift)
