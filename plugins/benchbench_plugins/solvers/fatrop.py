"""FATROP, with the stage structure it needs."""

from __future__ import annotations

from dataclasses import field, replace
from functools import partial
from typing import Any, final

from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.solver import TOLERANCE, Claim, Outcome, Point, Prepared, Setup, Solver
from benchbench.nlp.stages import Staged, stages
from benchbench_plugins.solvers import casadi_nlp
from benchbench_plugins.solvers.apart import solve_apart
from benchbench_plugins.solvers.casadi_nlp import Backend

CLAIMS: dict[str, Claim] = {"0": "solved", "1": "failed", "-1": "failed"}
RANK = 1e-4
"""Pivots below this share count as zero; above FATROP's own, with which more searches for a direction did not end."""
COARSER = 1e-3
"""The same for a second try: it ends where the first does not (circle, N = 25), and takes more iterations elsewhere."""


@final
@dataclass(frozen=True)
class Fatrop(Solver):
    """Interior-point method with a stage-wise Riccati factorisation (Vanroye et al. 2023, arXiv:2303.16746).

    The problem is brought into stages first (see `benchbench.nlp.stages`), with copies of durations and of the
    next node. `options` are FATROP's own and win. It has no time limit, and its search for a direction may not end (it raises the
    dual regularisation of a rank-deficient Jacobian no further), so that each solve has a process of its own. One that has not
    ended after a tenth of the time, at least 10 s, is tried again with a coarser rank tolerance, where `options` name none.
    """

    options: dict[str, Any] = field(default_factory=dict)

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        """Put into stages, assemble, solve there, read back."""
        staged = stages(mpcc)
        solve = self._assembled(staged, setup, self.native_options(setup))
        chosen = "linsol_lu_fact_tol" in self.options
        patience = setup.seconds if chosen else min(setup.seconds, max(0.1 * setup.seconds, 10.0))

        def through(sigma: float, start: Point) -> Outcome:
            there = staged.there(start)
            outcome = solve_apart(partial(solve, sigma), there, patience)
            if outcome.claim == "time_limit" and patience < setup.seconds:
                coarser = self.native_options(setup) | {"linsol_lu_fact_tol": COARSER}
                second = self._assembled(staged, setup, coarser)  # rarely needed, so not built before
                again = solve_apart(partial(second, sigma), there, setup.seconds - patience)
                outcome = replace(again, cpu_s=outcome.cpu_s + again.cpu_s)
            return replace(outcome, point=staged.back(outcome.point))

        return through

    @staticmethod
    def _assembled(staged: Staged, setup: Setup, options: dict[str, Any]) -> Prepared:
        backend = Backend("fatrop", CLAIMS, staged.reorder, _structure(staged), timed=False)
        return casadi_nlp.prepare(backend, staged.mpcc, setup, {"fatrop": options})

    def native_options(self, setup: Setup) -> dict[str, Any]:
        """FATROP's tol and max_iter, and the rank tolerance of the first try."""
        own = {
            "tol": TOLERANCE[setup.accuracy], "max_iter": setup.iterations, "linsol_lu_fact_tol": RANK, "print_level": 0,
        }  # fmt: skip
        return own | self.options

    def version(self) -> str:
        """CasADi's version names the bundled FATROP."""
        return casadi_nlp.version("fatrop")


def _structure(staged: Staged) -> dict[str, Any]:
    return {
        "structure_detection": "manual", "N": len(staged.states) - 1,
        "nx": list(staged.states), "nu": list(staged.inputs), "ng": list(staged.path),
    }  # fmt: skip
