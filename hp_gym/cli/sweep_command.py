"""`hp-gym sweep`: many runs over a grid or a sample of values."""

from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from hp_gym.cli import many_runs
from hp_gym.cli.output import console, fail, print_json

if TYPE_CHECKING:
    from hp_gym.studies.sweep.swept import Sweep


def sweep(
    scenario: Annotated[
        str, typer.Argument(help="Name (see `hp-gym scenarios`) or path of a scenario.")
    ] = "jeffs2019/case1-1",
    *,
    axis: Annotated[
        list[str],
        typer.Option(
            "--axis",
            metavar="KEY=VALUES",
            help="A value that varies: KEY=A,B,C or KEY=LOW:HIGH:STEP or KEY=LOW:HIGH/COUNT; with --sample "
            "KEY=LOW:HIGH. A key is dotted, or its last part, or vehicle, architecture, climate, controller, "
            "scenario, cycle; KEY+KEY share the value. May be repeated.",
        ),
    ],
    controller: many_runs.Controller = None,
    vehicle: many_runs.Vehicle = None,
    changes: many_runs.Changes = None,
    overrides: many_runs.Overrides = None,
    sample: Annotated[
        str | None, typer.Option(help="latin-hypercube, sobol or saltelli; all combinations by default.")
    ] = None,
    count: Annotated[int, typer.Option(min=1, help="Points of the sample.")] = 1024,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the sample.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/sweep"),
    plot: Annotated[Path | None, typer.Option(help="Draw the sweep to this .png, .svg or .pdf file.")] = None,
    kpi: Annotated[
        list[str] | None,
        typer.Option("--kpi", help="Total that is drawn and shown; energy_kwh and discomfort_k by default."),
    ] = None,
    kind: Annotated[str, typer.Option(help="Picture of a grid: auto, lines or heat.")] = "auto",
    sensitivities: Annotated[
        bool, typer.Option("--sensitivities", help="Show how much each axis of a sample matters.")
    ] = False,
    on: Annotated[str, typer.Option(help="Where to drive: threads, or ray (a cluster).")] = "threads",
    threads: many_runs.Threads = None,
    chunk: Annotated[int, typer.Option(min=1, help="Runs that are driven and written at a time.")] = 500,
    keep_refused: Annotated[
        bool, typer.Option("--keep-refused", help="Note runs that the plant refuses, and go on.")
    ] = False,
    json: Annotated[bool, typer.Option("--json", help="Print a summary as JSON.")] = False,
) -> None:
    """Drives many runs over values by key; a sweep that was stopped goes on where it was."""
    from hp_gym.files import require_suffix
    from hp_gym.overrides import assignments
    from hp_gym.studies.axes import parse_axis
    from hp_gym.studies.sweep import sweeping
    from hp_gym.studies.sweep.swept import DEFAULT_KPIS

    began_s = perf_counter()
    try:
        if plot is not None:
            from hp_gym.pictures import picture_file

            require_suffix(plot, picture_file.SUFFIXES)
        swept = sweeping.sweep(
            dict(parse_axis(text) for text in axis),
            scenario,
            controller=controller,
            vehicle=vehicle,
            overrides=[*assignments(overrides), *(changes or [])],
            sample=sample,
            count=count,
            seed=seed,
            out=out,
            on=on,
            threads=threads,
            chunk_runs=chunk,
            keep_refused=keep_refused,
            kpis=kpi or (),
        )
        kpis = kpi or [name for name in DEFAULT_KPIS if name in swept.kpis]
        if plot is not None:
            swept.plot(plot, kpis, kind)
        _show(swept, kpis, sensitivities=sensitivities, json=json, wall_s=perf_counter() - began_s)
    except (ValueError, OSError) as error:
        fail(error)
    if not json:
        for path in (out, plot):
            if path is not None:
                console.print(f"Written: {path}", markup=False, soft_wrap=True)


def _show(swept: "Sweep", kpis: list[str], *, sensitivities: bool, json: bool, wall_s: float) -> None:
    frame = swept.to_pandas(kpis)
    indices = {kpi: swept.sensitivities(kpi) for kpi in kpis} if sensitivities else {}
    if json:
        ranges = {kpi: {"least": frame[kpi].min(), "greatest": frame[kpi].max()} for kpi in kpis}
        ends = {str(end): int(count) for end, count in frame["end_reason"].value_counts().items()}
        found = {kpi: table.to_dict("index") for kpi, table in indices.items()}
        print_json({"definition": swept.definition, "ends": ends, "kpis": ranges, "sensitivities": found})
        return
    import numpy as np
    from rich.table import Table

    from hp_gym.cli.units import label, quantity

    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("", *(axis.replace("_", " ") for axis in swept.axes), "", ""):
        table.add_column(heading, justify="right", overflow="fold")
    for kpi in kpis:
        numbers = frame[kpi].to_numpy()
        for word, place in (("least", np.nanargmin(numbers)), ("greatest", np.nanargmax(numbers))):
            row = frame.iloc[int(place)]
            values = (f"{row[axis]:g}" if frame[axis].dtype.kind == "f" else row[axis] for axis in swept.axes)
            table.add_row(f"{word} {label(kpi)}", *values, *quantity(kpi, float(row[kpi])))
    console.print(f"[bold]{len(frame):,} runs[/], {wall_s:.1f} s in all")
    console.print(table)
    for kpi, sensitivity in indices.items():
        console.print(f"[bold]Sensitivities of {label(kpi)}[/]")
        console.print(sensitivity.round(3).to_string())
