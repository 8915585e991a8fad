"""The smoothed penalised Fischer-Burmeister function."""

from __future__ import annotations

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import PairKind
from benchbench.nlp.relaxation import Gap, Relaxation, Relaxed, Schedule


@final
@dataclass(frozen=True)
class ChenChenKanzow(Relaxation):
    """G, H >= 0 and w (G + H - sqrt(G^2 + H^2 + 2 sigma^2)) + (1 - w) (G H - sigma^2) <= 0, w = `weight`.

    Chen, Chen & Kanzow 2000, doi:10.1007/PL00011375, smoothed, <= instead of = (docs/relaxations.md). Both
    terms have the sign of G H - sigma^2, so the set is G H <= sigma^2, and the gradient does not flatten out
    where G and H are large. sigma is the radius of the rounded corner. Vanishing pairs: G >= 0 and the same
    row, H of any sign.
    """

    # Last: sigma^2 = 9e-8, as for scholtes.
    schedule: Schedule = (3e-2, 3e-4)
    kinds: ClassVar[tuple[PairKind, ...]] = ("complementarity", "vanishing")
    weight: float = Field(default=0.5, gt=0, le=1)
    power: ClassVar[float] = 2.0

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, gap: Gap | None) -> Relaxed:
        """Row of both terms."""
        burmeister = g + h - ca.sqrt(g**2 + h**2 + 2 * sigma**2)
        row = self.weight * burmeister + (1 - self.weight) * (g * h - sigma**2)
        return Relaxed(row, (-np.inf,), (0.0,))
