"""Complementarity held on its central path."""

from __future__ import annotations

from typing import final

import casadi as ca
from pydantic.dataclasses import dataclass

from benchbench.mpcc import PairKind
from benchbench.relaxation import Relaxation, Relaxed


@final
@dataclass(frozen=True)
class CentralPath(Relaxation):
    """G >= 0, H >= 0, G H = sigma (Luo, Pang & Ralph 1996, doi:10.1017/CBO9780511983658)."""

    schedule: tuple[float, ...] = (1e-2, 1e-4, 1e-7)

    def relax(
        self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, name: str, limit: float | None
    ) -> Relaxed:
        """Row G H - sigma."""
        return Relaxed(g * h - sigma, (0.0,), (0.0,))
