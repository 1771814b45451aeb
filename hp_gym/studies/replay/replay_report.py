"""A replay as tables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from rich.table import Table
from rich.text import Text

from hp_gym.key_units import unit_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hp_gym.studies.replay.replaying import Replay
    from hp_gym.studies.replay.series_errors import SeriesError
    from hp_gym.studies.replay.trip_figures import Pair

_LABELS: Final = {
    "energy_kwh": "Energy from the battery",
    "drive_energy_kwh": "Energy without heaters",
    "heating_energy_kwh": "Energy of heaters",
    "heater_last_300_s_w": "Power of heaters, last 300 s",
    "battery_rise_k": "Battery's rise of temperature",
    "cabin_above_18_degc_s": "Cabin above 18 °C",
}

_DECIMALS: Final = {"kWh": 3, "W": 0, "K": 2, "s": 0, "°C": 2}


def figure_rows(figures: Mapping[str, Pair]) -> list[tuple[str, str, str, str, str]]:
    """Figures as text: label, measured, model, model less measured, unit."""
    rows = []
    for name, pair in figures.items():
        unit = unit_of(name)
        deviation = _number(pair.deviation, unit, sign="+")
        share = _share(pair)
        told = f"{deviation} ({share})" if share else deviation
        rows.append((_LABELS[name], _number(pair.measured, unit), _number(pair.model, unit), told, unit))
    return rows


def _number(value: float | None, unit: str, sign: str = "") -> str:
    return "-" if value is None else f"{value:{sign}.{_DECIMALS[unit]}f}"


def _share(pair: Pair) -> str:
    """Deviation of the measured value in percent; nothing where there is none."""
    if pair.deviation is None or not pair.measured:
        return ""
    return f"{100.0 * pair.deviation / abs(pair.measured):+.1f} %"


def figure_table(replay: Replay) -> Table:
    """What the trip comes to, measured and in the model."""
    title = Text(f"{replay.title}: {replay.trajectory.end_reason.replace('_', ' ')}", style="bold")
    table = Table(box=None, header_style="bold", pad_edge=False, title=title, title_justify="left")
    table.add_column("", no_wrap=True)
    for heading in ("Measured", "Model", "Model less measured"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("", no_wrap=True, style="dim")
    for row in figure_rows(replay.figures):
        table.add_row(*row)
    return table


def error_table(errors: tuple[SeriesError, ...]) -> Table:
    """How far the model is from what was measured, second by second."""
    title = Text("Model less measured, second by second", style="bold")
    table = Table(box=None, header_style="bold", pad_edge=False, title=title, title_justify="left")
    table.add_column("", no_wrap=True)
    for heading in ("Mean (bias)", "Root mean square", "Largest"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("", no_wrap=True, style="dim")
    for error in errors:
        unit = error.quantity.unit
        numbers = (
            _number(error.bias, unit, "+"),
            _number(error.rmse, unit),
            _number(error.largest, unit),
        )
        table.add_row(error.quantity.label, *numbers, "K" if unit == "°C" else unit)
    return table
