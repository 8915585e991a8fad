"""The smooth minimum of a pair, at most zero."""

from __future__ import annotations

from typing import final

import casadi as ca
from pydantic.dataclasses import dataclass

import benchbench as bb


@final
@dataclass(frozen=True)
class SoftMinimum(bb.Relaxation):
    """-sigma log(exp(-G/sigma) + exp(-H/sigma)) <= 0 (Chen & Mangasarian 1996, doi:10.1007/BF00249052)."""

    schedule: tuple[float, ...] = (1e-2, 1e-4, 1e-6)

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: bb.PairKind, gap: bb.Gap | None) -> bb.Relaxed:
        """Row min(G, H) - sigma log(1 + exp(-|G - H| / sigma)), which is the formula without overflow."""
        row = ca.fmin(g, h) - sigma * ca.log1p(ca.exp(-ca.fabs(g - h) / sigma))
        return bb.Relaxed(row, (-ca.inf,), (0.0,))
