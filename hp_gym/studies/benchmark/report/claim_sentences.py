"""The headline in words: what is claimed, or why nothing is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from markupsafe import Markup

from hp_gym.studies.benchmark.report.headline import interval, show

if TYPE_CHECKING:
    from hp_gym.studies.benchmark.report.layout import Layout

_COMPARISONS = ("learned_vs_best_rule", "best_rule_vs_hpcu")


def sentences(layout: Layout) -> list[Markup]:
    """Returns the two claims of the headline; none where the summary has no headline."""
    if layout.summary.get("headline") is None:
        return []
    return [_sentence(layout, name) for name in _COMPARISONS]


def _sentence(layout: Layout, name: str) -> Markup:
    place = ("headline", name)
    best = layout.summary.get("headline", "best_rule") or "of which there is none"
    learned = layout.summary.get("headline", "learned") or "Learning"
    who = {
        "learned_vs_best_rule": f"{learned} against the best rule, {best}",
        "best_rule_vs_hpcu": f"The best rule, {best}, against the paper's hpcu",
    }[name]
    if layout.summary.get(*place) is None:
        reason = str(layout.summary.get("headline", "reasons", name)).replace("`", "")
        return Markup("<strong>{}: no claim</strong>, because {}.").format(who, reason)
    empty = layout.summary.get("headline", "rests_on", name, "bands_without_pairs") or []
    return Markup(
        "<strong>{}: {} % energy</strong> ({}) over the {} trips that both pass; it passes {} % of all.{}"
    ).format(
        who,
        show(layout, *place, "attributable_energy_pct"),
        interval(layout, *place, "ci95"),
        layout.summary.show("headline", "rests_on", name, "pairs", decimals=0),
        layout.summary.show(*place, "passed_pct", decimals=1),
        f" None of these trips is in {', '.join(empty)}: nothing is said of them." if empty else "",
    )
