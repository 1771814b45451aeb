"""What the benchmark found, in one sentence for each comparison."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from markupsafe import Markup

from hp_gym.studies.benchmark.matched import MOST_COMFORTABLE
from hp_gym.studies.benchmark.report.layout import kpi_path

if TYPE_CHECKING:
    from hp_gym.studies.benchmark.report.layout import Comparison, Layout

WINS, LOSES, OPEN, NONE = (
    "needs less energy than",
    "needs more energy than",
    "is not shown to differ from",
    "",
)
_CREDITS: Final[tuple[tuple[str, str], ...]] = (
    ("0", "without credit for the heat left at arrival"),
    ("0.5", "with half of it credited"),
)
_BETTER: Final = " No setting of the rules is as comfortable: the most comfortable one is compared."


def verdict(layout: Layout, comparison: Comparison) -> str:
    """Returns what may be said of a gain: that of both arrival credits, or nothing is shown."""
    signs = set()
    for credit, _ in _CREDITS:
        path = comparison.at("by_credit", credit)
        low = layout.summary.number(*path, "ci95", 0)
        high = layout.summary.number(*path, "ci95", 1)
        if layout.summary.number(*path, "attributable_energy_pct") is None:
            return NONE
        if high is not None and high < 0.0:
            signs.add(WINS)
        elif low is not None and low > 0.0:
            signs.add(LOSES)
        else:
            signs.add(OPEN)
    return signs.pop() if len(signs) == 1 else OPEN


def sentence(layout: Layout, comparison: Comparison) -> Markup:
    """Returns a gain in words: how much, how sure, at which comfort, with both arrival credits."""
    name = layout.title(comparison.controller)
    said = verdict(layout, comparison)
    if said == NONE:
        return Markup("<strong>{} cannot be compared with {}</strong>: {}.").format(
            name, comparison.rival, _why_not(layout, comparison)
        )
    parts = [
        Markup("{} % ({}) {}").format(
            show(layout, *comparison.at("by_credit", credit, "attributable_energy_pct")),
            interval(layout, *comparison.at("by_credit", credit, "ci95")),
            words,
        )
        for credit, words in _CREDITS
    ]
    return Markup(
        "<strong>At equal comfort {} {} {}</strong>: attributable energy {}, at a mean discomfort of {} K.{}"
    ).format(
        name,
        said,
        comparison.rival,
        Markup(", ").join(parts),
        layout.summary.show(*kpi_path(name, "discomfort_k"), decimals=2),
        _BETTER if layout.summary.get(*comparison.at("matched")) == MOST_COMFORTABLE else "",
    )


def sentences(layout: Layout) -> list[Markup]:
    """Returns the headline: all gains, or what rules reach where nothing has learned."""
    found = [sentence(layout, comparison) for comparison in layout.comparisons()]
    if found:
        return found
    points = [
        Markup("{} {} kWh per trip at {} K").format(
            name,
            layout.summary.show(*kpi_path(name, "attributable_energy_kwh"), decimals=2),
            layout.summary.show(*kpi_path(name, "discomfort_k"), decimals=2),
        )
        for name in layout.controllers
        if name not in {"off", "random"}
    ]
    return [
        Markup(
            "<strong>No learned controller took part</strong>, so there is no gain to report. Rules: {}."
        ).format(Markup("; ").join(points))
    ]


def show(layout: Layout, *path: str | int) -> Markup:
    """Returns a change in percent with its sign."""
    return layout.summary.show(*path, decimals=1, signed=True)


def interval(layout: Layout, *path: str | int) -> Markup:
    """Returns an interval of 95 %; an open end says so."""
    ends = [
        show(layout, *path, end) if layout.summary.number(*path, end) is not None else "unbounded"
        for end in (0, 1)
    ]
    return Markup("95 % interval {} to {}").format(*ends)


def _why_not(layout: Layout, comparison: Comparison) -> Markup | str:
    stranded = comparison.at("stranded_trips")
    if any(layout.summary.number(*stranded, who) for who in ("controller", "rules")):
        return Markup("trips ended before arrival ({} of its own, {} of the rules)").format(
            layout.summary.show(*stranded, "controller", decimals=0),
            layout.summary.show(*stranded, "rules", decimals=0),
        )
    return layout.summary.get(*comparison.at("matched")) or "the rules have no setting to compare with"
