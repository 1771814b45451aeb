"""What a calibration on measurements tells: how well it agrees, how sure it is, what the data cannot tell."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from rich.table import Table

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rich.console import RenderableType

    from hp_gym.studies.calibration.calibrating import Calibrated, Judged
    from hp_gym.studies.calibration.identifiability import Knowledge
    from hp_gym.studies.calibration.problem import Problem

_TIGHT: Final = 0.95
"""Correlation from which two parameters are named together."""


def count(problem: Problem) -> int:
    """Measured values that the fit sees."""
    return sum(one.values for one in problem.measurements if one.role == "fit")


def correlated(known: Knowledge) -> list[tuple[str, str, float]]:
    """Pairs of parameters whose correlation is at least 0.95, with it."""
    correlation = known.correlation
    pairs = [
        (one, other, float(correlation[place, behind]))
        for place, one in enumerate(known.names)
        for behind, other in enumerate(known.names[:place])
    ]
    return [pair for pair in pairs if abs(pair[2]) >= _TIGHT]


def to_json(done: Calibrated) -> dict[str, Any]:
    """What measurements add to a calibration's result, as plain data; nothing without measurements."""
    known = done.knowledge
    if known is None:
        return {}
    return {
        "measurements": [vars(one) for one in (*done.judged, *done.left_out)],
        "standard_deviations": dict(zip(known.names, known.deviations, strict=True)),
        "gain": dict(zip(known.names, known.gain, strict=True)),
        "covariance_of_shares": known.covariance.tolist(),
        "not_told_apart": [list(group) for group in known.open_groups],
        "correlated": [list(pair) for pair in correlated(known)],
        "reduced_chi2": known.reduced_chi2,
    }


def tables(done: Calibrated) -> Iterator[RenderableType]:
    """Yields what a person wants to see of it; nothing without measurements."""
    known = done.knowledge
    if known is None:
        return
    yield _deviations(done, known)
    yield _agreement("Model and measurements, in units of the stated uncertainty", done.judged)
    if done.left_out:
        yield _agreement("Measurements that a fit without them predicts", done.left_out)
    yield f"Mean square of the deviations: {known.reduced_chi2:.2f} (1 where uncertainties are right)"
    for group in known.open_groups:
        said = (
            "[yellow]Not seen by the data[/]" if len(group) == 1 else "[yellow]Not told apart by the data[/]"
        )
        yield f"{said}: {_plain(', '.join(group))}"
    for one, other, value in correlated(known):
        yield f"Correlated by {value:+.2f}: {_plain(one)}, {_plain(other)}"


def _plain(text: str) -> str:
    return text.replace("[", r"\[")


def _deviations(done: Calibrated, known: Knowledge) -> Table:
    table = Table(title="What is known", title_justify="left")
    table.add_column("parameter", overflow="fold")
    for heading in ("value", "standard deviation", "known from the data, %"):
        table.add_column(heading, justify="right")
    rows = zip(known.names, done.fit.values, known.deviations, known.gain, strict=True)
    for name, value, deviation, gain in rows:
        table.add_row(_plain(name), f"{value:g}", f"{deviation:.2g}", f"{100.0 * gain:.0f}")
    return table


def _agreement(title: str, judged: Sequence[Judged]) -> Table:
    table = Table(title=title, title_justify="left")
    for heading in ("measurement", "role", "quantity"):
        table.add_column(heading, overflow="fold")
    for heading in ("deviation", "error", "values"):
        table.add_column(heading, justify="right")
    for one in judged:
        table.add_row(
            one.measurement,
            one.role,
            one.quantity,
            f"{one.deviation:.2f}",
            f"{one.error:.3g}",
            str(one.values),
        )
    return table
