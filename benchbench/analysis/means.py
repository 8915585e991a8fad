"""Shifted geometric means, with failures counted in three ways since no single one is fair."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from benchbench.ground.arrays import Array


@dataclass(frozen=True)
class Means:
    """Shifted geometric means of one method; None where there is nothing to average.

    own        over the problems this method solved: flatters one that solves only the easy ones
    common     over the problems that every method solved: fair, but blind to failures
    penalised  over all problems, a failure at the price of `penalty`
    """

    own: float | None
    common: float | None
    penalised: float | None


def shifted_geometric_mean(values: Array, shift: float) -> float | None:
    """Return exp(mean(log(values + shift))) - shift; None for no values (Achterberg 2007, app. A).

    The shift (same unit) keeps values far below it from deciding. Raises ValueError for a value <= -shift.
    """
    values = np.asarray(values, float)
    if not (values + shift > 0).all():
        raise ValueError(f"every value must be above -shift = {-shift:g}")
    return float(np.exp(np.mean(np.log(values + shift))) - shift) if values.size else None


def three_means(costs: pd.DataFrame, shift: float, penalty: float) -> dict[str, Means]:
    """Means of each method over costs (problems x methods), infinite where a method failed."""
    values = costs.to_numpy(float).T
    common = np.isfinite(values).all(axis=0)
    return {
        str(method): Means(
            shifted_geometric_mean(paid[np.isfinite(paid)], shift),
            shifted_geometric_mean(paid[common], shift),
            shifted_geometric_mean(np.minimum(paid, penalty), shift),
        )
        for method, paid in zip(costs.columns, values, strict=True)
    }
