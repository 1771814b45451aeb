"""Samples of the unit cube: Latin hypercube, Sobol's sequence, and Saltelli's design for sensitivities."""

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from hp_gym.messages import OneLineError

SAMPLES: Final = ("latin-hypercube", "sobol", "saltelli")
"""Kinds of samples."""

_MOST_RUNS: Final = 10_000_000


class SampleError(OneLineError):
    """A sample cannot be drawn as asked for."""


def runs_of(sample: str, count: int, axes: int) -> int:
    """Returns how many runs a sample has.

    Args:
        sample: One of `SAMPLES`.
        count: Points; for `saltelli` those of the base sample.
        axes: Number of axes.

    Raises:
        SampleError: The kind is unknown, or the number does not fit it.
    """
    if sample not in SAMPLES:
        message = f"sample is `{sample}`, but must be one of {', '.join(SAMPLES)}"
        raise SampleError(message)
    runs = count * (axes + 2) if sample == "saltelli" else count
    if not (count >= 1 and runs <= _MOST_RUNS):
        message = f"count is {count}, but must be at least 1 and give at most {_MOST_RUNS:,} runs"
        raise SampleError(message)
    if sample != "latin-hypercube" and count & (count - 1):
        message = f"count is {count}, but must be a power of 2 for `{sample}`"
        raise SampleError(message)
    return runs


def shares(sample: str, count: int, axes: int, seed: int) -> NDArray[np.float64]:
    """Draws a sample: a row a run, a column an axis, all from 0 to 1.

    Raises:
        SampleError: See `runs_of`.
    """
    runs_of(sample, count, axes)
    if sample == "latin-hypercube":
        return np.asarray(qmc.LatinHypercube(axes, rng=seed).random(count))
    if sample == "sobol":
        return np.asarray(qmc.Sobol(axes, rng=seed).random_base2(count.bit_length() - 1))
    from SALib.sample import sobol

    drawn = sobol.sample(problem(axes), count, calc_second_order=False, seed=seed)
    return np.asarray(drawn, dtype=np.float64)


def problem(axes: int, names: list[str] | None = None) -> dict[str, object]:
    """Returns SALib's description of the unit cube."""
    return {
        "num_vars": axes,
        "names": names or [f"x{axis}" for axis in range(axes)],
        "bounds": [[0.0, 1.0]] * axes,
    }
