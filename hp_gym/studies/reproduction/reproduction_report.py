"""The reproduction as data and as tables."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rich.table import Table

from hp_gym.studies.reproduction.claim import Claim
from hp_gym.studies.reproduction.claims import judge_all
from hp_gym.studies.reproduction.conditions import Outcome
from hp_gym.studies.reproduction.paper import LITERAL_VEHICLE, PUBLISHED_SCENARIOS, PublishedScenario
from hp_gym.studies.reproduction.runs import simulate_all
from hp_gym.trajectory import Trajectory

ENERGY_GOAL_PCT = 1.0
FINAL_SOC_GOAL_PCT = 0.5


@dataclass(frozen=True)
class Row:
    """A published scenario beside the model's.

    Attributes:
        published: What the paper gives.
        run: What the model gives.
        literal: What the model gives with the text's 40 Ah cells.
    """

    published: PublishedScenario
    run: Trajectory
    literal: Trajectory

    @property
    def energy_error_pct(self) -> float:
        """Error of the energy, as a share of the published one."""
        return 100.0 * (self.run.summary["energy_kwh"] / self.published.energy_kwh - 1.0)

    @property
    def final_soc_error_pct(self) -> float | None:
        """Error of the final state of charge in points."""
        return self._final_soc_error_pct(self.run)

    @property
    def literal_final_soc_error_pct(self) -> float | None:
        """The same with the text's 40 Ah cells."""
        return self._final_soc_error_pct(self.literal)

    def _final_soc_error_pct(self, run: Trajectory) -> float | None:
        if self.published.final_soc_pct is None:
            return None
        return run.summary["final_soc_pct"] - self.published.final_soc_pct


@dataclass(frozen=True)
class Reproduction:
    """All of it.

    Attributes:
        rows: Scenarios in the paper's order.
        claims: Claims with what became of them.
        simulated_s: Time that was driven.
        wall_s: Time that driving it took, without loading files and without the 40 Ah variant.
    """

    rows: Sequence[Row]
    claims: Sequence[tuple[Claim, Outcome]]
    simulated_s: float
    wall_s: float

    def to_json(self) -> dict[str, Any]:
        """The figures as plain data."""
        return {
            "scenarios": [
                {
                    "id": row.published.id,
                    "paper_energy_kwh": row.published.energy_kwh,
                    "energy_kwh": row.run.summary["energy_kwh"],
                    "paper_final_soc_pct": row.published.final_soc_pct,
                    "final_soc_pct": row.run.summary["final_soc_pct"],
                }
                for row in self.rows
            ],
            "claims": [
                {"id": claim.id, "claim": claim.text, "holds": outcome.holds, "evidence": outcome.evidence}
                for claim, outcome in self.claims
            ],
            "simulated_s": self.simulated_s,
            "wall_s": self.wall_s,
            "literal_40ah": [
                {
                    "id": row.published.id,
                    "energy_kwh": row.literal.summary["energy_kwh"],
                    "final_soc_pct": row.literal.summary["final_soc_pct"],
                }
                for row in self.rows
            ],
        }


def reproduce(substeps: int = 1, overrides: Sequence[str] = ()) -> Reproduction:
    """Runs the paper's scenarios and judges its claims.

    Args:
        substeps: Steps of the plant in a second.
        overrides: `key=value` replacements for all scenarios.
    """
    scenarios = [published.id for published in PUBLISHED_SCENARIOS]
    runs, wall_s = simulate_all(scenarios, overrides, substeps)
    literal, _ = simulate_all(scenarios, [*overrides, f'scenario.vehicle="{LITERAL_VEHICLE}"'], substeps)
    return Reproduction(
        rows=[Row(*row) for row in zip(PUBLISHED_SCENARIOS, runs, literal, strict=True)],
        claims=judge_all(runs),
        simulated_s=sum(run.summary["duration_s"] for run in runs),
        wall_s=wall_s,
    )


def scenario_table(rows: Iterable[Row]) -> Table:
    """Tables 1 and 2 of the paper beside the model."""
    table = Table(title="Jeffs et al. 2019, Tables 1 and 2, beside the model", title_justify="left")
    table.add_column("scenario", no_wrap=True)
    headings = (
        "paper\nkWh",
        "model\nkWh",
        "error\n%",
        "paper\nSOC %",
        "model\nSOC %",
        "error\npt",
        "40 Ah\npt",
    )
    for heading in headings:
        table.add_column(heading, justify="right", no_wrap=True)
    for row in rows:
        published, summary = row.published, row.run.summary
        table.add_row(
            published.id,
            f"{published.energy_kwh:.2f}",
            f"{summary['energy_kwh']:.2f}",
            _coloured(row.energy_error_pct, ENERGY_GOAL_PCT),
            "" if published.final_soc_pct is None else f"{published.final_soc_pct:.1f}",
            f"{summary['final_soc_pct']:.1f}",
            _coloured(row.final_soc_error_pct, FINAL_SOC_GOAL_PCT),
            _coloured(row.literal_final_soc_error_pct, FINAL_SOC_GOAL_PCT),
            end_section=published.label == "S5",
        )
    return table


def claim_table(claims: Iterable[tuple[Claim, Outcome]]) -> Table:
    """The text's claims one by one."""
    table = Table(title="Claims of the paper's text", title_justify="left", show_lines=False)
    table.add_column("", justify="right")
    table.add_column("holds")
    table.add_column("claim", ratio=1)
    table.add_column("evidence", ratio=1)
    for claim, outcome in claims:
        holds = "[green]yes[/]" if outcome.holds else "[red]no[/]"
        table.add_row(str(claim.id), holds, claim.text, outcome.evidence)
    return table


def closing_lines(reproduction: Reproduction) -> list[str]:
    """What to remember: worst errors, claims, speed."""
    rows, claims = reproduction.rows, reproduction.claims
    held = sum(outcome.holds for _, outcome in claims)
    ratio = reproduction.simulated_s / max(reproduction.wall_s, 1e-9)
    energy_pct = max(abs(row.energy_error_pct) for row in rows)
    final_soc_pct = _largest(row.final_soc_error_pct for row in rows)
    literal_pct = _largest(row.literal_final_soc_error_pct for row in rows)
    return [
        f"Largest errors: energy {energy_pct:.2f} %, final SOC {final_soc_pct:.2f} points.",
        f"With the text's 40 Ah cells final SOC misses by up to {literal_pct:.2f} points.",
        f"Claims that hold: {held} of {len(claims)}.",
        f"{reproduction.simulated_s:.0f} s in {reproduction.wall_s:.3f} s: {ratio:,.0f} times real time.",
    ]


def labelled(reproduction: Reproduction) -> Mapping[str, Trajectory]:
    """Runs by the short names of the claims."""
    return {row.published.label: row.run for row in reproduction.rows}


def _largest(errors: Iterable[float | None]) -> float:
    return max((abs(error) for error in errors if error is not None), default=math.nan)


def _coloured(error: float | None, goal: float) -> str:
    if error is None:
        return ""
    colour = "green" if abs(error) <= goal else "red"
    return f"[{colour}]{error:+.2f}[/]"
