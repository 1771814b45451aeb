"""Energy and discomfort of every controller, climate by climate."""

from __future__ import annotations

import html
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import plotly.graph_objects as go

from agents.benchmark.report.layout import PAPER, band_title, difference_path
from agents.benchmark.report.pareto import HIDDEN

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agents.benchmark.report.layout import Layout
    from agents.benchmark.report.palette import Style


@dataclass(frozen=True)
class Difference:
    """A difference to the paper's rules as it is drawn.

    Attributes:
        value: Its name in the summary.
        interval: Name of its interval.
        title: Title of the figure.
        unit: Unit at the axis.
    """

    value: str
    interval: str
    title: str
    unit: str


ENERGY: Final = Difference(
    "energy_difference_pct", "energy_difference_ci95", "Attributable energy against hpcu, 95 % intervals", "%"
)
DISCOMFORT: Final = Difference(
    "discomfort_difference_k",
    "discomfort_difference_ci95",
    "Mean discomfort against hpcu, 95 % intervals",
    "K",
)


def bars(layout: Layout, kpi: str, title: str, unit: str, looks: Mapping[str, Style]) -> go.Figure:
    """Draws a KPI in each climate band as one bar a controller.

    Args:
        layout: Summary to read from.
        kpi: Name of the KPI.
        title: Title of the figure.
        unit: Unit at the axis.
        looks: Look of each controller.
    """
    figure = go.Figure()
    for name in layout.controllers:
        # What a trip used until it stranded cannot be compared.
        values = [
            None if layout.kpi(name, "stranded", band) else layout.kpi(name, kpi, band)
            for band in layout.bands
        ]
        figure.add_bar(
            x=_names(layout),
            y=[None if value is None else round(value, 4) for value in values],
            marker={"color": looks[name].colour, "pattern": {"shape": looks[name].pattern}},
            name=html.escape(name),
            visible="legendonly" if name in HIDDEN else True,
            hovertemplate="%{x}: %{y} " + unit,
        )
    figure.update_layout(barmode="group", title_text=title, yaxis_title=unit, **_ambient_axis())
    return figure


def differences(layout: Layout, what: Difference, looks: Mapping[str, Style]) -> go.Figure:
    """Draws the paired difference of every controller to the paper's rules with its interval.

    Args:
        layout: Summary to read from.
        what: The difference.
        looks: Look of each controller.
    """
    figure = go.Figure()
    others = [name for name in layout.controllers if name != PAPER]
    for name in others:
        known = [
            (band, value, ends)
            for band in layout.bands
            if (value := layout.summary.number(*difference_path(name, band, what.value))) is not None
            and (ends := layout.interval(name, band, what.interval)) is not None
        ]
        figure.add_scatter(
            x=[html.escape(band_title(band)) for band, _, _ in known],
            y=[round(value, 4) for _, value, _ in known],
            error_y={
                "type": "data",
                "symmetric": False,
                "array": [round(ends[1] - value, 4) for _, value, ends in known],
                "arrayminus": [round(value - ends[0], 4) for _, value, ends in known],
                "thickness": 1.5,
                "width": 4,
            },
            mode="markers",
            cliponaxis=False,
            marker={"color": looks[name].colour, "symbol": looks[name].symbol, "size": 8},
            name=html.escape(name),
            # Far from the others where there is nothing to heat.
            visible="legendonly" if name in {*HIDDEN, "ptc-only"} else True,
            hovertemplate="%{x}: %{y} " + what.unit,
        )
    figure.add_hline(y=0.0, line={"color": looks[PAPER].colour, "width": 1.5})
    figure.update_layout(
        scattermode="group", scattergap=0.4, title_text=what.title, yaxis_title=what.unit, **_ambient_axis()
    )
    figure.update_xaxes(categoryorder="array", categoryarray=_names(layout))
    return figure


def _names(layout: Layout) -> list[str]:
    return [html.escape(band_title(band)) for band in layout.bands]


def _ambient_axis() -> dict[str, str]:
    return {"xaxis_title": "ambient temperature, °C", "xaxis_type": "category"}
