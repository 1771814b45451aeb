"""`hp-gym benchmark`: controllers compared over held-out trips."""

from pathlib import Path
from typing import Annotated

import typer

from hp_gym.cli.output import console, fail, print_json
from hp_gym.terminal import progress_console


def benchmark(
    controllers: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[CONTROLLER]...",
            help="off, random, ptc-only, hpcu, hpcu-best-mode, hpcu-tuned, ppo, a policy or controller file, "
            "or module:Class; all named ones by default. The rules that others are compared with always run.",
            show_default=False,
        ),
    ] = None,
    *,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/benchmark"),
    grid: Annotated[str, typer.Option(help="Held-out trips: name or path.")] = "heldout-v0",
    seeds: Annotated[
        str | None, typer.Option(help="Training seeds of ppo, for example 0,2; all by default.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of random actions and of resamples.")] = 0,
    json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON.")] = False,
) -> None:
    """Drives controllers over held-out trips and reports how much a learned one gains over rules."""
    from hp_gym.studies.benchmark import request
    from hp_gym.studies.benchmark.table import tables

    try:
        done = request.carry_out(
            request.Request(controllers, grid, _seeds(seeds), seed, out), console=progress_console
        )
    except (ValueError, OSError) as error:
        fail(error)
    if json:
        print_json(done.benchmark.summary)
    else:
        for part in tables(done.benchmark.summary):
            console.print(part)
        console.print(
            f"{done.trips} trips, {done.simulated_s / 3600.0:.0f} h driven in {done.wall_s:.0f} s: "
            f"{done.simulated_s / done.wall_s:,.0f} times real time, all in all."
        )
        console.print(f"Written: {out}", markup=False, soft_wrap=True)


def _seeds(text: str | None) -> list[int] | None:
    if text is None:
        return None
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        fail(f"--seeds is `{text}`, but must be whole numbers with commas between them")
