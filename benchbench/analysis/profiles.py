"""Profiles: which share of the problems a method solves, over what it may cost.

Costs are tables (problems x methods): positive numbers, infinite where the method failed.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from benchbench.ground.arrays import Array

Staircase = tuple[Array, Array]
"""A step function: places (increasing) and the value from each place on."""


def performance_profile(costs: pd.DataFrame) -> dict[str, Staircase]:
    """Share of problems that each method solves within tau times the best method's cost (Dolan & More 2002).

    A problem that no method solves counts in the denominator and is solved within no tau. Raises ValueError
    for costs that are not positive or missing.
    """
    _check(costs)
    best = costs.min(axis=1).where(lambda least: np.isfinite(least), 1.0)
    return _shares(costs.div(best, axis=0))


def data_profile(costs: pd.DataFrame, sizes: pd.Series | None = None) -> dict[str, Staircase]:
    """Share of problems that each method solves within a cost (More & Wild 2009).

    sizes: number of unknowns n of each problem; costs in evaluations are then counted in groups of n + 1, as
    there. Raises ValueError for costs that are not positive or missing.
    """
    _check(costs)
    return _shares(costs if sizes is None else costs.div(sizes.reindex(costs.index) + 1, axis=0))


def _shares(costs: pd.DataFrame) -> dict[str, Staircase]:
    return {str(method): _share_within(costs[method].to_numpy(float)) for method in costs}


def _share_within(costs: Array) -> Staircase:
    places, counts = np.unique(costs[np.isfinite(costs)], return_counts=True)
    return places, np.cumsum(counts) / max(len(costs), 1)


def _check(costs: pd.DataFrame) -> None:
    if not (costs.to_numpy(float) > 0).all():  # NaN is not
        raise ValueError(
            "a profile needs a positive cost for every problem and method, infinite for a failure"
        )
