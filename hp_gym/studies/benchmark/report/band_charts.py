"""Energy and discomfort of every controller, climate by climate."""

from __future__ import annotations

import html
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import plotly.graph_objects as go

from hp_gym.studies.benchmark.report.layout import PAPER, band_title, difference_path
from hp_gym.studies.benchmark.report.pareto import HIDDEN

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hp_gym.studies.benchmark.report.layout import Layout
    from hp_gym.studies.benchmark.report.palette import Style


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
    "energy_difference_pct", "energy_difference_ci95", "Attributable energy against hpcu", "%"
)
DISCOMFORT: Final = Difference(
    "discomfort_difference_k",
    "discomfort_difference_ci95",
    "Mean discomfort against hpcu",
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
        known = [
            (band, value)
            for band in layout.bands
            if not layout.kpi(name, "stranded", band) and (value := layout.kpi(name, kpi, band)) is not None
        ]
        figure.add_bar(
            x=[_title(band) for band, _ in known],
            y=[round(value, 4) for _, value in known],
            marker={"color": looks[name].colour, "pattern": {"shape": looks[name].pattern}},
            name=html.escape(name),
            legendgroup=name,
            visible="legendonly" if name in HIDDEN else True,
            hovertemplate="%{x}: %{y} " + unit,
        )
    figure.update_layout(barmode="group")
    return _finished(figure, layout, title, unit)


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
            x=[_title(band) for band, _, _ in known],
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
            legendgroup=name,
            # Far from the others where there is nothing to heat.
            visible="legendonly" if name in {*HIDDEN, "ptc-only"} else True,
            hovertemplate="%{x}: %{y} " + what.unit,
        )
    figure.add_hline(y=0.0, line={"color": looks[PAPER].colour, "width": 1.5})
    figure.update_layout(scattermode="group", scattergap=0.4)
    return _finished(figure, layout, what.title, what.unit)


def _finished(figure: go.Figure, layout: Layout, title: str, unit: str) -> go.Figure:
    figure.update_layout(title_text=title, yaxis_title=unit, xaxis_title="ambient, °C")
    names = [_title(band) for band in layout.bands]
    figure.update_xaxes(type="category", categoryorder="array", categoryarray=names)
    return figure


def _title(band: str) -> str:
    return html.escape(band_title(band))
