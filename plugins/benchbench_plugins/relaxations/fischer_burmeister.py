"""The smoothed Fischer-Burmeister function."""

from __future__ import annotations

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import PairKind
from benchbench.nlp.relaxation import Gap, Relaxation, Relaxed, Schedule


@final
@dataclass(frozen=True)
class FischerBurmeister(Relaxation):
    """G, H >= 0 and G + H <= sqrt(G^2 + H^2 + 2 sigma^2), the same set as G H <= sigma^2.

    Kanzow 1996, doi:10.1137/S0895479894273134; for MPCCs Facchinei, Jiang & Qi 1999,
    doi:10.1007/s10107990015a, as an equation, which leaves out solutions of an MPCC (docs/relaxations.md).
    sigma is the radius of the rounded corner. Vanishing pairs: G >= 0 and the same row, H of any sign.
    """

    # Last: sigma^2 = 2.5e-7; at 3e-4 IPOPT needs five to ten times the iterations.
    schedule: Schedule = (1e-1, 5e-4)
    kinds: ClassVar[tuple[PairKind, ...]] = ("complementarity", "vanishing")
    power: ClassVar[float] = 2.0

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, gap: Gap | None) -> Relaxed:
        """Row G + H - root; the root's argument is at least 2 sigma^2."""
        row = g + h - ca.sqrt(g**2 + h**2 + 2 * sigma**2)
        return Relaxed(row, (-np.inf,), (0.0,))
