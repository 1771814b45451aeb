"""Energy and discomfort of every controller, climate by climate."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING

import plotly.graph_objects as go

from agents.benchmark.report.pareto import HIDDEN

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agents.benchmark.report.layout import Layout
    from agents.benchmark.report.palette import Style


def bars(layout: Layout, kpi: str, title: str, unit: str, looks: Mapping[str, Style]) -> go.Figure:
    """Draws a KPI in each climate band as one bar a controller, with its interval where there is one.

    Args:
        layout: Summary to read from.
        kpi: Name of the KPI.
        title: Title of the figure.
        unit: Unit at the axis.
        looks: Look of each controller.
    """
    figure = go.Figure()
    for name in layout.controllers:
        values = [layout.kpi(name, kpi, band) for band in layout.bands]
        intervals = [layout.interval(name, kpi, band) for band in layout.bands]
        bars_of = [
            (band, value, interval)
            for band, value, interval in zip(layout.bands, values, intervals, strict=True)
            if value is not None
        ]
        figure.add_bar(
            x=[f"{html.escape(band)} °C" for band, _, _ in bars_of],
            y=[round(value, 4) for _, value, _ in bars_of],
            error_y={
                "type": "data",
                "symmetric": False,
                "array": [round(ends[1] - value, 4) if ends else 0.0 for _, value, ends in bars_of],
                "arrayminus": [round(value - ends[0], 4) if ends else 0.0 for _, value, ends in bars_of],
                "visible": any(ends for _, _, ends in bars_of),
                "thickness": 1,
                "width": 2,
            },
            marker={"color": looks[name].colour, "pattern": {"shape": looks[name].pattern}},
            name=html.escape(name),
            visible="legendonly" if name in HIDDEN else True,
            hovertemplate="%{x}: %{y} " + unit,
        )
    figure.update_layout(barmode="group", title_text=title, yaxis_title=unit, xaxis_title="ambient temperature")
    return figure
