"""A planted slow-down: IPOPT that solves everything twice and does not say so."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.solver import Outcome, Point, Prepared, Setup, Solver
from benchbench_plugins.solvers.ipopt import Ipopt


@dataclass(frozen=True)
class Slow(Solver):
    """Its outcome is that of one solve, times included."""

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        """Prepare IPOPT."""
        once = Ipopt().prepare(mpcc, setup)

        def solve(sigma: float, start: Point) -> Outcome:
            once(sigma, start)
            return once(sigma, start)

        return solve

    def native_options(self, setup: Setup) -> dict[str, Any]:
        """IPOPT's."""
        return Ipopt().native_options(setup)

    def version(self) -> str:
        """IPOPT's."""
        return Ipopt().version()
