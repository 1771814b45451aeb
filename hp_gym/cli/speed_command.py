"""`hp-gym speed`: how fast plant and environments are, beside others."""

from dataclasses import replace
from typing import Annotated

import typer

from hp_gym.cli.output import console, fail, print_json


def speed(
    *,
    quick: Annotated[bool, typer.Option("--quick", help="A few seconds: fewer sizes, one repeat.")] = False,
    repeats: Annotated[
        int | None, typer.Option(help="Rounds whose median is told; 5 by default, 1 if quick.")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """Measures plant step, environments, threads and memory beside CartPole-v1 and FASTSim."""
    from hp_gym.studies.speed import measurement, speed_report

    plan = measurement.QUICK if quick else measurement.FULL
    if repeats is not None and repeats < 1:
        fail(f"--repeats is {repeats}, but must be at least 1")
    if repeats is not None:
        plan = replace(plan, repeats=repeats)
    with measurement.bar() as advance:
        measured = measurement.measure(plan, advance)
    if json:
        print_json(speed_report.to_json(measured))
        return
    console.print(speed_report.single_table(measured))
    console.print()
    console.print(speed_report.vector_table(measured))
    console.print()
    for remark in speed_report.remarks(measured):
        console.print(remark)
