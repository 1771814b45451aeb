"""How far a model is from a measurement, second by second."""

from dataclasses import dataclass

import numpy as np

from hp_gym.studies.replay.measured_quantities import QUANTITIES, Channels, Quantity


@dataclass(frozen=True)
class SeriesError:
    """Model less measured over a trip, in the unit of the quantity.

    Attributes:
        quantity: What was measured.
        bias: Mean.
        rmse: Root of the mean square.
        largest: Largest, either way.
    """

    quantity: Quantity
    bias: float
    rmse: float
    largest: float


def series_errors(measured: Channels, model: Channels) -> tuple[SeriesError, ...]:
    """Errors of every quantity that both have, at the same seconds."""
    found = []
    for quantity in QUANTITIES:
        if quantity.name in measured and quantity.name in model:
            error = model[quantity.name] - measured[quantity.name]
            rmse = float(np.sqrt(np.mean(error**2)))
            found.append(SeriesError(quantity, float(error.mean()), rmse, float(np.abs(error).max())))
    return tuple(found)
