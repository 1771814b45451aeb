"""A claim of the paper's text with its criterion."""

import inspect
from collections.abc import Callable
from dataclasses import dataclass

from hp_gym.studies.reproduction.conditions import Outcome
from hp_gym.studies.reproduction.runs import Runs

Judge = Callable[[Runs], Outcome]


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper and when it counts as true.

    Attributes:
        id: Number.
        text: What the paper says.
        criterion: When it holds; ours, as the curves are not in the text.
        judge: Decides by the runs, which it looks up by the short names S1..S5 and D1..D4.
    """

    id: int
    text: str
    criterion: str
    judge: Judge


def claim(number: int) -> Callable[[Judge], Claim]:
    """Makes a claim of a function whose docstring is the claim's text, a blank line and the criterion."""

    def build(judge: Judge) -> Claim:
        text, _, criterion = (inspect.getdoc(judge) or "").partition("\n\n")
        return Claim(number, text.removesuffix("."), " ".join(criterion.split()), judge)

    return build
