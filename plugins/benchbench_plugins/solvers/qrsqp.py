"""CasADi's compact SQP method on its sparse QR active-set QP solver."""

from __future__ import annotations

from dataclasses import field
from typing import Any, final

from pydantic.dataclasses import dataclass

from benchbench.ground.errors import IncompatibleCase
from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.solver import TOLERANCE, Claim, Prepared, Setup, Solver
from benchbench_plugins.solvers import casadi_nlp
from benchbench_plugins.solvers.casadi_nlp import Backend

CLAIMS: dict[str, Claim] = {
    "Solve_Succeeded": "solved",
    "Maximum_Iterations_Exceeded": "iteration_limit",
    "Search_Direction_Becomes_Too_Small": "failed",
}


@final
@dataclass(frozen=True)
class Qrsqp(Solver):
    """Line-search SQP with a sparse QR active-set QP (Andersson & Rawlings 2018, IFAC-PapersOnLine 51(20)).

    `options` are those of CasADi's qrsqp. Its QP solver refactorises at each change of the active set and
    hears no time limit: problems with more than `max_unknowns` are refused (2067 unknowns: no iterate in 200 s).
    """

    max_unknowns: int = 1000
    options: dict[str, Any] = field(default_factory=dict)

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        """Assemble and build. Raises IncompatibleCase for a problem that is too large."""
        if mpcc.size > self.max_unknowns:
            problem = f"qrsqp cannot be stopped inside a QP, and this problem has {mpcc.size} unknowns"
            raise IncompatibleCase(
                "solver", problem, f"up to solver.max_unknowns={self.max_unknowns}, or ipopt"
            )
        return casadi_nlp.prepare(
            Backend("qrsqp", CLAIMS, watched=True, timed=False), mpcc, setup, self.native_options(setup)
        )

    def native_options(self, setup: Setup) -> dict[str, Any]:
        """tol_pr, tol_du and max_iter of qrsqp; time is watched from outside."""
        tolerance = TOLERANCE[setup.accuracy]
        own = {
            "tol_pr": tolerance,
            "tol_du": tolerance,
            "max_iter": setup.iterations,
            "regularize": True,
            "qpsol_options": {"print_iter": False, "print_header": False, "error_on_fail": False},
            "print_header": False,
            "print_iteration": False,
        }
        return own | self.options

    def version(self) -> str:
        """CasADi's version."""
        return casadi_nlp.version("qrsqp")
