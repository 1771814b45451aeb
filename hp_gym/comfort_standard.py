"""Comfort that a driver accepts, defined here and nowhere else: for benchmarks, tuning, training, planners.

A trip is compared with the same trip driven by the reference, `hpcu-modern` at 22 degC. It passes if it
arrives and

- *in time*: the cabin is near comfort (18 degC from the cold, down to 26 degC in heat: within 4 K of 22 degC)
  at most 30 s or 10 % later, whichever is more. Where the reference never is, the distance from there,
  integrated over the trip, is at most 10 % more;
- *comfortable*: from then on the mean distance of the cabin from 22 degC is at most 0.5 K more, each counted
  from its own time. Where the reference is never near comfort there is nothing to compare;
- *in good air*: fog on the windscreen, and carbon dioxide above 1500 ppm, last at most 30 s or 10 % longer,
  whichever is more.

The figures of a trip are totals that the plant adds up second by second, whoever drives
(rust_core/trip/src/comfort.rs).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

REFERENCE: Final = "hpcu-modern"
"""Rules that trips are compared with, as their file has them: 22 degC."""

LATER_S: Final = 30.0
LATER_SHARE: Final = 0.1
"""By how much near comfort may come later, and bad air last longer: the larger of seconds and share."""

OUTSIDE_SHARE: Final = 0.1
"""By how much the distance from near comfort may be more where the reference is never there."""

DISCOMFORT_K: Final = 0.5
"""By how much the mean distance from 22 degC afterwards may be more."""

Reading: TypeAlias = Literal["air", "equivalent"]
"""What a cabin's temperature is: that of its air, or its equivalent temperature (ISO 14505-2)."""

READINGS: Final[tuple[Reading, ...]] = ("air", "equivalent")

# What is added up, by reading, then what does not depend on it.
_OF_READING: Final = ("time_to_near_comfort_s", "outside_near_comfort_k_s", "discomfort_afterwards_k")
_OF_TRIP: Final = ("fog_s", "co2_above_1500_ppm_s", "duration_s")
_PREFIXES: Final[dict[Reading, str]] = {"air": "", "equivalent": "equivalent_"}

FIGURES: Final = (*(prefix + name for prefix in _PREFIXES.values() for name in _OF_READING), *_OF_TRIP)
"""Totals of a trip that it is judged by, as `hp_gym.simulate` and `finished` of an environment tell them."""


@dataclass(frozen=True, eq=False)
class TripComfort:
    """What trips are judged by, arrays of one shape.

    Attributes:
        time_to_near_comfort_s: Time until the cabin is first within 4 K of 22 degC; NaN if it never is.
        outside_near_comfort_k_s: Distance from there, integrated over the trip [K s].
        discomfort_afterwards_k: Mean distance from 22 degC from then on; NaN if it is never there.
        fog_s: Time with fog on the windscreen.
        co2_above_1500_ppm_s: Time with more carbon dioxide than that.
        duration_s: Duration.
        stranded: 1 where the trip ended before arrival, else 0.
    """

    time_to_near_comfort_s: NDArray[np.float64]
    outside_near_comfort_k_s: NDArray[np.float64]
    discomfort_afterwards_k: NDArray[np.float64]
    fog_s: NDArray[np.float64]
    co2_above_1500_ppm_s: NDArray[np.float64]
    duration_s: NDArray[np.float64]
    stranded: NDArray[np.float64]

    @classmethod
    def of(cls, totals: Mapping[str, Any], stranded: Any, reading: Reading = "air") -> TripComfort:
        """Takes the figures from totals.

        Args:
            totals: `FIGURES` by name: numbers, arrays or columns of a table. None counts as NaN.
            stranded: 1 where the trip ended before arrival, else 0.
            reading: What the cabin's temperature is.

        Raises:
            KeyError: A figure is missing.
        """
        names = {name: _PREFIXES[reading] + name for name in _OF_READING} | {name: name for name in _OF_TRIP}
        values = {name: np.asarray(totals[figure], dtype=np.float64) for name, figure in names.items()}
        return cls(**values, stranded=np.asarray(stranded, dtype=np.float64))


@dataclass(frozen=True, eq=False)
class Verdict:
    """How far trips are beyond what is accepted, in allowances: 0 at the limit, 1 at twice what is allowed.

    Attributes:
        lateness: Of near comfort; of the distance from it where the reference is never there.
        discomfort: Afterwards.
        fog: Duration of fog.
        co2: Duration of carbon dioxide above 1500 ppm.
        stranded: 1 where the trip ended before arrival, else 0.
    """

    lateness: NDArray[np.float64]
    discomfort: NDArray[np.float64]
    fog: NDArray[np.float64]
    co2: NDArray[np.float64]
    stranded: NDArray[np.float64]

    @property
    def in_time(self) -> NDArray[np.bool_]:
        """Whether the cabin is near comfort in time."""
        return self.lateness <= 0.0

    @property
    def comfortable(self) -> NDArray[np.bool_]:
        """Whether it stays as comfortable as it should."""
        return self.discomfort <= 0.0

    @property
    def in_good_air(self) -> NDArray[np.bool_]:
        """Whether fog and carbon dioxide hold their limits."""
        good: NDArray[np.bool_] = (self.fog <= 0.0) & (self.co2 <= 0.0)
        return good

    @property
    def excess(self) -> NDArray[np.float64]:
        """The worst of all, at least 1 for a stranded trip; 0 where a trip passes, and only there."""
        worst = np.maximum.reduce(np.broadcast_arrays(self.lateness, self.discomfort, self.fog, self.co2))
        return np.maximum(np.maximum(worst, self.stranded), 0.0)

    @property
    def passes(self) -> NDArray[np.bool_]:
        """Whether trips pass."""
        passes: NDArray[np.bool_] = self.excess <= 0.0
        return passes


def judge(trips: TripComfort, reference: TripComfort) -> Verdict:
    """Judges trips.

    Args:
        trips: The trips.
        reference: The same trips, driven by the reference; shapes that broadcast.
    """
    there = ~np.isnan(reference.time_to_near_comfort_s)
    arrives = ~np.isnan(trips.time_to_near_comfort_s)
    late = _longer(
        # A cabin that is never near comfort is later than all that the trip was long.
        np.where(arrives, trips.time_to_near_comfort_s, trips.duration_s),
        reference.time_to_near_comfort_s,
    )
    late = np.where(arrives, late, np.fmax(late, 1.0))
    needed_k_s = reference.outside_near_comfort_k_s
    # Positive where it counts: there the reference is outside all the time.
    allowed_k_s = np.where(there, 1.0, OUTSIDE_SHARE * needed_k_s)
    far = (trips.outside_near_comfort_k_s - needed_k_s - allowed_k_s) / allowed_k_s
    more_k = trips.discomfort_afterwards_k - reference.discomfort_afterwards_k
    # A cabin that is never near comfort has failed before.
    colder = np.where(there & arrives, (more_k - DISCOMFORT_K) / DISCOMFORT_K, 0.0)
    return Verdict(
        lateness=np.where(there, late, far),
        discomfort=colder,
        fog=_longer(trips.fog_s, reference.fog_s),
        co2=_longer(trips.co2_above_1500_ppm_s, reference.co2_above_1500_ppm_s),
        stranded=trips.stranded,
    )


def _longer(time_s: NDArray[np.float64], reference_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """How much longer than allowed, in allowances."""
    allowed_s = np.maximum(LATER_S, LATER_SHARE * reference_s)
    longer: NDArray[np.float64] = (time_s - reference_s - allowed_s) / allowed_s
    return longer
