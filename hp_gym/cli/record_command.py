"""`hp-gym record`: trips of a controller as a Minari data set."""

from pathlib import Path
from typing import Annotated

import typer

from hp_gym.cli import many_runs
from hp_gym.cli.output import console, fail, print_json
from hp_gym.terminal import progress_console


def record(
    controller: Annotated[
        str,
        typer.Argument(
            help="As for `hp-gym benchmark`: a name, a policy file (.zip if allowed), a controller file, or "
            "module:Class."
        ),
    ],
    *,
    data_set: Annotated[
        str | None,
        typer.Option(
            "--id", help="Id of the data set; evheatpump/CONTROLLER-v0 by default.", show_default=False
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder of data sets (MINARI_DATASETS_PATH).")] = Path("out/data"),
    episodes: Annotated[int, typer.Option(min=1, help="Number of trips.")] = 100,
    distribution: Annotated[str, typer.Option(help="Where trips are drawn from: name or path.")] = "train-v2",
    seed: Annotated[int, typer.Option(min=0, help="Trip k is that of reset(seed=SEED + k).")] = 0,
    seeds: Annotated[
        str | None, typer.Option(help="Training seeds of ppo, for example 0,2; all by default, in turn.")
    ] = None,
    info: Annotated[
        list[str] | None,
        typer.Option(
            help="What infos hold beside the parts of the reward: cost (default), action_mask, terms."
        ),
    ] = None,
    overrides: many_runs.Overrides = None,
    author: Annotated[str, typer.Option(help="For the metadata.")] = "hp_gym contributors",
    license_: Annotated[str, typer.Option("--license", help="Of the data, for the metadata.")] = "MIT",
    code_link: Annotated[
        str | None,
        typer.Option(help="Where the code is, for the metadata; package and version by default."),
    ] = None,
    allow_code: Annotated[
        bool,
        typer.Option("--allow-code", help="Load a zip file of stable-baselines3, which can run code."),
    ] = False,
    json: Annotated[bool, typer.Option("--json", help="Print the outcome as JSON.")] = False,
) -> None:
    """Records trips, with infos and metadata, for learning from data."""
    from dataclasses import asdict

    from hp_gym import extras

    extras.require("data")
    from rich.progress import Progress

    from hp_gym.agents import recording
    from hp_gym.cli.benchmark_command import training_seeds, warn_of_code
    from hp_gym.overrides import assignments

    warn_of_code([controller] if allow_code and controller.endswith(".zip") else [])
    try:
        request = recording.Request(
            controller,
            data_set or recording.default_id(controller),
            out,
            episodes,
            distribution,
            seed,
            training_seeds(seeds),
            tuple(info or ("cost",)),
            allow_code,
            author,
            license_,
            code_link or recording.package(),
            tuple(assignments(overrides)),
        )
        with Progress(
            console=progress_console, transient=True, disable=not progress_console.is_terminal
        ) as bar:
            task = bar.add_task("recording", total=episodes)
            done = recording.record(request, lambda count: bar.advance(task, count))
    except (ValueError, OSError) as error:
        fail(error)
    if json:
        print_json(asdict(done) | {"folder": str(done.folder), "id": request.data_set})
        return
    console.print(
        f"{done.episodes} trips, {done.steps:,} steps, mean return {done.mean_return:.2f}.\n"
        f"Written: {done.folder}\n"
        f"To read: MINARI_DATASETS_PATH={out}, minari.load_dataset({request.data_set!r})",
        markup=False,
        soft_wrap=True,
    )
