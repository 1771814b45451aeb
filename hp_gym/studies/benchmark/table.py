"""The results on a terminal of 80 columns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from rich.table import Table

from hp_gym.agents.controllers.learned import ABLATION
from hp_gym.studies.benchmark.matched import MOST_COMFORTABLE

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rich.console import RenderableType

LEAST_SEEDS: Final = 5
"""Training seeds below which an interval says little about training."""


def tables(summary: Mapping[str, Any]) -> Iterable[RenderableType]:
    """Yields what a person wants to see of a summary, the most important last."""
    grid = summary["grid"]
    yield f"[bold]Means over {grid['headline_scenarios']} held-out trips that call for heating[/]"
    yield _controllers(summary)
    yield "[bold]By ambient temperature: energy in kWh/100 km / discomfort in K[/]"
    yield _bands(summary)
    yield "In brackets: apart from the headline; the paper gives no air conditioning."
    if summary["gains"] or summary["ablations"]:
        yield "[bold]Energy at matched comfort, the worse of arrival credits 0 and 0.5[/]"
        yield _gains(summary)
        yield "Less is negative. Discomfort: against the rules at their own set points."
    yield from _remarks(summary)
    reference = summary["comfort"]["reference"]
    yield f"[bold]Trips that pass beside `{reference}`, %[/] (in brackets: in equivalent temperature)"
    yield _passes(summary)
    yield "[bold]Energy over the trips that both pass, the worse of arrival credits 0 and 0.5[/]"
    yield _paired_gains(summary)
    yield "Charged: over all trips, a failed one with the dearest passing controller's energy."
    yield from _headline(summary)


def _controllers(summary: Mapping[str, Any]) -> Table:
    table = _table()
    table.add_column("controller", no_wrap=True, max_width=20)
    for heading in (
        "energy\nkWh/\n100 km",
        "discom-\nfort\nK",
        "heat\nleft\nkWh",
        "com-\npressor\nkWh",
        "PTC\n\nkWh",
        "within\n1 K\n%",
        "limit\nbrea-\nches",
        "stran-\nded",
    ):
        table.add_column(heading, justify="right", no_wrap=True)
    for name, kpis in summary["controllers"].items():
        table.add_row(
            name,
            f"{kpis['attributable_energy_kwh_per_100_km']:.2f}",
            f"{kpis['discomfort_k']:.2f}",
            f"{kpis['heat_left_kwh']:.2f}",
            f"{kpis['compressor_energy_kwh']:.2f}",
            f"{kpis['ptc_energy_kwh']:.2f}",
            f"{kpis['comfortable_share_pct']:.0f}",
            str(summary["limit_breaches"][name]),
            str(summary["stranded_trips"][name]),
        )
    return table


def _bands(summary: Mapping[str, Any]) -> Table:
    bands = summary["grid"]["bands"]
    shown = [name for name, band in bands.items() if band["scenarios"]]
    table = _table()
    table.add_column("controller", no_wrap=True, max_width=14)
    for name in shown:
        table.add_column(
            f"{name}\n°C" if bands[name]["headline"] else f"({name}\n°C)", justify="right", no_wrap=True
        )
    for controller, kpis in summary["controllers"].items():
        cells = []
        for name in shown:
            band = kpis["bands"][name]
            cells.append(f"{band['attributable_energy_kwh_per_100_km']:.1f}/{band['discomfort_k']:.1f}")
        table.add_row(controller, *cells)
    return table


def _gains(summary: Mapping[str, Any]) -> Table:
    table = _table()
    table.add_column("comparison", no_wrap=True, max_width=34)
    for heading in ("energy\n%", "95 % interval\n%", "discom-\nfort K", "seeds"):
        table.add_column(heading, justify="right", no_wrap=True)
    for name, gain in {**summary["gains"], **(summary["ablations"] or {})}.items():
        matched = "*" if gain.get("matched") == MOST_COMFORTABLE else ""
        table.add_row(
            name.replace("_vs_", " vs ") + matched,
            _signed(gain["attributable_energy_pct"], 1),
            " .. ".join(_signed(end, 1) for end in gain["ci95"] or [None, None]),
            _signed(gain["discomfort_k"], 2),
            str(len(gain.get("seeds", []))),
        )
    return table


def _passes(summary: Mapping[str, Any]) -> Table:
    table = _table()
    table.add_column("controller", no_wrap=True, max_width=18)
    shown = [name for name, band in summary["grid"]["bands"].items() if band["scenarios"]]
    for name in ("all", *shown):
        table.add_column(name if name == "all" else f"{name}\n°C", justify="right", no_wrap=True)
    for controller, rates in summary["comfort"]["controllers"].items():
        cells = [f"{rates['passed_pct']:.0f} ({rates['passed_equivalent_pct']:.0f})"]
        cells += [f"{rates['bands'][name]['passed_pct']:.0f}" for name in shown]
        table.add_row(controller, *cells)
    return table


def _paired_gains(summary: Mapping[str, Any]) -> Table:
    table = _table()
    table.add_column("comparison", no_wrap=True, max_width=34)
    for heading in ("energy\n%", "95 % interval\n%", "charged\n%", "pairs"):
        table.add_column(heading, justify="right", no_wrap=True)
    for name, gain in summary["paired_gains"].items():
        if name.startswith(ABLATION):
            continue
        table.add_row(
            name.replace("_vs_", " vs "),
            _signed(gain["attributable_energy_pct"], 1),
            " .. ".join(_signed(end, 1) for end in gain["ci95"]),
            _signed(gain["charged_pct"], 1),
            str(gain["pairs"]),
        )
    return table


def _headline(summary: Mapping[str, Any]) -> Iterable[str]:
    headline = summary["headline"]
    best, learned = headline["best_rule"], headline["learned"]
    yield f"[bold]Headline[/] Best rule: {f'`{best}`' if best else 'none'}."
    named = {
        "learned_vs_best_rule": f"{learned or 'Learned'} against the best rule",
        "best_rule_vs_hpcu": "The best rule against hpcu",
    }
    for name, words in named.items():
        claim = headline[name]
        if claim is None:
            yield f"{words}: no headline, because {headline['reasons'][name]}."
        else:
            low, high = (_signed(end, 1) for end in claim["ci95"])
            energy, passed = _signed(claim["attributable_energy_pct"], 1), claim["passed_pct"]
            told = f"{words}: {energy} % energy ({low} .. {high}), {passed:.1f} % of its trips pass."
            evidence = headline["rests_on"][name]
            empty = ", ".join(evidence["bands_without_pairs"])
            none_there = f" None of them is in {empty}: there it says nothing." if empty else ""
            yield f"{told} Over {evidence['pairs']} pairs of trips.{none_there}"


def _remarks(summary: Mapping[str, Any]) -> Iterable[str]:
    told = {**summary["gains"], **(summary["ablations"] or {})}
    if any(gain.get("matched") == MOST_COMFORTABLE for gain in told.values()):
        yield "* More comfortable than any setting of these rules: compared with their most comfortable."
    for name, gain in told.items():
        if any(gain["stranded_trips"].values()):
            yield f"{name}: no figure, because trips stranded: {gain['stranded_trips']}."
        elif gain["attributable_energy_pct"] is None:
            yield f"{name}: no figure, because it is {gain['matched']} of these rules."
    few = [name for name, gain in summary["gains"].items() if len(gain.get("seeds", [])) < LEAST_SEEDS]
    if few:
        yield f"Fewer than {LEAST_SEEDS} training seeds: the interval says little about training."


def _table() -> Table:
    return Table(box=None, pad_edge=False, padding=(0, 1))


def _signed(value: float | None, decimals: int) -> str:
    return "-" if value is None else f"{value:+.{decimals}f}"
