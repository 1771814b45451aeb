"""A rule-based controller as choices band by band, and its file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, Self

import tomlkit

from hp_gym.files import atomic_write
from hp_gym.overrides import Value
from hp_gym.studies.tuning.ambient_bands import Band


@dataclass(frozen=True)
class Choices:
    """What a rule-based controller is made of in one ambient band.

    Attributes:
        base: Controller whose file has what is not chosen.
        values: Dotted keys below `strategy.` and `controller.` with their values.
    """

    base: str
    values: Mapping[str, Value]

    def changed(self, values: Mapping[str, Value]) -> Self:
        """The same with some other values."""
        return replace(self, values={**self.values, **values})


PAPER: Final = Choices(
    "hpcu",
    {
        "strategy.battery": "heat",
        "strategy.ptc": True,
        "strategy.ambient": True,
        "strategy.motor": True,
        "strategy.transmission": True,
    },
)
"""What Jeffs et al. 2019 choose (sections 2.2 to 2.4): all sources, battery heated; numbers as their file."""


def to_toml(description: str, bands: Sequence[tuple[Band, Choices]]) -> str:
    """Returns the controller file of choices for each band, cold to hot; all bands have one base."""
    document = tomlkit.document()
    for line in description.splitlines():
        document.add(tomlkit.comment(line))
    (document["base"],) = {choices.base for _, choices in bands}
    rows = tomlkit.aot()
    for index, (band, choices) in enumerate(bands):
        row = tomlkit.table()
        # Rules must not end where the training trips do.
        last = index == len(bands) - 1
        row["up_to_degc"] = 100.0 if last else float(band.high_degc)
        for key, value in choices.values.items():
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
