"""Flying a plan interval by interval with scipy's DOP853, which has the last word where the flight at once is not found."""

from __future__ import annotations

from collections.abc import Callable, Collection

import numpy as np

from benchbench.certificate.pieces import slope
from benchbench.ground.arrays import Array
from benchbench.ocp.model import Plant
from benchbench.ocp.plan import Plan, bezier

EVALUATIONS = 5000
"""Evaluations allowed at once, plus ALLOWANCE per interval; a smooth interval takes 15 to 40."""
ALLOWANCE = 100


def ends(plan: Plan, plant: Plant, tolerance: float, far: float) -> Array:
    """States (N, n) at the ends of all intervals, each from its planned state; NaN when any of them breaks down."""
    start = np.hstack([plan.configuration, plan.velocity])
    rate = _rate(plant, plan.configuration.shape[1], np.diff(plan.time)[:, None], plan.input_pieces)
    found = _integrate(rate, start[:-1].ravel(), np.ones(1), EVALUATIONS, tolerance, far)[0]
    return found.reshape(start[1:].shape)


def flight(
    plan: Plan, plant: Plant, fractions: Array, restarts: Collection[int], tolerance: float, far: float
) -> Array:
    """States (N, m, n) at increasing fractions (m,) in (0, 1] of each interval; NaN from a breakdown on."""
    planned = np.hstack([plan.configuration, plan.velocity])
    half, step, pieces = plan.configuration.shape[1], np.diff(plan.time), plan.input_pieces
    flown = np.full((plan.intervals, len(fractions), planned.shape[1]), np.nan)
    state = planned[0]
    budget = EVALUATIONS + ALLOWANCE * plan.intervals
    for k in range(plan.intervals):
        rate = _rate(plant, half, step[k], pieces[k])
        flown[k] = _integrate(rate, state, fractions, budget, tolerance, far)
        budget -= rate.calls
        state = planned[k + 1] if k + 1 in restarts else flown[k, -1]
        if not np.isfinite(flown[k]).all():
            break
    return flown


class _rate:  # noqa: N801  (used as a function)
    """d[q, v]/ds over intervals of length `step` s, with inputs by control points; counts its calls."""

    def __init__(self, plant: Plant, half: int, step: Array, points: Array) -> None:
        self.plant, self.half, self.step, self.points, self.calls = plant, half, step, points, 0

    def __call__(self, s: float, y: Array) -> Array:
        self.calls += 1
        state = y.reshape(*self.points.shape[:-2], -1)
        return (self.step * slope(self.plant, self.half, state, bezier(self.points, s))).ravel()


def _integrate(
    rate: Callable[[float, Array], Array],
    start: Array,
    fractions: Array,
    budget: int,
    tolerance: float,
    far: float,
) -> Array:
    """States (len(fractions), n) at increasing fractions in (0, 1]; NaN from a breakdown on."""
    from scipy.integrate import (
        DOP853,
    )  # a third of a second, which plans that are flown at once need not take

    found = np.full((len(fractions), len(start)), np.nan)
    done = 0
    with np.errstate(all="ignore"):
        solver = DOP853(rate, 0.0, start, 1.0, rtol=tolerance, atol=tolerance, first_step=1.0)
        while solver.status == "running" and solver.nfev < budget:
            solver.step()
            if str(solver.status) == "failed" or not np.max(np.abs(solver.y)) < far:
                break
            reached = int(np.searchsorted(fractions, solver.t, side="right"))
            if reached > done:
                found[done:reached] = solver.dense_output()(fractions[done:reached]).T
                done = reached
    return found
