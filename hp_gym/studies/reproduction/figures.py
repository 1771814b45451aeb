"""Counterparts of Figures 12, 13 and 14 of the paper."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Final

from hp_gym import extras
from hp_gym.pictures.picture_file import STYLE
from hp_gym.studies.reproduction.paper import PUBLISHED_SCENARIOS
from hp_gym.studies.reproduction.runs import Runs
from hp_gym.transactions import new_contents

with extras.needed("plot"):
    import matplotlib as mpl
    from matplotlib.figure import Figure
    from matplotlib.ticker import MultipleLocator

DESCRIPTIONS: Final = {scenario.label: scenario.description for scenario in PUBLISHED_SCENARIOS}

COLOURS: Final = ("#c1432e", "#2f6fa8", "#404040", "#8a8a8a", "#5fa3c7")
PHASES_MIN: Final = (
    ("low", 0.0),
    ("medium", 589.0 / 60.0),
    ("high", 1022.0 / 60.0),
    ("extra high", 1477.0 / 60.0),
    ("end", 30.0),
)
"""Phases of WLTC class 3b and when each starts."""


@dataclass(frozen=True)
class Panel:
    """A figure.

    Attributes:
        file: Name of the picture.
        title: What it shows.
        column: Temperature.
        curves: Short name, colour and line style of each run.
        levels_degc: Set points.
    """

    file: str
    title: str
    column: str
    curves: Sequence[tuple[str, str, str]]
    levels_degc: Sequence[tuple[float, str]]


RED, BLUE, BLACK, GREY, LIGHT_BLUE = COLOURS
CABIN_TARGET: Final = ((22.0, "set point"),)

PANELS: Final = (
    Panel(
        "figure12-battery-temperature.png",
        "Battery temperature, case 1 (paper Figure 12)",
        "battery_temperature_degc",
        (("S1", RED, "-"), ("S2", BLUE, "-"), ("S3", BLACK, "-")),
        ((20.0, "target of heating"),),
    ),
    Panel(
        "figure13-cabin-temperature-case1.png",
        "Cabin temperature, case 1 (paper Figure 13)",
        "cabin_temperature_degc",
        (("S1", RED, "-"), ("S2", BLUE, "-"), ("S3", BLACK, "-"), ("S4", BLACK, "--"), ("S5", BLUE, "--")),
        CABIN_TARGET,
    ),
    Panel(
        "figure14-cabin-temperature-case2.png",
        "Cabin temperature, case 2 (paper Figure 14)",
        "cabin_temperature_degc",
        (("D1", BLACK, "-"), ("D2", RED, "-"), ("D3", BLACK, "--"), ("D4", RED, "--")),
        CABIN_TARGET,
    ),
)


def draw(panel: Panel, runs: Runs) -> Figure:
    """Draws a figure."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.0, 4.6), layout="constrained")
        axes = figure.subplots()
        for (name, start_min), (_, end_min) in pairwise(PHASES_MIN):
            axes.axvline(start_min, color="#c8c8c8", linewidth=0.8, zorder=0)
            axes.text(
                0.5 * (start_min + end_min), 25.6, name, ha="center", va="top", fontsize=8, color="#606060"
            )
        for level_degc, name in panel.levels_degc:
            axes.axhline(level_degc, color="#808080", linestyle=":", linewidth=1.0)
            axes.annotate(
                name,
                (0.0, level_degc),
                xycoords=("axes fraction", "data"),
                xytext=(4, 3),
                textcoords="offset points",
                fontsize=8,
                color="#606060",
            )
        for label, colour, style in panel.curves:
            run = runs[label]
            text = f"{label[1]}: {DESCRIPTIONS[label]}"
            axes.plot(run["time_s"] / 60.0, run[panel.column], style, color=colour, linewidth=1.5, label=text)
        axes.set_title(panel.title)
        axes.set_xlabel("time [min]")
        axes.set_ylabel("temperature [°C]")
        axes.set_xlim(0.0, 30.0)
        axes.set_ylim(0.0, 26.0)
        axes.xaxis.set_major_locator(MultipleLocator(5.0))
        axes.yaxis.set_major_locator(MultipleLocator(5.0))
        figure.legend(loc="outside lower center", ncols=2 if len(panel.curves) == 4 else 3)
        return figure


def write_all(runs: Runs, folder: Path) -> list[Path]:
    """Writes all figures into a folder, or none, and returns their paths.

    Raises:
        FileError: The folder cannot be replaced.
        InUseError: Another process writes to it.
        OSError: It cannot be written to; what was there before is intact.
    """
    with new_contents(folder) as staged:
        for panel in PANELS:
            figure = draw(panel, runs)
            with mpl.rc_context(STYLE):
                figure.savefig(staged / panel.file, format="png")
    return [folder / panel.file for panel in PANELS]
