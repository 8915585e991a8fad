"""Exact penalty on the products."""

from __future__ import annotations

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import PairKind
from benchbench.nlp.relaxation import Gap, Relaxation, Relaxed, Schedule, Unknown


@final
@dataclass(frozen=True)
class L1Penalty(Relaxation):
    """G, H >= 0 and the cost sum of max(G H, 0) / sigma; 1 / sigma is the penalty parameter.

    Ralph & Wright 2004, doi:10.1080/10556780410001709439; Leyffer, Lopez-Calva & Nocedal 2006,
    doi:10.1137/040621065. No constraint is relaxed: once 1 / sigma exceeds the multipliers, a solution is
    one of the MPCC itself. In vanishing pairs G H may be negative: an unknown e >= G H, e >= 0 replaces it.
    """

    # First: a smaller penalty leaves problems unbounded (ralph2: from 1 / sigma = 2 on it is not). Last: above the
    # multipliers of every problem tried; where there are none (scholtes4), min(G, H) = sigma.
    schedule: Schedule = (1e-2, 1e-4)
    kinds: ClassVar[tuple[PairKind, ...]] = ("complementarity", "vanishing")

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, gap: Gap | None) -> Relaxed:
        """The cost, with the row G H - e where H may be negative."""
        if kind == "complementarity":
            return Relaxed(ca.SX(0, 1), (), (), cost=g * h / sigma)
        e = ca.SX.sym("e")
        excess = Unknown(e, 0.0, np.inf, ca.fmax(g * h, 0))
        return Relaxed(g * h - e, (-np.inf,), (0.0,), cost=e / sigma, unknowns=(excess,))
