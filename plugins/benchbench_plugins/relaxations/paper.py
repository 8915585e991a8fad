"""The paper's own mix of relaxations, kept faithful so that it can be judged."""

from __future__ import annotations

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import PairKind
from benchbench.nlp.relaxation import Gap, Relaxation, Relaxed, Unknown


@final
@dataclass(frozen=True)
class Paper(Relaxation):
    """Slack equality for the distance, fixed limits for the rest (paper Eq. 29, 31 and 33). No sigma.

    distances, in m: epsilon (gap - nu) = 0 with a new unknown nu in [0, limit];
    others:          epsilon gap <= limit, in physical units.
    Fractional epsilon passes both, so a "contact" may break every limit; the certificate shows it. Norms
    are smoothed by `smoothing` (relative to the limit), since their derivative at zero does not exist.
    Complementarity pairs without a physical gap: G >= 0, H >= 0, G H <= limit_product (Baumrucker 2008).
    """

    schedule: tuple[float, ...] = (0.0,)
    kinds: ClassVar[tuple[PairKind, ...]] = ("complementarity", "vanishing")
    accuracy: ClassVar[float] = 5e-2  # its limits stay as they are
    smoothing: float = 1e-3
    limit_product: float = 1e-2
    power: ClassVar[float] = 0.0

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, gap: Gap | None) -> Relaxed:
        """Rows as in the paper; h = (gap / limit)^2 - 1 gives the gap back."""
        if gap is None:
            return Relaxed(g * h, (-np.inf,), (self.limit_product,))
        size = gap.limit * ca.sqrt(ca.fmax(h + 1, 0) + self.smoothing**2)
        if gap.unit != "m":
            return Relaxed(g * size, (-np.inf,), (gap.limit,))
        nu = ca.SX.sym("nu")
        slack = Unknown(nu, 0.0, gap.limit, ca.SX(gap.limit))
        return Relaxed(g * (size - nu), (0.0,), (0.0,), unknowns=(slack,))
