"""`hp-gym benchmark`: controllers compared over held-out trips."""

from collections.abc import Collection
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
            help="off, random, ptc-only, hpcu, hpcu-modern, hpcu-best-mode, hpcu-tuned-strict, hpcu-tuned, "
            "ppo, a policy file (.zip if allowed), a controller file, or module:Class; all named ones by "
            "default. The rules that others are compared with always run.",
            show_default=False,
        ),
    ] = None,
    *,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/benchmark"),
    grid: Annotated[str, typer.Option(help="Held-out trips: name or path.")] = "heldout-v1",
    seeds: Annotated[
        str | None, typer.Option(help="Training seeds of ppo, for example 0,2; all by default.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of random actions and of resamples.")] = 0,
    allow_code: Annotated[
        bool,
        typer.Option(
            "--allow-code",
            help="Load zip files of stable-baselines3, which can run code. They are taken as trained on "
            "EVHeatPump-v0 or EVHeatPumpContinuous-v0 with its defaults; `hp-gym export` converts others.",
        ),
    ] = False,
    overrides: Annotated[
        Path | None, typer.Option(help="A .toml file of changes to the car, as `calibrate` writes.")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON.")] = False,
) -> None:
    """Drives controllers over held-out trips and reports how much a learned one gains over rules."""
    from hp_gym.studies.benchmark import request
    from hp_gym.studies.benchmark.table import tables

    warn_of_code([name for name in controllers or [] if allow_code and name.endswith(".zip")])
    try:
        done = request.carry_out(
            request.Request(controllers, grid, training_seeds(seeds), seed, out, allow_code, overrides),
            console=progress_console,
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


def warn_of_code(files: Collection[str]) -> None:
    """Tells what it means that zip files are loaded, if any is."""
    if not files:
        return
    from hp_gym.agents.policies.sb3_zip import WARNING

    taken = f"Taken as trained with an id's defaults, a decision a second: {', '.join(files)}."
    progress_console.print(f"Warning: {WARNING}. {taken}", soft_wrap=True, markup=False)


def training_seeds(text: str | None) -> list[int] | None:
    """Reads whole numbers with commas between them."""
    if text is None:
        return None
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        fail(f"--seeds is `{text}`, but must be whole numbers with commas between them")
