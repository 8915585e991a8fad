"""Elastic mode: the relaxation parameter of another relaxation becomes an unknown with a price."""

from __future__ import annotations

from dataclasses import replace
from typing import final

import casadi as ca
from pydantic import ConfigDict, Field
from pydantic.dataclasses import dataclass

from benchbench.ground.errors import BadInput
from benchbench.mpcc.problem import PairKind
from benchbench.nlp.relaxation import Gap, Relaxation, Relaxed, Schedule, Shared

T = ca.SX.sym("elastic")


@final
@dataclass(frozen=True, config=ConfigDict(arbitrary_types_allowed=True))
class Elastic(Relaxation):
    """The rows of `inner` with one unknown t in [0, `largest`] for its sigma, and the cost t / sigma.

    With Scholtes inside: G H <= t for all pairs (Anitescu 2005, doi:10.1137/S1052623402401221; l-infinity
    steering in Nurkanovic, Pozharskiy & Diehl 2024, doi:10.1007/s10013-024-00704-z). 1 / sigma is the
    penalty parameter: once it exceeds the sum of the multipliers, t is zero.
    """

    inner: Relaxation
    schedule: Schedule = (1.0, 1e-2, 1e-4)
    largest: float = Field(default=10.0, gt=0)

    def __post_init__(self) -> None:
        """Take over the kinds of the inner relaxation."""
        object.__setattr__(self, "kinds", self.inner.kinds)

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, gap: Gap | None) -> Relaxed:
        """Rows of the inner relaxation; raises BadInput when they do not depend on its sigma."""
        seen = self.inner.relax(g, h, T, kind, gap)
        if not ca.depends_on(seen.rows, T) or ca.depends_on(seen.cost, T) or seen.shared:
            raise BadInput(
                "relaxation.inner", "has no row with a sigma to steer", "scholtes or another relaxation"
            )
        return replace(seen, shared=(Shared(T, 0.0, self.largest, self.largest / 10, T / sigma),))
