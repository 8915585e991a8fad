"""Stationarity of a point of any MPCC: KKT residual with re-estimated multipliers, W/C/M/S class, B-stationarity."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from benchbench.certificate.descent import Answer, b_stationary
from benchbench.certificate.linearised import Linearised
from benchbench.certificate.multipliers import Kind, Unsettled, classify, weak
from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.residuals import Residuals, residuals

TOLERANCE = 1e-6
"""KKT residual, and decrease along a direction, up to which a point counts as stationary."""
FEASIBLE = 1e-4
"""Largest violation and min(G, H) of a point that is worth to be classified."""
ACTIVE = (1e-8, 1e-6, 1e-5, 1e-4, 1e-3)
"""What counts as zero, tried one after the other: a relaxation leaves G = H = sqrt(sigma) where both vanish."""


@dataclass(frozen=True)
class Stationarity:
    """What is known to first order; every part may be undecided.

    kkt_residual  largest component of grad f - sum lambda_i a_i over max(1, |grad f|), multipliers re-estimated
    kind          strongest class proved, "none" when even weak stationarity fails
    b_stationary  whether the linearised problem has no descent direction
    active        what counted as zero
    """

    kkt_residual: float
    kind: Kind
    b_stationary: Answer
    active: float

    def record(self) -> dict[str, float | str]:
        """Columns of the record."""
        return {
            "kkt_residual": self.kkt_residual,
            "stationarity": self.kind,
            "b_stationary": self.b_stationary,
        }


def stationarity(mpcc: Mpcc, x: Array, seconds: float = 10.0) -> Stationarity:
    """Judge x (n,) by the gradients of the MPCC alone; no solver's multipliers are used.

    With grad f = sum lambda a over the active constraints, gamma and nu the multipliers of G and H of a pair:
    gamma = 0 where G > 0, nu = 0 where H > 0, and where both are zero (Scheel & Scholtes 2000,
    doi:10.1287/moor.25.1.1.15213; Ye 2005, doi:10.1016/j.jmaa.2004.10.032)

    W  nothing more    C  gamma nu >= 0    M  both positive, or one is zero    S  both >= 0

    Vanishing pairs G >= 0, G H <= 0 have conditions of their own (Hoheisel & Kanzow 2008,
    doi:10.1016/j.jmaa.2007.02.087): G > 0, H = 0 is the inequality H <= 0; G = 0, H > 0 the equation G = 0;
    G = 0, H < 0 the inequality G >= 0. Where both are zero nu <= 0 already for W, so that S means gamma >= 0,
    nu = 0, M means gamma nu = 0, and C is their T-stationarity (Dorsch, Shikhman & Stein 2012).
    They are those of the slack form s >= H, 0 <= G, s complementary, but for G = 0 > H, where the slack form
    with s = 0 would make the pair biactive and let gamma be negative.

    A bound or constraint that repeats the sign of an active pair counts once. What is zero is decided by the
    smallest of `ACTIVE`, from the point's own error on, that leaves a KKT residual within `TOLERANCE`; all is
    evaluated at the nearest point where that is exactly zero. Whole-number unknowns are taken as real.

    After `seconds` of wall time what is not known yet is undecided.
    """
    deadline = time.perf_counter() + seconds
    found = residuals(mpcc, x)
    if not _error(found) <= FEASIBLE:
        return Stationarity(np.nan, "undecided", "undecided", np.nan)
    local = Linearised(mpcc)
    try:
        for tolerance in [a for a in ACTIVE if a >= _error(found)] or ACTIVE[-1:]:
            active = local.active(x, tolerance)
            tangent = local.tangent(local.snapped(x, active), active)
            residual = weak(tangent, deadline).residual
            if residual <= TOLERANCE:
                break
    except Unsettled:
        return Stationarity(np.nan, "undecided", "undecided", tolerance)
    kind = classify(tangent, TOLERANCE, deadline)
    if kind == "S":
        return Stationarity(residual, kind, "yes", tolerance)  # S implies B
    return Stationarity(residual, kind, b_stationary(tangent, TOLERANCE, deadline), tolerance)


def _error(found: Residuals) -> float:
    return float(np.max([found.max_violation, found.max_complementarity]))
