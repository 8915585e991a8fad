"""No relaxation: the pairs go to a solver that takes them."""

from __future__ import annotations

from typing import ClassVar, final

import casadi as ca
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import PairKind
from benchbench.nlp.relaxation import Gap, Relaxation, Relaxed


@final
@dataclass(frozen=True)
class NoRelaxation(Relaxation):
    """Leaves 0 <= G, H >= 0, G H = 0 to the solver, in one solve; vanishing pairs get the slack form first.

    Only for solvers with `native_pairs`; the others refuse the case. No sigma.
    """

    schedule = (0.0,)
    power: ClassVar[float] = 0.0

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, gap: Gap | None) -> Relaxed:
        """The pair itself."""
        return Relaxed(ca.SX(0, 1), (), (), pairs=((g, h),), signs=False)
