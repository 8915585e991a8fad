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


@final
@dataclass(frozen=True)
class Fatrop(Solver):
    """Interior-point method with a stage-wise Riccati factorisation (Vanroye et al. 2023, arXiv:2303.16746).

    The problem is brought into stages first (see `benchbench.nlp.stages`), with copies of durations and of the
    next node. `options` are FATROP's own and win. It has no time limit, and its search for a direction may not end (it raises the
    dual regularisation of a rank-deficient Jacobian no further), so that each solve has a process of its own.
    """

    options: dict[str, Any] = field(default_factory=dict)

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        """Put into stages, assemble, solve there, read back."""
        staged = stages(mpcc)
        options = {"fatrop": self.native_options(setup)}
        solve = casadi_nlp.prepare(
            Backend("fatrop", CLAIMS, staged.reorder, _structure(staged), timed=False),
            staged.mpcc,
            setup,
            options,
        )

        def through(sigma: float, start: Point) -> Outcome:
            outcome = solve_apart(partial(solve, sigma), staged.there(start), setup.seconds)
            return replace(outcome, point=staged.back(outcome.point))

        return through

    def native_options(self, setup: Setup) -> dict[str, Any]:
        """FATROP's tol and max_iter; a rank tolerance above its default, with which it looped for ever."""
        own = {
            "tol": TOLERANCE[setup.accuracy],
            "max_iter": setup.iterations,
            "linsol_lu_fact_tol": 1e-4,
            "print_level": 0,
        }
        return own | self.options

    def version(self) -> str:
        """CasADi's version names the bundled FATROP."""
        return casadi_nlp.version("fatrop")


def _structure(staged: Staged) -> dict[str, Any]:
    return {
        "structure_detection": "manual", "N": len(staged.states) - 1,
        "nx": list(staged.states), "nu": list(staged.inputs), "ng": list(staged.path),
    }  # fmt: skip
