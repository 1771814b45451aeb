"""Energy against discomfort: every controller a point, the rules with other set points a line."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING, Any, Final

import plotly.graph_objects as go

from hp_gym.studies.benchmark.fronts import OFFSETS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import pandas as pd

    from hp_gym.studies.benchmark.report.layout import Layout
    from hp_gym.studies.benchmark.report.palette import Style

HIDDEN: Final = ("off", "random")
"""Far from all others, so not drawn before somebody asks for them in the legend."""


def pareto(
    layout: Layout, runs: pd.DataFrame, fronts: pd.DataFrame, credit: float, looks: Mapping[str, Style]
) -> go.Figure:
    """Draws mean energy per trip against mean discomfort over the bands of the headline.

    Args:
        layout: Summary to read the controllers' points from.
        runs: Rows with KPIs; gives the points of single training seeds.
        fronts: What the rules reach with other set points.
        credit: Share of the heat left at arrival that is taken off the energy.
        looks: Look of each controller.
    """
    figure = go.Figure()
    for family, settings in fronts.groupby("family", sort=False):
        _draw_front(figure, str(family), settings[settings["stranded_trips"] == 0], credit, looks)
    for name in layout.controllers:
        seeds = _seed_points(
            runs[(runs["controller"] == name) & runs["band"].isin(layout.headline_bands)], credit
        )
        _draw_controller(figure, layout, name, seeds, credit, look=looks[name])
    times = "\N{MULTIPLICATION SIGN}"
    figure.update_layout(
        xaxis_title="mean discomfort, K",
        yaxis_title="kWh per trip",
        title_text=f"Energy less {credit:g} {times} heat left" if credit else "Attributable energy",
    )
    return figure


def hull(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Returns the lower convex hull of points (discomfort, energy), as long as it falls.

    It is the least that mixtures of the points need, as `hp_gym.studies.benchmark.matched` reckons.
    """
    corners: list[tuple[float, float]] = []
    for point in sorted(set(points)):
        while len(corners) > 1 and _turns_down(corners[-2], corners[-1], point):
            corners.pop()
        if not corners or point[0] > corners[-1][0]:
            corners.append(point)
    lowest = min(range(len(corners)), key=lambda place: corners[place][1], default=-1)
    return corners[: lowest + 1]


def _turns_down(one: tuple[float, float], other: tuple[float, float], third: tuple[float, float]) -> bool:
    return (other[0] - one[0]) * (third[1] - one[1]) <= (other[1] - one[1]) * (third[0] - one[0])


def _draw_front(
    figure: go.Figure, family: str, settings: pd.DataFrame, credit: float, looks: Mapping[str, Style]
) -> None:
    if settings.empty:
        return
    colour = looks[family].colour if family in looks else "#777777"
    name = html.escape(family)
    discomfort_k = settings["discomfort_k"].tolist()
    energy_kwh = (settings["attributable_energy_kwh"] - credit * settings["heat_left_kwh"]).tolist()
    corners = hull(list(zip(discomfort_k, energy_kwh, strict=True)))
    figure.add_scatter(
        x=_short(discomfort_k),
        y=_short(energy_kwh),
        customdata=settings[list(OFFSETS)].to_numpy(),
        mode="markers",
        marker={"color": colour, "size": 5, "opacity": 0.4},
        name=f"{name}, other set points",
        legendgroup=f"front of {family}",
        showlegend=False,
        hovertemplate="set points moved: cabin %{customdata[0]:+} K, HTC %{customdata[1]:+} K, "
        "PTC from %{customdata[2]:+} K<br>%{x} K, %{y} kWh",
    )
    figure.add_scatter(
        x=_short([corner[0] for corner in corners]),
        y=_short([corner[1] for corner in corners]),
        mode="lines",
        line={"color": colour, "width": 2},
        name=f"front of {name}",
        legendgroup=f"front of {family}",
        hoverinfo="skip",
    )


def _draw_controller(
    figure: go.Figure, layout: Layout, name: str, seeds: pd.DataFrame, credit: float, *, look: Style
) -> None:
    discomfort_k = layout.kpi(name, "discomfort_k")
    energy_kwh = layout.kpi(name, "attributable_energy_kwh")
    heat_left_kwh = layout.kpi(name, "heat_left_kwh")
    if discomfort_k is None or energy_kwh is None or heat_left_kwh is None:
        return
    stranded = bool(layout.kpi(name, "stranded"))
    symbol = f"{look.symbol}-open" if stranded else look.symbol
    shown: dict[str, Any] = {"visible": "legendonly" if name in HIDDEN else True}
    if len(seeds) > 1:
        figure.add_scatter(
            x=_short(seeds["discomfort_k"].tolist()),
            y=_short(seeds["energy_kwh"].tolist()),
            customdata=seeds.index.tolist(),
            mode="markers",
            marker={"color": look.colour, "symbol": look.symbol, "size": 6, "opacity": 0.6},
            name=f"{html.escape(name)}, one seed",
            legendgroup=name,
            hovertemplate="seed %{customdata}: %{x} K, %{y} kWh",
            **shown,
        )
    figure.add_scatter(
        x=_short([discomfort_k]),
        y=_short([energy_kwh - credit * heat_left_kwh]),
        mode="markers",
        marker={
            "color": look.colour,
            "symbol": symbol,
            "size": 13,
            "line": {"color": look.colour if stranded else "#ffffff", "width": 2.0},
        },
        name=html.escape(name),
        legendgroup=name,
        hovertemplate="%{x} K, %{y} kWh",
        **shown,
    )


def _seed_points(runs: pd.DataFrame, credit: float) -> pd.DataFrame:
    """Mean energy per trip and mean discomfort over occupied time of each training seed."""
    table = runs.assign(
        energy_kwh=runs["attributable_energy_kwh"] - credit * runs["heat_left_kwh"],
        discomfort_k_s=runs["discomfort_k"] * runs["duration_s"],
    ).groupby("seed")
    return table.agg(
        energy_kwh=("energy_kwh", "mean"), k_s=("discomfort_k_s", "sum"), s=("duration_s", "sum")
    ).assign(discomfort_k=lambda sums: sums["k_s"] / sums["s"])


def _short(values: Sequence[float]) -> list[float]:
    return [round(value, 4) for value in values]
