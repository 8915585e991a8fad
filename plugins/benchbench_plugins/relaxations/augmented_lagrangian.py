"""Augmented Lagrangian for the products."""

from __future__ import annotations

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import PairKind
from benchbench.nlp.relaxation import Gap, Relaxation, Relaxed, Schedule, Unknown


@final
@dataclass(frozen=True)
class AugmentedLagrangian(Relaxation):
    """G, H >= 0, and G H <= 0 by multipliers (Izmailov, Solodov & Uskov 2012, doi:10.1137/120868359).

    G H <= e with the cost m e + e^2 / (2 sigma); after each solve m becomes m + e / sigma, kept in
    [0, `largest`] so that it cannot run away where there is no multiplier. 1 / sigma is the penalty parameter.
    Minimising over e alone gives e = max(G H, -sigma m): the Powell-Hestenes-Rockafellar function without its
    kink. The same for vanishing pairs.
    """

    # Each step multiplies the error of the multipliers by about sigma, so hundredths are few solves. Last: where there
    # are no multipliers (ralph1, scholtes4) the product only shrinks like sigma^(2/3).
    schedule: Schedule = (1e-1, 1e-3, 1e-5, 1e-7)
    kinds: ClassVar[tuple[PairKind, ...]] = ("complementarity", "vanishing")
    largest: float = Field(default=1e6, gt=0)

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, gap: Gap | None) -> Relaxed:
        """Row G H - e and the cost; the multiplier is held during a solve."""
        e, m = ca.SX.sym("e"), ca.SX.sym("m")
        excess = Unknown(e, -np.inf, np.inf, ca.fmax(g * h, 0))
        multiplier = Unknown(m, 0.0, self.largest, ca.SX(0), update=m + e / sigma)
        cost = m * e + e**2 / (2 * sigma)
        return Relaxed(g * h - e, (-np.inf,), (0.0,), cost=cost, unknowns=(excess, multiplier))
