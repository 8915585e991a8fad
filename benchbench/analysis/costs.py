"""From rows of the table to costs per problem and method."""

from __future__ import annotations

import numpy as np
import pandas as pd


def solve_time(runs: pd.DataFrame) -> pd.Series:
    """CPU time (s) of the solver: the median of the repeats if every run that has a time was repeated.

    Otherwise the time of the one solve, which all have: repeats start warm, so the two are never mixed.
    """
    median = runs.solve_cpu_median_s.astype(float)
    once = runs.solve_cpu_s.astype(float)
    return median if median.notna().any() and median[once.notna()].notna().all() else once


def cost_matrix(runs: pd.DataFrame, cost: str, success: str = "certified") -> pd.DataFrame:
    """Costs (problems x methods): the median over repeats, a failed run costing infinity.

    runs: rows with the columns `problem`, `method`, `cost` and `success`. A run that succeeded without a
    known cost is left out. NaN where a method never ran; see `comparable`.
    """
    solved = runs[success].fillna(False).astype(bool)
    paid = pd.to_numeric(runs[cost]).astype(float).where(solved, np.inf)
    table = runs[["problem", "method"]].assign(cost=paid).dropna()
    return table.pivot_table(index="problem", columns="method", values="cost", aggfunc="median", sort=False)


def comparable(costs: pd.DataFrame) -> pd.DataFrame:
    """The methods and problems that can be compared: every method here was tried on every problem here.

    Methods tried on the fewest problems are left out as long as that leaves more pairs of method and problem.
    """
    best, rest = costs.dropna(), costs
    while rest.shape[1] > 1:
        rest = rest.drop(columns=rest.notna().sum().idxmin())
        if rest.dropna().size > best.size:
            best = rest.dropna()
    return best
