"""Steffensen and Ulbrich's local relaxation."""

from __future__ import annotations

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import PairKind
from benchbench.nlp.relaxation import Gap, Relaxation, Relaxed, Schedule


@final
@dataclass(frozen=True)
class SteffensenUlbrich(Relaxation):
    """G, H >= 0 and G + H <= |G - H|, rounded (Steffensen & Ulbrich 2010, doi:10.1137/090748883).

    Inside |G - H| < sigma the modulus is sigma theta(z), z = (G - H) / sigma, theta = (3 + 6 z^2 - z^4) / 8:
    exact but within sigma of the corner. The unrounded row says min(G, H) <= 0, which is what a vanishing
    pair wants for any sign of H (Hoheisel, Kanzow & Schwartz 2012, Optim. Methods Softw. 27).
    """

    # First: at 0.1 and more the handover loses its contact and is stuck in an infeasible point.
    # Last: away from the corner the row is exact for any sigma; below 1e-4 IPOPT stalls on the kink.
    schedule: Schedule = (1e-2, 1e-4)
    kinds: ClassVar[tuple[PairKind, ...]] = ("complementarity", "vanishing")
    power: ClassVar[float] = 2.0

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, gap: Gap | None) -> Relaxed:
        """Row G + H - |G - H|, rounded; theta meets the modulus with equal first and second derivatives."""
        z = (g - h) / sigma
        modulus = ca.if_else(ca.fabs(z) < 1, sigma * (3 + 6 * z**2 - z**4) / 8, ca.fabs(g - h))
        return Relaxed(g + h - modulus, (-np.inf,), (0.0,))
