"""Uno, which puts Lagrange-Newton methods together from parts."""

from __future__ import annotations

from dataclasses import field
from typing import Any, Literal, final

from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.solver import TOLERANCE, Claim, Prepared, Setup, Solver
from benchbench_plugins.solvers import casadi_nlp
from benchbench_plugins.solvers.casadi_nlp import Backend

CLAIMS: dict[str, Claim] = {
    "Converged with feasible KKT point": "solved",
    "Converged with feasible FJ point": "failed",
    "Converged with infeasible stationary point": "infeasible",
    "Terminated with feasible small step": "failed",
    "Terminated with infeasible small step": "infeasible",
    "Terminated with unbounded problem": "failed",
}


@final
@dataclass(frozen=True)
class Uno(Solver):
    """Unifying framework of Lagrange-Newton methods (Vanaret & Leyffer 2024, arXiv:2406.13454).

    preset "filtersqp": filter trust-region SQP with exact Hessians (Fletcher & Leyffer 1998);
    preset "ipopt": filter line-search interior-point method. `options` are Uno's own and win.
    """

    preset: Literal["filtersqp", "ipopt"] = "filtersqp"
    options: dict[str, Any] = field(default_factory=dict)

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        """Assemble and build."""
        return casadi_nlp.prepare(
            Backend("uno", CLAIMS, wall=False), mpcc, setup, {"uno": self.native_options(setup)}
        )

    def native_options(self, setup: Setup) -> dict[str, Any]:
        """Uno's primal_tolerance, dual_tolerance, max_iterations and time_limit."""
        tolerance = TOLERANCE[setup.accuracy]
        own = {
            "preset": self.preset,
            "primal_tolerance": tolerance,
            "dual_tolerance": tolerance,
            "max_iterations": setup.iterations,
            "time_limit": setup.seconds,
            "logger": "SILENT",
        }
        return own | self.options

    def version(self) -> str:
        """CasADi's version names the bundled Uno."""
        return casadi_nlp.version("uno")
