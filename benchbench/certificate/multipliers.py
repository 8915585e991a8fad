"""Multipliers of an MPCC at a point, re-estimated from its gradients, and the stationarity class they prove."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csc_array, hstack, vstack

from benchbench.certificate.linearised import Tangent
from benchbench.ground.arrays import Array

Kind = Literal["S", "M", "C", "W", "none", "undecided"]
Side = tuple[float, float, float, float]
"""Bounds of the two multipliers of a biactive pair: lower and upper of G's, lower and upper of H's."""

FREE, POSITIVE, NEGATIVE, ZERO = (-np.inf, np.inf), (0.0, np.inf), (-np.inf, 0.0), (0.0, 0.0)
OPTIMAL = 0
"""Status of scipy's milp."""
SIDES: dict[Kind, tuple[Side, ...]] = {
    "W": ((*FREE, *FREE),),
    "S": ((*POSITIVE, *POSITIVE),),
    "M": ((*POSITIVE, *POSITIVE), (*ZERO, *FREE), (*FREE, *ZERO)),
    "C": ((*POSITIVE, *POSITIVE), (*NEGATIVE, *NEGATIVE)),
}
"""What each class allows a biactive pair; with several ways they may differ from pair to pair."""


class Unsettled(Exception):
    """No multipliers were found in time."""


@dataclass(frozen=True)
class Multipliers:
    """Bounded multipliers for which grad f - sum of lambda_i a_i is smallest.

    residual  largest component of what is left, over max(1, |grad f|)
    values    (m,) multipliers of the tangent's rows

    The largest component is what is minimised. Bounded least squares (scipy's lsq_linear, sparse) took 30 times
    as long on NOSBENCH problems and stopped at 5e-6 where 3e-7 is possible.
    """

    residual: float
    values: Array


def weak(tangent: Tangent, deadline: float) -> Multipliers:
    """Multipliers of weak stationarity: those of biactive pairs have any sign. Raises Unsettled past the deadline."""
    return _fit(tangent, _sides(tangent, "W"), deadline)


def classify(tangent: Tangent, tolerance: float, deadline: float) -> Kind:
    """Return the strongest class whose multipliers leave at most `tolerance`.

    Multipliers need not be unique, so for M and C the signs are searched, pair by pair, depth first. Past the
    deadline (of time.perf_counter) the answer is "undecided".
    """
    try:
        if weak(tangent, deadline).residual > tolerance:
            return "none"
        if _fit(tangent, _sides(tangent, "S"), deadline).residual <= tolerance:
            return "S"
        for kind in ("M", "C"):
            if _search(tangent, kind, {}, tolerance, deadline):
                return kind
    except Unsettled:
        return "undecided"
    return "W"


def _search(tangent: Tangent, kind: Kind, chosen: dict[int, Side], tolerance: float, deadline: float) -> bool:
    """Whether the pairs not yet `chosen` have sides such that multipliers of this class exist."""
    sides = _sides(tangent, "W")
    for pair, side in chosen.items():
        sides[pair] = _meet(side, sides[pair])
    found = _fit(tangent, sides, deadline)
    if found.residual > tolerance:
        return False
    worst = _worst(tangent, kind, found.values)
    if worst is None:
        return True
    return any(_search(tangent, kind, {**chosen, worst: side}, tolerance, deadline) for side in SIDES[kind])


def _worst(tangent: Tangent, kind: Kind, values: Array) -> int | None:
    """The pair whose multipliers are farthest from every side that the class allows; None: all fit."""
    far = [
        min(max(low_g - g, g - high_g, low_h - h, h - high_h) for low_g, high_g, low_h, high_h in SIDES[kind])
        for g, h in values[tangent.biactive]
    ]
    return int(np.argmax(far)) if far and max(far) > 0.0 else None


def _sides(tangent: Tangent, kind: Kind) -> list[Side]:
    """One side for all biactive pairs; H of a vanishing pair has no positive multiplier (see `stationarity`)."""
    side = SIDES[kind][0]
    return [_meet(side, (*FREE, *NEGATIVE)) if v else side for v in tangent.vanishing]


def _meet(a: Side, b: Side) -> Side:
    return (max(a[0], b[0]), min(a[1], b[1]), max(a[2], b[2]), min(a[3], b[3]))


def _fit(tangent: Tangent, sides: list[Side], deadline: float) -> Multipliers:
    low = np.where(tangent.roof, -np.inf, 0.0)
    high = np.where(tangent.floor, np.inf, 0.0)
    for (g, h), (low_g, high_g, low_h, high_h) in zip(tangent.biactive, sides, strict=True):
        low[[g, h]], high[[g, h]] = (low_g, low_h), (high_g, high_h)
    open_ = low < high
    values = np.zeros(len(low))
    if open_.any():
        matrix = csc_array(tangent.rows[np.flatnonzero(open_)].T)
        values[open_] = _solve(matrix, tangent.gradient, low[open_], high[open_], deadline)
    left = tangent.gradient - tangent.rows.T @ values
    scale = max(1.0, float(np.max(np.abs(tangent.gradient), initial=0.0)))
    return Multipliers(float(np.max(np.abs(left), initial=0.0)) / scale, values)


def _solve(matrix: csc_array, target: Array, low: Array, high: Array, deadline: float) -> Array:
    """Minimise the largest component of target - matrix @ values, a linear program, with HiGHS. Raises Unsettled."""
    left = deadline - time.perf_counter()
    if left <= 0.0:
        raise Unsettled
    n, k = matrix.shape
    edge = csc_array(np.ones((n, 1)))
    rows = csc_array(vstack([hstack([matrix, edge]), hstack([-matrix, edge])], format="csc"))
    bounds = Bounds(np.append(low, 0.0), np.append(high, np.inf))
    above = LinearConstraint(rows, np.concatenate([target, -target]), np.inf)
    found = milp(np.append(np.zeros(k), 1.0), bounds=bounds, constraints=above, options={"time_limit": left})
    if found.x is None or found.status != OPTIMAL:
        raise Unsettled
    return np.asarray(np.clip(found.x[:k], low, high))
