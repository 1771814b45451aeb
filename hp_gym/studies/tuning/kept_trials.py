"""Trials of a search that was stopped: the same command goes on with them."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import hp_gym
from hp_gym.files import OURS, read_bytes

_LARGEST_BYTES: Final = 64 * 2**20

Outcome = tuple[float, float]
"""Mean score of a trip, and mean discomfort [K]."""


class KeptTrials:
    """A file beside the folder of results, a line a trial; removed when the search has ended.

    Searches draw the same choices again for the same seed and the same outcomes, so that what a trial gave is
    all that is needed to go on. Lines that were not written whole count as not driven.

    Args:
        folder: Folder of the results.
        command: What was asked for; trials of another command are forgotten.
    """

    def __init__(self, folder: Path, command: str) -> None:
        place = folder.resolve()
        self._path = place.with_name(f".{place.name}.{OURS}trials.jsonl")
        self._head = json.dumps({"command": command, "version": hp_gym.__version__})
        self._outcomes = self._read()
        if not self._outcomes:
            self._begin()

    def __len__(self) -> int:
        """Number of trials."""
        return len(self._outcomes)

    def get(self, band: str, choices: Mapping[str, Any]) -> Outcome | None:
        """Returns what choices gave in a band, if that is known."""
        return self._outcomes.get(_key(band, choices))

    def add(self, band: str, choices: Mapping[str, Any], outcome: Outcome) -> None:
        """Notes what choices gave in a band.

        Raises:
            OSError: The file cannot be written to.
        """
        key = _key(band, choices)
        self._outcomes[key] = outcome
        with self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps([key, *outcome]) + "\n")

    def forget(self) -> None:
        """Begins anew, for example because the plant has changed.

        Raises:
            OSError: The file cannot be written to.
        """
        self._outcomes = {}
        self._begin()

    def remove(self) -> None:
        """Removes the file."""
        self._path.unlink(missing_ok=True)

    def _begin(self) -> None:
        self._path.parent.mkdir(parents=True, exist_ok=True)
        self._path.write_text(self._head + "\n", encoding="utf-8")

    def _read(self) -> dict[str, Outcome]:
        try:
            lines = read_bytes(self._path, _LARGEST_BYTES).decode("utf-8").splitlines()
        except (OSError, ValueError):
            return {}
        if not lines or lines[0] != self._head:
            return {}
        outcomes = {}
        for line in lines[1:]:
            try:
                key, score, discomfort_k = json.loads(line)
                if isinstance(key, str) and math.isfinite(score) and math.isfinite(discomfort_k):
                    outcomes[key] = (float(score), float(discomfort_k))
            except (ValueError, TypeError, OverflowError, RecursionError):
                continue
        return outcomes


def _key(band: str, choices: Mapping[str, Any]) -> str:
    return json.dumps([band, dict(choices)], sort_keys=True)
