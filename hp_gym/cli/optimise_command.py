"""`hp-gym optimise`: the best values of any keys for any totals."""

from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Final

import typer

from hp_gym.cli import many_runs
from hp_gym.cli.output import console, fail, print_json

if TYPE_CHECKING:
    from hp_gym.studies.optimise.found import Found

_SHOWN: Final = 12
"""Trials of a front that are shown, evenly chosen."""


def optimise(
    scenarios: Annotated[
        list[str] | None,
        typer.Argument(metavar="[SCENARIO]...", help="Scenarios; totals are means over their trips."),
    ] = None,
    *,
    axis: Annotated[
        list[str],
        typer.Option(
            "--axis",
            metavar="KEY=LOW:HIGH",
            help="A value that may vary, or KEY=A,B,C: choices. Keys as for `hp-gym sweep`. May be repeated.",
        ),
    ],
    goal: Annotated[
        list[str] | None,
        typer.Option("--goal", metavar="KPI", help="Total to make small, or max:KPI; energy_kwh by default."),
    ] = None,
    constraint: Annotated[
        list[str] | None,
        typer.Option("--constraint", metavar="KPI<=VALUE", help="Limit of a total, or KPI>=VALUE."),
    ] = None,
    controller: many_runs.Controller = None,
    vehicle: many_runs.Vehicle = None,
    changes: many_runs.Changes = None,
    overrides: many_runs.Overrides = None,
    trials: Annotated[int, typer.Option(min=1, help="Trials, those in the folder included.")] = 300,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the search.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder for the trials.")] = Path("out/optimise"),
    plot: Annotated[Path | None, typer.Option(help="Draw the trials to this .png, .svg or .pdf.")] = None,
    threads: many_runs.Threads = None,
    json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """Searches values for one goal or the front of several; may run in several processes at once."""
    from hp_gym.files import require_suffix
    from hp_gym.overrides import assignments
    from hp_gym.studies.axes import Between, parse_axis
    from hp_gym.studies.optimise import optimising

    began_s = perf_counter()
    try:
        if plot is not None:
            from hp_gym.pictures import picture_file

            require_suffix(plot, picture_file.SUFFIXES)
        axes = dict(parse_axis(text) for text in axis)
        found = optimising.optimise(
            {key: values if isinstance(values, Between) else list(values) for key, values in axes.items()},
            goal or ["energy_kwh"],
            scenarios or ["jeffs2019/case1-1"],
            constraints=constraint or (),
            controller=controller,
            vehicle=vehicle,
            overrides=[*assignments(overrides), *(changes or [])],
            trials=trials,
            seed=seed,
            out=out,
            threads=threads,
        )
        written = found.write()
        if plot is not None:
            found.plot(plot)
    except (ValueError, OSError) as error:
        fail(error)
    if json:
        print_json(
            {
                "definition": found.definition,
                "trials": len(found.trials),
                "allowed": len(found.allowed),
                "front": found.rows(front=True),
            }
        )
        return
    _show(found, perf_counter() - began_s)
    for path in [*written[:1], *([written[1].parent] if len(written) > 1 else []), *([plot] if plot else [])]:
        console.print(f"Written: {path}", markup=False, soft_wrap=True)


def _show(found: "Found", wall_s: float) -> None:
    from rich.table import Table

    from hp_gym.cli.units import label, quantity

    front = found.front
    shown = (
        front
        if len(front) <= _SHOWN
        else [front[round(place * (len(front) - 1) / (_SHOWN - 1))] for place in range(_SHOWN)]
    )
    several = len(found.goals) > 1
    kept = f"{len(found.allowed)} keep the constraints" + (f", {len(front)} on the front" if several else "")
    refused = f", {len(found.refusals)} more were refused" if found.refusals else ""
    console.print(f"[bold]{len(found.trials)} trials[/], {kept}{refused}; {wall_s:.1f} s")
    table = Table(box=None, header_style="bold", pad_edge=False)
    table.add_column("trial", justify="right")
    for name in [
        *(label(goal) for goal in found.goals),
        *(axis["name"] for axis in found.definition["axes"]),
    ]:
        table.add_column(name.replace("_", " "), justify="right", overflow="fold")
    # What the files say was tried first, where it is within the ranges.
    present = [trial for trial in found.trials if trial.number == 0 and "fixed_params" in trial.system_attrs]
    for word, trial in [*(("files", trial) for trial in present), *(("", trial) for trial in shown)]:
        goals = [" ".join(quantity(kpi, value)) for kpi, value in zip(found.goals, trial.values, strict=True)]
        values = (found.value(trial, axis) for axis in found.definition["axes"])
        texts = [f"{value:.4g}" if isinstance(value, float) else str(value) for value in values]
        table.add_row(word or str(trial.number), *goals, *texts)
    console.print(table)
