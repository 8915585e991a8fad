"""The MPCC as a plain nonlinear program, without any relaxation."""

from __future__ import annotations

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import PairKind
from benchbench.nlp.relaxation import Gap, Relaxation, Relaxed


@final
@dataclass(frozen=True)
class Direct(Relaxation):
    """G >= 0, H >= 0, G H <= 0; for vanishing pairs G >= 0, G H <= 0 (Achtziger & Kanzow 2008). No sigma.

    On our scaled contact conditions this is the clean form: epsilon h <= 0 with h = (gap / limit)^2 - 1.
    """

    schedule: tuple[float, ...] = (0.0,)
    kinds: ClassVar[tuple[PairKind, ...]] = ("complementarity", "vanishing")
    power: ClassVar[float] = 0.0

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, gap: Gap | None) -> Relaxed:
        """Row G H."""
        return Relaxed(g * h, (-np.inf,), (0.0,))
