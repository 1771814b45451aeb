"""What a sweep drives: its runs by number, and its definition, to tell folders apart."""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from hp_gym import toml_files
from hp_gym.build_identity import build
from hp_gym.json_text import plain
from hp_gym.messages import OneLineError
from hp_gym.overrides import Value
from hp_gym.studies.axes import SELECTORS, Axis, Base, Between
from hp_gym.studies.planned_runs import Planned
from hp_gym.studies.sweep import sampling

MOST_RUNS: Final = 10_000_000


class SweepError(OneLineError):
    """A sweep cannot be driven as asked for; what was there before is intact."""


@dataclass(frozen=True)
class Plan:
    """A sweep.

    Attributes:
        base: What is driven where no axis says otherwise.
        axes: What varies; the last one fastest.
        sample: One of `sampling.SAMPLES`; None for all combinations.
        count: Points of the sample.
        seed: Seed of the sample.
        keep_refused: Whether runs that the plant refuses are noted instead of ending the sweep.
    """

    base: Base
    axes: tuple[Axis, ...]
    sample: str | None = None
    count: int = 0
    seed: int = 0
    keep_refused: bool = False

    def __post_init__(self) -> None:
        """Checks that axes and sample fit each other.

        Raises:
            SweepError: A grid has a range without a step, or there are too many runs.
            SampleError: See `sampling.runs_of`.
        """
        if self.sample is None:
            for axis in self.axes:
                if isinstance(axis.values, Between):
                    message = (
                        f"axis `{axis.name}` is a range without values, which needs a sample "
                        f"({', '.join(sampling.SAMPLES)})"
                    )
                    raise SweepError(message)
        if self.runs > MOST_RUNS:
            message = f"the sweep has {self.runs:,} runs, but may have at most {MOST_RUNS:,}"
            raise SweepError(message)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each axis of a grid; number of runs of a sample."""
        if self.sample is not None:
            return (sampling.runs_of(self.sample, self.count, len(self.axes)),)
        return tuple(len(axis.probes()) for axis in self.axes)

    @property
    def runs(self) -> int:
        """Number of runs."""
        return math.prod(self.shape)

    @cached_property
    def shares(self) -> NDArray[np.float64]:
        """The sample in the unit cube, a row a run."""
        if self.sample is None:
            message = "a grid has no sample"
            raise SweepError(message)
        return sampling.shares(self.sample, self.count, len(self.axes), self.seed)

    def point(self, run: int) -> tuple[Value, ...]:
        """Value of each axis in a run."""
        if self.sample is not None:
            pairs = zip(self.axes, self.shares[run], strict=True)
            return tuple(axis.at(float(share)) for axis, share in pairs)
        places = np.unravel_index(run, self.shape)
        return tuple(axis.probes()[int(place)] for axis, place in zip(self.axes, places, strict=True))

    def planned(self, runs: Sequence[int]) -> list[Planned]:
        """What the runs of these numbers drive."""
        return [self.base.run(self.changes(self.point(run))) for run in runs]

    def changes(self, point: Sequence[Value]) -> dict[str, Value]:
        """Overrides and choices of a point."""
        changes: dict[str, Value] = {}
        for axis, value in zip(self.axes, point, strict=True):
            changes |= axis.changes(value)
        return changes

    def labels(self, runs: Sequence[int]) -> dict[str, list[float | str]]:
        """Values of the axes in runs, as they stand in tables."""
        points = [self.point(run) for run in runs]
        return {
            axis.name: [axis.label(point[place]) for point in points] for place, axis in enumerate(self.axes)
        }

    def definition(self) -> dict[str, Any]:
        """All that the results depend on, as JSON can hold it."""
        definition = {
            "scenario": self.base.scenario,
            "controller": self.base.controller,
            "vehicle": self.base.vehicle,
            "overrides": self.base.overrides,
            "substeps": self.base.substeps,
            "axes": [self._described(axis) for axis in self.axes],
            "sample": self.sample,
            "count": self.count,
            "seed": self.seed,
            "keep_refused": self.keep_refused,
            "runs": self.runs,
            "files": self._files(),
            "build": build(),
        }
        described: dict[str, Any] = json.loads(json.dumps(plain(definition)))
        return described

    @staticmethod
    def _described(axis: Axis) -> dict[str, Any]:
        values: Any = axis.values
        if isinstance(values, Between):
            values = {"low": values.low, "high": values.high}
        return {"name": axis.name, "keys": axis.keys, "unit": axis.unit, "values": values}

    def _files(self) -> dict[str, str]:
        """Checksums of the files on disk that the sweep names, those that they are based on included."""
        named = {kind: [getattr(self.base, kind)] for kind in SELECTORS}
        texts = []
        for axis in self.axes:
            values = [value for value in axis.probes() if isinstance(value, str)]
            texts += values
            for key in set(axis.keys) & set(SELECTORS):
                named[key] += values
        digests = {}
        for kind, names in named.items():
            for name in filter(None, names):
                for file, _ in toml_files.chain(kind, name):
                    texts.append(file)
        for text in texts:
            if Path(text).suffix and Path(text).is_file():
                digests[text] = hashlib.sha256(Path(text).read_bytes()).hexdigest()[:16]
        return digests


def difference(there: Mapping[str, Any], wanted: Mapping[str, Any]) -> str | None:
    """Returns in words what differs between two definitions; None where nothing does."""
    for key in wanted:
        if there.get(key) != wanted[key]:
            old, new = (_short(definition.get(key)) for definition in (there, wanted))
            return f"its `{key}` is {old}, here it is {new}"
    return None


def _short(value: object) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 120 else f"{text[:70]} ... {text[-40:]}"
