"""Energy at matched comfort: what rules need to be as comfortable as another controller is.

Rules with other set points are a front of points (discomfort, energy), both over the same trips. The energy
that the front needs at a discomfort d is the least of

- a mixture of two settings whose discomforts enclose d, one on some trips and the other on the others, and
- any setting that is at least as comfortable.

So the front is its lower convex hull, made to fall: the strongest that these rules can be without knowing the
trip. A controller that is more comfortable than every setting is compared with the most comfortable setting,
which needs less than the matched one would. For one that is less comfortable than every setting there is no
matched energy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

INTERPOLATED: Final = "interpolated"
MOST_COMFORTABLE: Final = "most comfortable setting"
UNMATCHED: Final = "less comfortable than every setting"


def front_energy_kwh(
    discomfort_k: NDArray[np.float64],
    front_discomfort_k: NDArray[np.float64],
    front_energy_kwh: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Returns the energy that a front needs at a discomfort.

    Args:
        discomfort_k: Discomfort of the controller, any number of resamples.
        front_discomfort_k: Discomfort of the settings, one row a resample, one column a setting.
        front_energy_kwh: Their energy, likewise.

    Returns:
        One energy a resample; NaN where the controller is less comfortable than every setting.
    """
    wanted = discomfort_k[:, None]
    comfortable = front_discomfort_k <= wanted
    # The best setting that is at least as comfortable, then the best mixture with one that is less so.
    least = np.where(comfortable, front_energy_kwh, np.inf).min(axis=1)
    for better in range(front_discomfort_k.shape[1]):
        below_k, below_kwh = front_discomfort_k[:, [better]], front_energy_kwh[:, [better]]
        span_k = front_discomfort_k - below_k
        enclosing = (below_k <= wanted) & (wanted < front_discomfort_k)
        share = np.divide(wanted - below_k, span_k, out=np.zeros_like(span_k), where=enclosing)
        mixed = below_kwh + share * (front_energy_kwh - below_kwh)
        least = np.minimum(least, np.where(enclosing, mixed, np.inf).min(axis=1))
    rows = np.arange(len(discomfort_k))
    most_comfortable = front_energy_kwh[rows, front_discomfort_k.argmin(axis=1)]
    least = np.where(comfortable.any(axis=1), least, most_comfortable)
    return np.where(discomfort_k > front_discomfort_k.max(axis=1), np.nan, least)


def how_matched(discomfort_k: float, front_discomfort_k: NDArray[np.float64]) -> str:
    """Says how a discomfort compares with those of a front."""
    if discomfort_k > front_discomfort_k.max():
        return UNMATCHED
    return MOST_COMFORTABLE if discomfort_k < front_discomfort_k.min() else INTERPOLATED
