"""`hp-gym speed`: how fast plant and environments are, beside others."""

from dataclasses import replace
from typing import Annotated

import typer

from agents.output import console, fail, print_json


def speed(
    *,
    quick: Annotated[bool, typer.Option("--quick", help="A few seconds: fewer sizes, one repeat.")] = False,
    repeats: Annotated[
        int | None, typer.Option(help="Rounds whose median is told; 5 by default, 1 if quick.")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """Measures plant step, environments, threads and memory beside CartPole-v1 and FASTSim."""
    from agents.speed import benchmark, report

    plan = benchmark.QUICK if quick else benchmark.FULL
    if repeats is not None and repeats < 1:
        fail(f"--repeats is {repeats}, but must be at least 1")
    if repeats is not None:
        plan = replace(plan, repeats=repeats)
    with benchmark.bar() as advance:
        measured = benchmark.measure(plan, advance)
    if json:
        print_json(report.to_json(measured))
        return
    console.print(report.single_table(measured))
    console.print()
    console.print(report.vector_table(measured))
    console.print()
    for remark in report.remarks(measured):
        console.print(remark)
