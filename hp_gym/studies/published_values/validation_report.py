"""Judged rows as tables: for the terminal and as a page of the documentation."""

from collections.abc import Iterable, Sequence

from rich.table import Table

from hp_gym.studies.published_values.judging import Judged
from hp_gym.studies.published_values.published import Published

_MADE_BY = "Made by `hp-gym validate --markdown`. Setups are in `configs/validation/published.toml`."

GROUPS = {"rig": "Rigs", "chamber": "Cars in a chamber", "car": "Cars on the road"}
"""Groups of rows and their titles, in the order in which they are shown."""


def number(value: float | None) -> str:
    """A model's value with four digits at most; a dash where there is none."""
    if value is None:
        return "-"
    return f"{value:.0f}" if abs(value) >= 1000.0 else f"{value:.3g}"


def table(judged: Sequence[Judged]) -> Table:
    """All rows, group by group."""
    shown = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("Row", "Vehicle"):
        shown.add_column(heading, no_wrap=True)
    shown.add_column("What")
    for heading in ("Published", "Model", "Unit", "Tolerance", "Passes"):
        shown.add_column(heading, justify="right", no_wrap=True)
    for group, title in GROUPS.items():
        shown.add_row(f"[bold cyan]{title}[/]")
        for row in judged:
            if row.row.group == group:
                passes = "[green]yes[/]" if row.passes else "[red]no[/]"
                what = f"{row.row.text}; {row.row.conditions}"
                value = number(row.model)
                shown.add_row(
                    row.id, _vehicles(row), what, row.published, value, row.row.unit, row.tolerance, passes
                )
    return shown


def _vehicles(row: Judged) -> str:
    return row.vehicle if row.vehicle.count(",") == 0 else "all"


def closing_lines(judged: Sequence[Judged]) -> list[str]:
    """How many pass, in all and by group; why the others fail."""
    passed = sum(row.passes for row in judged)
    groups = (
        f"{title.lower()} {sum(row.passes for row in rows)} of {len(rows)}"
        for group, title in GROUPS.items()
        if (rows := [row for row in judged if row.row.group == group])
    )
    lines = [
        f"Passed: {passed} of {len(judged)} ({100.0 * passed / len(judged):.0f} %): {', '.join(groups)}."
    ]
    lines += [f"{name}: {explanation}" for name, explanation in explanations(judged)]
    return lines


def explanations(judged: Iterable[Judged]) -> list[tuple[str, str]]:
    """Failing rows with their explanations; those that share one stand together."""
    together: dict[str, list[str]] = {}
    for row in judged:
        if not row.passes:
            together.setdefault(row.explanation or "not explained", []).append(row.id)
    return [(", ".join(ids), explanation) for explanation, ids in together.items()]


def markdown(published: Published, judged: Sequence[Judged]) -> str:
    """The rows as Markdown, with explanations and what is not judged."""
    lines = ["# Published values beside the model", "", _MADE_BY, "", closing_lines(judged)[0], ""]
    for group, title in GROUPS.items():
        lines += [
            f"## {title}",
            "",
            "| row | vehicle | what | conditions | published | model | unit | tolerance | passes | source |",
        ]
        lines.append("|---|---|---|---|---|---|---|---|---|---|")
        lines += [_markdown_row(row) for row in judged if row.row.group == group]
        lines.append("")
    lines += ["## Misses", "", "| rows | why |", "|---|---|"]
    lines += [f"| {names} | {explanation} |" for names, explanation in explanations(judged)]
    lines += ["", "## Not judged", "", "| value | what | source | reason |", "|---|---|---|---|"]
    lines += [f"| {kept.id} | {kept.text} | {kept.source} | {kept.reason} |" for kept in published.reference]
    return "\n".join([*lines, ""])


def _markdown_row(row: Judged) -> str:
    names = f"{row.id} ({', '.join(row.row.also)})" if row.row.also else row.id
    text = row.row.text if row.row.set is None else f"{row.row.text}; set: {row.row.set}"
    passes = "yes" if row.passes else "**no**"
    cells = (
        names, _vehicles(row), text, row.row.conditions, row.published, number(row.model), row.row.unit,
        row.tolerance, passes, row.row.source,
    )  # fmt: skip
    return f"| {' | '.join(cells)} |"
