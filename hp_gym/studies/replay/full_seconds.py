"""Samples of any rate at the full seconds of the model."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

_FAST_S: Final = 0.9
"""Below this median interval samples count as faster than once a second, as for what is driven."""

_CLOCK_TOLERANCE_S: Final = 1e-3
"""By so much the last full second may be missed, as there."""


def at_full_seconds(times_s: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Brings samples to the full seconds of a trip, as a row of a run stands for the second before it.

    Where samples come faster than once a second, a value is the mean of the line through the samples
    over the second before it, which keeps its integral; otherwise it is what that line has at the second, a
    sample as it was. At the start it is the first sample.

    Args:
        times_s: When samples were taken, from 0 on, rising.
        values: Samples.

    Returns:
        A value for each full second, 0 and the last one that samples reach included.
    """
    seconds = np.arange(np.floor(times_s[-1] + _CLOCK_TOLERANCE_S) + 1.0)
    if np.median(np.diff(times_s)) >= _FAST_S:
        return np.interp(seconds, times_s, values)
    # Integral up to each sample and to each full second: of a line, that of a trapezoid.
    steps = 0.5 * (values[1:] + values[:-1]) * np.diff(times_s)
    integral = np.concatenate(([0.0], np.cumsum(steps)))
    before = np.clip(np.searchsorted(times_s, seconds, side="right") - 1, 0, len(times_s) - 2)
    rest_s = seconds - times_s[before]
    at_second = np.interp(seconds, times_s, values)
    up_to = integral[before] + 0.5 * (values[before] + at_second) * rest_s
    return np.concatenate((values[:1], np.diff(up_to)))
