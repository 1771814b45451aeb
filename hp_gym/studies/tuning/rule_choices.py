"""A rule-based controller as choices band by band, and its file."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import tomlkit

from hp_gym.files import atomic_write
from hp_gym.overrides import Value
from hp_gym.studies.axes import Axis, Between
from hp_gym.studies.tuning.ambient_bands import Band

Choices = Mapping[str, Value]
"""Dotted keys below `strategy.` and `controller.` with their values."""

PAPER: Final[Choices] = {
    "strategy.battery": "heat",
    "strategy.ptc": True,
    "strategy.ambient": True,
    "strategy.motor": True,
    "strategy.transmission": True,
    "controller.cabin_set_point_degc": 22.0,
    "controller.htc_set_point_degc": 90.0,
    "controller.battery.heat_up_to_degc": 20.0,
    "controller.ptc_from_deviation_k": -20.0,
}
"""What Jeffs et al. 2019 choose: all sources, battery heated, PTC whenever it may (sections 2.2 to 2.4)."""


MODERN: Final[Choices] = {
    **PAPER,
    "strategy.battery": "isolate",
    "controller.ptc_from_deviation_k": -1.0,
    "controller.blower_level": 0.51,
    "controller.heating_recirculation": 0.7,
    "controller.options.heating_blower_band_k": 15.0,
    "controller.options.least_blower_level": 0.3,
    "controller.options.ptc_below_target_k": 0.5,
    "controller.options.battery_after_cabin_band_k": 1.0,
}
"""What `hpcu-modern` has beyond the paper's rules; its other options stay as they are."""

COOLING: Final[Choices] = {
    "controller.cooling_recirculation": 0.7,
    "controller.cooling_blower_level": 1.0,
    "controller.cooling_chiller_set_point_degc": 3.0,
    "controller.options.cooling_blower_band_k": 2.0,
}
"""What acts in a climate that is cooled in."""


def base_of(choices: Choices) -> str:
    """Name of the rules that choices are for: those with options, or the paper's."""
    return "hpcu-modern" if choices.keys() - PAPER.keys() else "hpcu"


def _axis(key: str, values: tuple[Value, ...] | Between) -> Axis:
    # Named by its whole key: the sampler takes axes by name, so that other names would be another search.
    return Axis(key, (key,), values)


BATTERY: Final = _axis("strategy.battery", ("heat", "isolate", "source"))
SWITCHES: Final = tuple(
    _axis(f"strategy.{part}", (True, False)) for part in ("ptc", "ambient", "motor", "transmission")
)
AXES: Final = (
    BATTERY,
    *SWITCHES,
    _axis("controller.cabin_set_point_degc", Between(17.0, 24.0)),
    _axis("controller.htc_set_point_degc", Between(30.0, 90.0)),
    _axis("controller.battery.heat_up_to_degc", Between(-20.0, 20.0)),
    _axis("controller.ptc_from_deviation_k", Between(-20.0, 30.0)),
    _axis("controller.blower_level", Between(0.3, 1.0)),
    _axis("controller.heating_recirculation", Between(0.0, 0.9)),
    _axis("controller.options.heating_blower_band_k", Between(2.0, 25.0)),
    _axis("controller.options.least_blower_level", Between(0.2, 0.5)),
    _axis("controller.options.ptc_below_target_k", Between(0.0, 5.0)),
    _axis("controller.options.battery_after_cabin_band_k", Between(0.5, 5.0)),
)
"""What is searched; the ranges hold the modern rules' choices and what a heat pump engineer would try."""

COOLING_AXES: Final = (
    _axis("controller.cooling_recirculation", Between(0.0, 0.9)),
    _axis("controller.cooling_blower_level", Between(0.4, 1.0)),
    _axis("controller.cooling_chiller_set_point_degc", Between(0.0, 12.0)),
    _axis("controller.options.cooling_blower_band_k", Between(0.5, 6.0)),
)
"""What is searched besides in a climate that is cooled in."""

COOLED_ABOVE_DEGC: Final = 20.0
"""A band that reaches beyond is one that is cooled in."""


def to_toml(description: str, bands: Sequence[tuple[Band, Choices]]) -> str:
    """Returns the controller file of choices for each band, cold to hot; all bands have one base."""
    document = tomlkit.document()
    for line in description.splitlines():
        document.add(tomlkit.comment(line))
    (base,) = {base_of(choices) for _, choices in bands}
    document["base"] = base
    rows = tomlkit.aot()
    for index, (band, choices) in enumerate(bands):
        row = tomlkit.table()
        # Rules must not end where the training trips do.
        last = index == len(bands) - 1
        row["up_to_degc"] = 100.0 if last else float(band.high_degc)
        for key, value in choices.items():
            _place(row, key.split("."), value)
        rows.append(row)
    document["ambient_bands"] = rows
    return tomlkit.dumps(document)


def write(path: Path, description: str, bands: Sequence[tuple[Band, Choices]]) -> None:
    """Writes a controller file whole or not at all, but not past a power cut.

    Raises:
        OSError: The folder cannot be written to.
    """
    with atomic_write(path, durable=False) as temporary:
        temporary.write_text(to_toml(description, bands), encoding="utf-8")


def _place(table: Any, steps: list[str], value: Value) -> None:
    for step in steps[:-1]:
        if step not in table:
            table[step] = tomlkit.table()
        table = table[step]
    table[steps[-1]] = round(value, 3) if isinstance(value, float) else value
