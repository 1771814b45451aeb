"""`hp-gym train`: a policy from a configuration."""

from pathlib import Path
from typing import Annotated

import typer

from hp_gym.cli.interrupts import stopped
from hp_gym.cli.output import console, fail, print_json
from hp_gym.ctrl_c import INTERRUPTED


def train(
    config: Annotated[str, typer.Argument(help="Training configuration: name or path.")] = "ppo",
    *,
    seed: Annotated[int, typer.Option(min=0, help="Seed of weights, decisions and trips.")] = 0,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the run; by default runs/CONFIG-SEED.", show_default=False)
    ] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="KEY=VALUE", help="Change a value of the configuration; may be repeated."
        ),
    ] = None,
    decisions: Annotated[
        int | None, typer.Option(min=1, help="Decisions in all, instead of the configuration's.")
    ] = None,
    resume: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Go on with the run in this folder, after a kill, from its checkpoint."
        ),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the outcome as JSON.")] = False,
) -> None:
    """Trains a policy and keeps all that is needed to repeat it."""
    import os
    from dataclasses import asdict

    # Threads of torch that wait by spinning bring it to a crawl as soon as anything else runs on the machine.
    # Read when torch is loaded, which is below.
    os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")
    from hp_gym import extras

    extras.require("train")
    from hp_gym.agents.training import configuration
    from hp_gym.agents.training import train as training

    more = list(changes or ())
    if decisions is not None:
        more.append(f"total_decisions={decisions}")
    try:
        if resume is not None:
            if out is not None or more:
                fail("--resume goes on with a run as it was begun, without --out, --set and --decisions")
            outcome = training.resume(resume)
        else:
            name = Path(config).stem
            loaded = configuration.load(config, more)
            outcome = training.start(loaded, name, seed, out or Path("runs") / f"{name}-{seed}")
    except (ValueError, OSError) as error:
        fail(error)
    except KeyboardInterrupt:
        from hp_gym.agents.training.run_folder import RunFolder

        folder = resume or out or Path("runs") / f"{Path(config).stem}-{seed}"
        stopped(RunFolder(folder).how_to_go_on())
        raise typer.Exit(INTERRUPTED) from None
    if json:
        print_json(
            asdict(outcome)
            | {
                "folder": str(outcome.folder),
                "plant_seconds_per_s": outcome.decisions_per_s * outcome.control_interval_s,
            }
        )
        return
    best, rules = outcome.best, outcome.rules
    console.print(
        f"{outcome.decisions:,} decisions in {outcome.wall_s:.0f} s; "
        f"{outcome.decisions_per_s:,.0f} decisions/s, "
        f"{outcome.decisions_per_s * outcome.control_interval_s:,.0f} plant seconds/s, everything included.\n"
        f"Best on the validation trips, at {best['decisions']:,} decisions: score {best['score']:.2f} "
        f"(HPCU {rules.score:.2f}), energy {best['attributable_energy_kwh']:.3f} kWh a trip "
        f"({rules.attributable_energy_kwh:.3f}), discomfort {best['discomfort_k']:.2f} K "
        f"({rules.discomfort_k:.2f}).\nPolicies: {outcome.folder}",
        soft_wrap=True,
    )
