"""All claims of the paper's text."""

from collections.abc import Iterable
from typing import Final

from hp_gym.studies.reproduction.case1_claims import CASE1_CLAIMS
from hp_gym.studies.reproduction.case2_claims import CASE2_CLAIMS
from hp_gym.studies.reproduction.claim import Claim
from hp_gym.studies.reproduction.conditions import Outcome
from hp_gym.studies.reproduction.paper import LABELS
from hp_gym.studies.reproduction.runs import Runs
from hp_gym.trajectory import Trajectory

CLAIMS: Final = (*CASE1_CLAIMS, *CASE2_CLAIMS)


def by_label(runs: Iterable[Trajectory]) -> Runs:
    """Runs of the paper's scenarios by the short names of the claims."""
    return {LABELS[run.scenario]: run for run in runs}


def judge_all(runs: Iterable[Trajectory]) -> list[tuple[Claim, Outcome]]:
    """Every claim with what became of it in the runs of the nine scenarios."""
    labelled = by_label(runs)
    return [(claim, claim.judge(labelled)) for claim in CLAIMS]
