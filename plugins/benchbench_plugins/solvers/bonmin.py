"""BONMIN: branch and bound, for progress variables that really are whole numbers."""

from __future__ import annotations

from dataclasses import field
from typing import Any, final

from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.solver import TOLERANCE, Claim, Prepared, Setup, Solver
from benchbench_plugins.solvers import casadi_nlp
from benchbench_plugins.solvers.casadi_nlp import Backend

CLAIMS: dict[str, Claim] = {
    "SUCCESS": "solved",
    "INFEASIBLE": "infeasible",
    "LIMIT_EXCEEDED": "time_limit",
    "CONTINUOUS_UNBOUNDED": "failed",
    "MINLP_ERROR": "failed",
    "USER_INTERRUPT": "failed",
}


@final
@dataclass(frozen=True)
class Bonmin(Solver):
    """NLP-based branch and bound over the integer unknowns (Bonami et al. 2008, doi:10.1016/j.disopt.2006.10.011).

    With relaxation=direct the progress variables decide each node's contact exactly: no fractions. Its
    optimum is global only for convex problems, ours are not. It wants minutes. `options` are BONMIN's (and IPOPT's) own.
    """

    options: dict[str, Any] = field(default_factory=dict)

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        """Assemble, with the integer unknowns marked."""
        backend = Backend(
            "bonmin",
            CLAIMS,
            fixed={
                "discrete": [bool(i) for i in mpcc.integer],
                "pass_nonlinear_variables": False,
                "pass_nonlinear_constraints": False,
            },
        )
        native = {"bonmin": self.native_options(setup)}
        return casadi_nlp.prepare_with_derivatives(backend, mpcc, setup, lambda _: native)

    def native_options(self, setup: Setup) -> dict[str, Any]:
        """IPOPT's tol and max_iter in each node, time_limit over all nodes."""
        own = {
            "tol": TOLERANCE[setup.accuracy],
            "max_iter": setup.iterations,
            "algorithm": "B-BB",
            "time_limit": setup.seconds,
            "mumps_pivot_order": 5,
            "bound_relax_factor": 0.0,
            "print_level": 0,
            "sb": "yes",
            "bb_log_level": 0,
            "nlp_log_level": 0,
        }
        return own | self.options

    def version(self) -> str:
        """CasADi's version names the bundled BONMIN."""
        return casadi_nlp.version("bonmin")
