"""`hp-gym calibrate`: fit of the vehicle to published totals and measurements."""

from enum import StrEnum
from pathlib import Path
from time import perf_counter
from typing import Annotated

import typer

from hp_gym.cli.output import console, fail, print_json


class Start(StrEnum):
    """Where the search starts."""

    CURRENT = "current"
    PRIOR = "prior"


class Loss(StrEnum):
    """How residuals count."""

    LINEAR = "linear"
    SOFT_L1 = "soft_l1"


def calibrate(
    *,
    config: Annotated[str, typer.Option(help="Calibration: name or path.")] = "jeffs2019",
    out: Annotated[Path, typer.Option(help="Folder for the result.")] = Path("out/calibrate"),
    max_evaluations: Annotated[
        int | None, typer.Option(min=1, help="Evaluations of all scenarios; by default the calibration's.")
    ] = None,
    start: Annotated[Start, typer.Option(help="Where the search starts.")] = Start.CURRENT,
    restarts: Annotated[int, typer.Option(min=0, help="Further searches from disturbed starts.")] = 0,
    central: Annotated[bool, typer.Option("--central", help="Central differences.")] = False,
    loss: Annotated[Loss, typer.Option(help="How residuals count.")] = Loss.LINEAR,
    leave_one_out: Annotated[
        bool, typer.Option("--leave-one-out", help="Refit without each scenario and predict it.")
    ] = False,
    subset: Annotated[
        bool, typer.Option("--subset", help="Refit to the calibration's subset and predict the rest.")
    ] = False,
    held_back: Annotated[
        bool, typer.Option("--held-back", help="Look at measurements that are held back: once, at the end.")
    ] = False,
    write: Annotated[
        bool, typer.Option("--write", help="Write the values into the checkout's configuration files.")
    ] = False,
    json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """Fits parameters within bounds to published totals and to measured traces, as a file says."""
    from hp_gym.studies.calibration import calibrated_files, calibration_report, held_out, measured_report
    from hp_gym.studies.calibration.calibrating import carry_out
    from hp_gym.studies.calibration.fit import Options
    from hp_gym.studies.calibration.problem import load
    from hp_gym.studies.calibration.progress import bar
    from hp_gym.transactions import new_contents

    try:
        if write:
            calibrated_files.checkout()
        problem = load(config)
        values = (
            calibrated_files.current_values(problem)
            if start is Start.CURRENT
            else {parameter.name: parameter.prior for parameter in problem.parameters}
        )
        limit = max_evaluations or problem.maximum_evaluations
        options = Options(central=central, loss=loss.value, restarts=restarts, maximum_evaluations=limit)
        began_s = perf_counter()
        done = carry_out(problem, values, options, leave_one_out=leave_one_out, held_back=held_back, bars=bar)
        result, parts = done.fit, done.held_out
        rest = None
        if subset:
            with bar("subset", limit) as progress:
                rest = held_out.subset(problem, values, options, progress)
        wall_s = perf_counter() - began_s
        with new_contents(out) as folder:
            done.write(folder)
        written = calibrated_files.write_back(problem, result.by_key()) if write else []
    except (ValueError, OSError) as error:
        fail(str(error))
    if json:
        print_json(calibration_report.to_json(result, parts, rest, wall_s) | measured_report.to_json(done))
        return
    console.print(calibration_report.parameter_table(result))
    if problem.targets:
        console.print(
            calibration_report.error_table("Errors of the fit", calibration_report.errors(problem, result))
        )
    for part in measured_report.tables(done):
        console.print(part)
    for title, group in (("Left out one at a time", parts), ("Outside the subset", [rest] if rest else [])):
        if group:
            shown = [item for part in group for item in part.errors]
            mean_pct, largest_pct = calibration_report.mean_and_largest_energy_pct(shown)
            heading = f"{title}: energy error mean {mean_pct:.2f} %, largest {largest_pct:.2f} %"
            console.print(calibration_report.error_table(heading, shown))
    published, measured = calibration_report.count_targets(problem), measured_report.count(problem)
    seen = f"{published} published numbers" + (f" and {measured} measured ones" if measured else "")
    console.print(
        f"{len(result.values)} parameters fitted to {seen}, {sum(result.at_bound)} at a bound; "
        f"{result.evaluations} evaluations, {wall_s:.0f} s in all."
    )
    console.print(f"Values: {out / 'calibrated.toml'}")
    for path in written:
        console.print(f"Written: {path}")
