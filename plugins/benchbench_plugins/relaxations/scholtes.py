"""Scholtes' global regularisation."""

from __future__ import annotations

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import PairKind
from benchbench.nlp.relaxation import Gap, Relaxation, Relaxed, Schedule


@final
@dataclass(frozen=True)
class Scholtes(Relaxation):
    """G >= 0, H >= 0, G H <= sigma (Scholtes 2001, doi:10.1137/S1052623499361233).

    sigma bounds the product; vanishing pairs become G >= 0, G H <= sigma (Izmailov & Solodov 2009).
    """

    # Last: an unmet condition is then worth less than a millionth of a step. Smaller values only cost iterations.
    schedule: Schedule = (1e-2, 1e-4, 1e-7)
    kinds: ClassVar[tuple[PairKind, ...]] = ("complementarity", "vanishing")

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, gap: Gap | None) -> Relaxed:
        """Row G H - sigma."""
        return Relaxed(g * h - sigma, (-np.inf,), (0.0,))
