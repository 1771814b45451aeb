"""A picture in the house's style, as a figure and as a file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from hp_gym import extras
from hp_gym.files import atomic_write, require_suffix
from hp_gym.pictures.panels import GREY

with extras.needed("plot"):
    import matplotlib as mpl

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from matplotlib.figure import Figure
    from matplotlib.typing import RcKeyType

SUFFIXES: Final = (".png", ".svg", ".pdf")

STYLE: Final[dict[RcKeyType, Any]] = {
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": GREY,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.xmargin": 0.0,
    "grid.color": "#ececec",
    "xtick.color": "#404040",
    "ytick.color": "#404040",
    "lines.linewidth": 1.3,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "legend.handlelength": 1.2,
    "legend.columnspacing": 1.0,
    "legend.borderaxespad": 0.0,
    "savefig.dpi": 150,
}


def drawn(draw: Callable[[], Figure], path: str | os.PathLike[str] | None, *, grid: bool = True) -> Figure:
    """Draws a figure and, where there is a path, writes it whole or not at all.

    Args:
        draw: Makes the figure; not called where the path is not right.
        path: Picture to write; None for the figure alone.
        grid: Whether panels have grid lines.

    Raises:
        ValueError: The path ends with none of `SUFFIXES`.
        OSError: The file cannot be written; one that stood there stays as it was.
    """
    suffix = "" if path is None else require_suffix(path, SUFFIXES)
    with mpl.rc_context({**STYLE, "axes.grid": grid}):
        figure = draw()
        if path is not None:
            with atomic_write(path) as temporary:
                figure.savefig(temporary, format=suffix.removeprefix("."))
    return figure
