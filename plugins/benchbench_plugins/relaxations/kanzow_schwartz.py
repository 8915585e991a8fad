"""Kanzow and Schwartz' relaxation."""

from __future__ import annotations

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import PairKind
from benchbench.nlp.relaxation import Gap, Relaxation, Relaxed, Schedule


@final
@dataclass(frozen=True)
class KanzowSchwartz(Relaxation):
    """G, H >= 0 and phi(G - sigma, H - sigma) <= 0 (Kanzow & Schwartz 2013, doi:10.1137/100802487).

    phi(a, b) = a b where a + b >= 0, else -(a^2 + b^2) / 2: negative where either is. Allowed is
    min(G, H) <= sigma, an L with arms sigma wide; phi is once continuously differentiable. The same row
    serves vanishing pairs (Hoheisel, Kanzow & Schwartz 2012, Optimization 61): H may have any sign.
    """

    # First: at 0.1 the handover trades the contact away. Last: the certificate allows min(G, H) of 1e-6.
    schedule: Schedule = (1e-2, 1e-4, 1e-6)
    kinds: ClassVar[tuple[PairKind, ...]] = ("complementarity", "vanishing")

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, gap: Gap | None) -> Relaxed:
        """Row phi."""
        a, b = g - sigma, h - sigma
        return Relaxed(ca.if_else(a + b >= 0, a * b, -(a**2 + b**2) / 2), (-np.inf,), (0.0,))
