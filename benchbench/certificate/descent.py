"""B-stationarity: whether the linearised MPCC has a descent direction, found by a mixed-integer program (HiGHS)."""

from __future__ import annotations

import time
from typing import Literal

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, OptimizeResult, milp
from scipy.sparse import csr_array, diags_array, hstack, vstack

from benchbench.certificate.linearised import Tangent
from benchbench.ground.arrays import Array

Answer = Literal["yes", "no", "undecided"]


def b_stationary(tangent: Tangent, tolerance: float, deadline: float) -> Answer:
    """Tell whether no direction of the linearised cone lowers the cost.

    min grad f d / scale over |d_j| <= 1, a_i d >= 0 or <= 0 as active, and for a biactive pair
    0 <= G' d, 0 <= H' d, one of them 0 (vanishing: 0 <= G' d, and G' d = 0 or H' d <= 0), with one binary a
    pair (Ralph & Wright 2004; Kazi, Thombre & Biegler 2024). The cone is homogeneous and its gradients have
    length one, so the trust region only scales. scale = |grad f|_1, at least 1: `tolerance` is the decrease.

    "yes" is always right to first order. A descent direction of the linearised cone leads into the feasible
    set where MPCC-LICQ holds or nothing active is curved; otherwise, and past the deadline (of time.perf_counter): "undecided".
    """
    if time.perf_counter() > deadline:
        return "undecided"
    found = _solve(tangent, None, deadline)
    if found.x is None:
        return "undecided"
    scale = max(1.0, float(np.sum(np.abs(tangent.gradient))))
    if found.status == 0 and found.fun / scale >= -tolerance:
        return "yes"
    # Binaries may be 1e-6 off, which lets G' d and H' d both be positive: descend on the branch itself.
    branch = found.x[len(tangent.gradient) :] > 0.5
    exact = _solve(tangent, branch, deadline)
    if exact.x is None or exact.fun / scale >= -tolerance:
        return "undecided"
    if tangent.affine:
        return "no"
    late = time.perf_counter() > deadline  # a rank takes seconds
    return "no" if not late and tangent.independent else "undecided"


def _solve(tangent: Tangent, branch: Array | None, deadline: float) -> OptimizeResult:
    """The program in (d, y); y = 1 allows G' d > 0, y = 0 allows H' d > 0. `branch` fixes y."""
    n, k = len(tangent.gradient), len(tangent.biactive)
    low = np.where(tangent.floor, 0.0, -np.inf)
    high = np.where(tangent.roof, 0.0, np.inf)
    g, h = tangent.biactive.T
    low[g] = 0.0
    low[h] = np.where(tangent.vanishing, -np.inf, 0.0)
    most = np.asarray(abs(tangent.rows).sum(axis=1)).ravel()  # the largest a_i d in the trust region
    rise_g = hstack([tangent.rows[g], diags_array(-most[g])])  # G' d - most y <= 0
    rise_h = hstack([tangent.rows[h], diags_array(most[h])])  # H' d + most y <= most
    none = csr_array((len(low), k))
    rows = csr_array(vstack([hstack([tangent.rows, none]), rise_g, rise_h], format="csr"))
    low = np.concatenate([low, np.full(2 * k, -np.inf)])
    high = np.concatenate([high, np.zeros(k), most[h]])
    y = (np.zeros(k), np.ones(k)) if branch is None else (branch.astype(float),) * 2
    return milp(
        np.concatenate([tangent.gradient, np.zeros(k)]),
        integrality=np.concatenate([np.zeros(n), np.ones(k)]),
        bounds=Bounds(np.concatenate([-np.ones(n), y[0]]), np.concatenate([np.ones(n), y[1]])),
        constraints=LinearConstraint(rows, low, high),
        options={"time_limit": max(0.0, deadline - time.perf_counter())},
    )
