"""Lin and Fukushima's two-inequality relaxation."""

from __future__ import annotations

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import PairKind
from benchbench.nlp.relaxation import Gap, Relaxation, Relaxed, Schedule


@final
@dataclass(frozen=True)
class LinFukushima(Relaxation):
    """G H <= sigma^2 and (G + sigma)(H + sigma) >= sigma^2 (Lin & Fukushima 2005, doi:10.1007/s10479-004-5024-z).

    Two hyperbolas, and no rows for the signs: both together imply G, H > -sigma. sigma^2 bounds the product.
    Vanishing pairs get the slack form.
    """

    # First: at 0.1 the handover flies past its contact. Last: G and H may be negative by as much as sigma, and the
    # certificate allows 1e-6.
    schedule: Schedule = (1e-2, 1e-3, 1e-6)
    power: ClassVar[float] = 2.0

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, gap: Gap | None) -> Relaxed:
        """Both hyperbolas, the second one multiplied out."""
        rows = ca.vertcat(g * h - sigma**2, g * h + sigma * (g + h))
        return Relaxed(rows, (-np.inf, 0.0), (0.0, np.inf), signs=False)
