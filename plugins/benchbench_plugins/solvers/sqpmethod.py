"""CasADi's own SQP method on any of its QP solvers."""

from __future__ import annotations

from dataclasses import field
from typing import Any, final

from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.solver import TOLERANCE, Claim, Prepared, Setup, Solver
from benchbench_plugins.solvers import casadi_nlp
from benchbench_plugins.solvers.casadi_nlp import Backend

CLAIMS: dict[str, Claim] = {
    "Solve_Succeeded": "solved",
    "Maximum_Iterations_Exceeded": "iteration_limit",
    "Search_Direction_Becomes_Too_Small": "failed",
}
QUIET = {"print_iter": False, "print_header": False, "print_info": False, "error_on_fail": False}


@final
@dataclass(frozen=True)
class Sqpmethod(Solver):
    """Line-search SQP with exact Hessians (Nocedal & Wright 2006, ch. 18, doi:10.1007/978-0-387-40065-5).

    `qpsol` is the QP plugin, `qpsol_options` its own options; `options` are those of CasADi's sqpmethod.
    The default is PIQP (Schwan et al. 2023, arXiv:2304.00290), the only one here that
    copes with our indefinite Hessians: 15 iterations and 0.13 s where the others ran out of time.
    """

    qpsol: str = "piqp"
    qpsol_options: dict[str, Any] = field(default_factory=dict)
    options: dict[str, Any] = field(default_factory=dict)

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        """Assemble and build."""
        return casadi_nlp.prepare(
            Backend("sqpmethod", CLAIMS, watched=True, timed=False), mpcc, setup, self.native_options(setup)
        )

    def native_options(self, setup: Setup) -> dict[str, Any]:
        """tol_pr, tol_du and max_iter of sqpmethod; time is watched from outside."""
        tolerance = TOLERANCE[setup.accuracy]
        quiet: dict[str, dict[str, Any]] = {
            "qrqp": QUIET,
            "osqp": {"osqp": {"verbose": False}},
            "qpoases": {"printLevel": "none"},
        }
        own = {
            "tol_pr": tolerance,
            "tol_du": tolerance,
            "max_iter": setup.iterations,
            "qpsol": self.qpsol,
            "qpsol_options": {"error_on_fail": False, **quiet.get(self.qpsol, {}), **self.qpsol_options},
            "print_header": False,
            "print_iteration": False,
            "print_status": False,
        }
        return own | self.options

    def version(self) -> str:
        """CasADi's version."""
        return casadi_nlp.version(f"sqpmethod with {self.qpsol}")
