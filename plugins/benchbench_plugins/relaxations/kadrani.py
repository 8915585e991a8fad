"""Relaxation of Kadrani, Dussault and Benchakroun."""

from __future__ import annotations

from typing import final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import PairKind
from benchbench.nlp.relaxation import Gap, Relaxation, Relaxed, Schedule


@final
@dataclass(frozen=True)
class Kadrani(Relaxation):
    """G, H >= -sigma and (G - sigma)(H - sigma) <= 0 (Kadrani et al. 2009, doi:10.1137/070705490).

    The axes become two strips of width 2 sigma that touch in one point, (sigma, sigma); the solution itself is
    cut off where both are zero. A vanishing pair loses G = 0, H < 0 in this form, so it gets the slack form.
    """

    # First: from 0.1 the handovers took half as many iterations again. Last: G and H may be negative by as much as
    # sigma, and the certificate allows 1e-6.
    schedule: Schedule = (1e-3, 1e-6)

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, gap: Gap | None) -> Relaxed:
        """The two bounds and the product of the distances to sigma."""
        rows = ca.vertcat(g + sigma, h + sigma, (g - sigma) * (h - sigma))
        return Relaxed(rows, (0.0, 0.0, -np.inf), (np.inf, np.inf, 0.0), signs=False)
