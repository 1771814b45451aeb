"""A calibration's result as data, tables and a file."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from rich.table import Table

from hp_gym.studies.calibration.fit import Fit
from hp_gym.studies.calibration.problem import Problem, Target
from hp_gym.studies.calibration.residuals import Totals


@dataclass(frozen=True)
class Error:
    """Error of a scenario's totals; None where nothing is published.

    Attributes:
        scenario: Scenario.
        energy_pct: Error of the energy, as a share of the published one.
        final_soc_pct: Error of the final state of charge in points.
    """

    scenario: str
    energy_pct: float | None
    final_soc_pct: float | None


def error(target: Target, found: Totals) -> Error:
    """Error of a scenario."""
    energy_pct = None if target.energy_kwh is None else 100.0 * (found.energy_kwh / target.energy_kwh - 1.0)
    soc_pct = None if target.final_soc_pct is None else found.final_soc_pct - target.final_soc_pct
    return Error(target.scenario, energy_pct, soc_pct)


def errors(problem: Problem, fit: Fit) -> list[Error]:
    """Errors of all scenarios against a problem's targets, held out from the fit or not."""
    return [error(target, fit.totals[target.scenario]) for target in problem.targets]


@dataclass(frozen=True)
class HeldOut:
    """Errors of scenarios that a fit did not see.

    Attributes:
        errors: Their errors.
        evaluations: What the fit took.
    """

    errors: Sequence[Error]
    evaluations: int


def mean_and_largest_energy_pct(held_out: Sequence[Error]) -> tuple[float, float]:
    """Mean and largest absolute energy error."""
    absolute = [abs(item.energy_pct) for item in held_out if item.energy_pct is not None]
    return sum(absolute) / len(absolute), max(absolute)


def count_targets(problem: Problem) -> int:
    """Published numbers that a fit sees."""
    numbers = [number for target in problem.targets for number in (target.energy_kwh, target.final_soc_pct)]
    return sum(number is not None for number in numbers)


def to_json(fit: Fit, left_out: Sequence[HeldOut], rest: HeldOut | None, wall_s: float) -> dict[str, Any]:
    """The result as plain data."""
    result: dict[str, Any] = {
        "parameters": [
            {
                "keys": list(parameter.keys),
                "value": value,
                "low": parameter.low,
                "high": parameter.high,
                "prior": parameter.prior,
                "at_bound": at_bound,
                "source": parameter.source,
            }
            for parameter, value, at_bound in zip(
                fit.problem.parameters, fit.values, fit.at_bound, strict=True
            )
        ],
        "scenarios": [_error_json(item) for item in errors(fit.problem, fit)],
        "at_bound": sum(fit.at_bound),
        "cost": fit.cost,
        "evaluations": fit.evaluations,
        "wall_s": wall_s,
    }
    for name, parts in (("leave_one_out", left_out), ("outside_subset", [rest] if rest else [])):
        if parts:
            every = [item for part in parts for item in part.errors]
            mean_pct, largest_pct = mean_and_largest_energy_pct(every)
            result[name] = {
                "scenarios": [_error_json(item) for item in every],
                "mean_energy_error_pct": mean_pct,
                "largest_energy_error_pct": largest_pct,
            }
    return result


def to_toml(fit: Fit) -> str:
    """The values as a file of `key = value`."""
    lines = [f"# {fit.problem.description}", "# Written by `hp-gym calibrate`; (!) is at a bound.", ""]
    for parameter, value, at_bound in zip(fit.problem.parameters, fit.values, fit.at_bound, strict=True):
        flag = " (!)" if at_bound else ""
        lines += [
            f'"{key}" = {value!r}  # {parameter.low:g}..{parameter.high:g}{flag}' for key in parameter.keys
        ]
    return "\n".join(lines) + "\n"


def parameter_table(fit: Fit) -> Table:
    """Values, ranges, priors, sources."""
    table = Table(
        title=f"{sum(fit.at_bound)} of {len(fit.values)} parameters at a bound", title_justify="left"
    )
    table.add_column("parameter", overflow="fold")
    for heading in ("value", "low", "high", "prior"):
        table.add_column(heading, justify="right")
    table.add_column("")
    table.add_column("source", overflow="fold")
    for parameter, value, at_bound in zip(fit.problem.parameters, fit.values, fit.at_bound, strict=True):
        table.add_row(
            "\n".join(key.replace("[", r"\[") for key in parameter.keys),
            *(f"{number:g}" for number in (value, parameter.low, parameter.high, parameter.prior)),
            "[yellow]at bound[/]" if at_bound else "",
            parameter.source,
        )
    return table


def error_table(title: str, rows: Sequence[Error]) -> Table:
    """Errors by scenario."""
    table = Table(title=title, title_justify="left")
    table.add_column("scenario")
    table.add_column("energy error %", justify="right")
    table.add_column("final SOC error, points", justify="right")
    for row in rows:
        numbers = (row.energy_pct, row.final_soc_pct)
        table.add_row(row.scenario, *("" if number is None else f"{number:+.2f}" for number in numbers))
    return table


def _error_json(item: Error) -> dict[str, Any]:
    return {
        "id": item.scenario,
        "energy_error_pct": item.energy_pct,
        "final_soc_error_points": item.final_soc_pct,
    }
