"""Where in a summary the report finds what it shows."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from hp_gym.agents.controllers.learned import ABLATION
from hp_gym.studies.benchmark.report.shown import MINUS, Summary

if TYPE_CHECKING:
    from collections.abc import Mapping

PAPER: Final = "hpcu"

_RIVALS: Final[Mapping[str, str]] = {
    "hpcu": "the paper's rules (hpcu), any cabin set point",
    "hpcu_any_htc": "hpcu with any cabin and HTC set point",
    "hpcu_tuned": "the tuned rules (hpcu-tuned), any cabin, HTC and PTC set point",
}


@dataclass(frozen=True)
class Comparison:
    """A gain and where it stands in the summary.

    Attributes:
        path: Its place.
        controller: Who is compared, as in the summary's keys.
        rival: With whom, in words.
    """

    path: tuple[str, ...]
    controller: str
    rival: str

    def at(self, *names: str | int) -> tuple[str | int, ...]:
        """Returns the place of something within the gain."""
        return (*self.path, *names)


class Layout:
    """Reads a summary.

    Args:
        data: What `summary.json` holds.

    Attributes:
        summary: The same, place by place.
        controllers: Names of all controllers but ablations.
        grid_bands: Facts of all climate bands by name.
        bands: Names of those that have trips.
    """

    def __init__(self, data: Mapping[str, Any]) -> None:
        self.summary = Summary(data)
        self.controllers: list[str] = [name for name in data["controllers"] if not name.startswith(ABLATION)]
        self.grid_bands: Mapping[str, Any] = data["grid"]["bands"]
        self.bands: list[str] = [band for band, facts in self.grid_bands.items() if facts["scenarios"]]

    @property
    def headline_bands(self) -> list[str]:
        """Climate bands that the headline's figures are of."""
        return [band for band in self.bands if self.grid_bands[band]["headline"]]

    def kpi(self, controller: str, name: str, band: str | None = None) -> float | None:
        """Returns a KPI of a controller in a band, or over the headline's bands; None if there is none."""
        return self.summary.number(*kpi_path(controller, name, band))

    def interval(self, controller: str, band: str, name: str) -> tuple[float, float] | None:
        """Returns the ends of an interval of a controller's difference to the paper's rules; None without."""
        low, high = (self.summary.number(*difference_path(controller, band, name), end) for end in (0, 1))
        return None if low is None or high is None else (low, high)

    def seeds(self, controller: str) -> list[int]:
        """Returns the training seeds of a controller; empty for one without."""
        return [seed for seed in self.summary.get("controllers", controller, "seeds") or [] if seed >= 0]

    def comparisons(self, table: str = "gains") -> list[Comparison]:
        """Returns all gains of a table, `gains` or `ablations`, in its order."""
        found = []
        for key in self.summary.get(table) or {}:
            controller, _, rival = key.rpartition("_vs_")
            found.append(Comparison((table, key), controller, _RIVALS.get(rival, rival)))
        return found

    def title(self, controller_key: str) -> str:
        """Returns a controller's name for the form that it has in the summary's keys."""
        fitting = (name for name in self.controllers if name.replace("-", "_") == controller_key)
        return next(fitting, controller_key)


def band_title(band: str) -> str:
    """Returns the name of a climate band in words, with a true minus before numbers: `0..10` is `0 to 10`."""
    return re.sub(r"-(?=\d)", MINUS, band).replace("..", " to ")


def kpi_path(controller: str, name: str, band: str | None = None) -> tuple[str, ...]:
    """Returns the place of a KPI, over the headline's bands where no band is given."""
    return ("controllers", controller, *(() if band is None else ("bands", band)), name)


def difference_path(controller: str, band: str, name: str) -> tuple[str, ...]:
    """Returns the place of one of a controller's differences to the paper's rules in a band."""
    return ("controllers", controller, "bands", band, "vs_hpcu", name)
