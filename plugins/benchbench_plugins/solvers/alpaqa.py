"""alpaqa, a first-order augmented-Lagrangian method."""

from __future__ import annotations

from dataclasses import field
from typing import Any, final

from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.solver import TOLERANCE, Prepared, Setup, Solver
from benchbench_plugins.solvers import casadi_nlp
from benchbench_plugins.solvers.casadi_nlp import Backend


@final
@dataclass(frozen=True)
class Alpaqa(Solver):
    """Augmented Lagrangian with PANOC (Pas, Schuurmans & Patrinos 2022, doi:10.23919/ECC55457.2022.9838172).

    `options` are alpaqa's own ("alm...", "panoc...", "lbfgs...") and win. It reports no
    iterations, so calls of its gradient are counted.
    """

    options: dict[str, Any] = field(default_factory=dict)

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        """Assemble and build; it wants functions of its own, so the problem is expanded."""
        return casadi_nlp.prepare(Backend("alpaqa", {}), mpcc, setup, {"alpaqa": self.native_options(setup)})

    def native_options(self, setup: Setup) -> dict[str, Any]:
        """alm.tolerance, alm.dual_tolerance, alm.max_time; iterations limit the inner solver."""
        tolerance = TOLERANCE[setup.accuracy]
        own = {
            "alm.tolerance": tolerance,
            "alm.dual_tolerance": tolerance,
            "alm.max_time": f"{1e3 * setup.seconds:.0f}ms",
            "alm.max_iter": min(100, setup.iterations),
            "panoc.max_iter": setup.iterations,
            "lbfgs.memory": 20,
            "alm.print_interval": 0,
            "panoc.print_interval": 0,
        }
        return own | self.options

    def version(self) -> str:
        """CasADi's version names the bundled alpaqa."""
        return casadi_nlp.version("alpaqa")
