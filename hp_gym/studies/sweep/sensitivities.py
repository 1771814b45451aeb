"""How much of a total's variance each axis explains (SALib)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hp_gym import extras
from hp_gym.studies.axes import Axis, Base, Between
from hp_gym.studies.sweep import sampling
from hp_gym.studies.sweep.sweep_plan import Plan, SweepError

with extras.needed("sweep"):
    import pandas as pd

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hp_gym.studies.sweep.swept import Sweep

LEAST_RUNS = 130
"""Runs of a sample below which first-order indices by RBD-FAST mean nothing."""


def sensitivities(swept: Sweep, kpi: str) -> pd.DataFrame:
    """Returns Sobol's indices of a total, one row an axis.

    Of a `saltelli` sample first-order and total indices; of the others first-order ones (RBD-FAST). What ends
    with `_conf` is the half-width of a 95 % interval.

    Args:
        swept: A complete sweep over a sample.
        kpi: A total.

    Raises:
        SweepError: It is a grid, not complete, too small, the total does not exist, or not for every run.
    """
    definition = swept.definition
    if definition["sample"] is None:
        raise SweepError(
            f"{swept.path}: is a grid; sensitivities need a sample ({', '.join(sampling.SAMPLES)})"
        )
    if not swept.complete:
        raise SweepError(f"{swept.path}: is not complete; go on with the sweep first")
    values = swept.to_pandas([kpi])[kpi].to_numpy(dtype=np.float64)
    if not np.isfinite(values).all():
        count = int((~np.isfinite(values)).sum())
        raise SweepError(
            f"`{kpi}` does not exist in {count} of {len(values)} runs; its sensitivities neither"
        )
    names = list(swept.axes)
    problem = sampling.problem(len(names), names)
    seed = int(definition["seed"])
    if definition["sample"] == "saltelli":
        from SALib.analyze import sobol

        found = sobol.analyze(problem, values, calc_second_order=False, seed=seed)
        columns = ["S1", "S1_conf", "ST", "ST_conf"]
    else:
        if len(values) < LEAST_RUNS:
            raise SweepError(f"{len(values)} runs are too few for sensitivities; at least {LEAST_RUNS}")
        from SALib.analyze import rbd_fast

        found = rbd_fast.analyze(problem, _shares(definition), values, seed=seed)
        columns = ["S1", "S1_conf"]
    table = pd.DataFrame({column: np.asarray(found[column], dtype=np.float64) for column in columns})
    table.index = pd.Index(names, name="axis")
    return table


def _shares(definition: dict[str, Any]) -> NDArray[np.float64]:
    """The sample in the unit cube, drawn again."""
    axes = tuple(
        Axis(
            axis["name"],
            tuple(axis["keys"]),
            Between(**axis["values"]) if isinstance(axis["values"], dict) else tuple(axis["values"]),
        )
        for axis in definition["axes"]
    )
    plan = Plan(
        Base(definition["scenario"]), axes, definition["sample"], definition["count"], definition["seed"]
    )
    return plan.shares
