"""From rows of the table to costs per problem and method."""

from __future__ import annotations

import numpy as np
import pandas as pd


def cost_matrix(runs: pd.DataFrame, cost: str, success: str = "certified") -> pd.DataFrame:
    """Costs (problems x methods): the median over repeats, a failed run costing infinity.

    runs: rows with the columns `problem`, `method`, `cost` and `success`. A run that succeeded without a
    known cost is left out. NaN where a method never ran; see `run_by_all`.
    """
    solved = runs[success].fillna(False).astype(bool)
    paid = pd.to_numeric(runs[cost]).astype(float).where(solved, np.inf)
    table = runs[["problem", "method"]].assign(cost=paid).dropna()
    return table.pivot_table(index="problem", columns="method", values="cost", aggfunc="median", sort=False)


def run_by_all(costs: pd.DataFrame) -> pd.DataFrame:
    """Only the problems that every method was tried on: others would compare different sets."""
    return costs.dropna()
