"""Any other nlpsol plugin of CasADi: those that need a licence or a library that the wheel does not have."""

from __future__ import annotations

from dataclasses import field
from typing import Any, final

from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.solver import TOLERANCE, Claim, Prepared, Setup, Solver
from benchbench_plugins.solvers import casadi_nlp
from benchbench_plugins.solvers.casadi_nlp import Backend
from benchbench_plugins.solvers.trial import require


@final
@dataclass(frozen=True)
class Nlpsol(Solver):
    """A CasADi plugin whose option names are given in YAML; it is tried in a child process before use.

    plugin      its name in CasADi
    reference   its paper
    remedy      what to do where it is missing
    section     name of the dict in which CasADi passes options on; "" where they are CasADi's own
    tolerances, iterations, seconds   the backend's names for the KKT residual and the two limits ("" if none)
    options     the backend's own, they win
    claims      what its status texts mean, where CasADi's unified status does not say it
    """

    plugin: str
    remedy: str
    reference: str = ""
    section: str = ""
    tolerances: tuple[str, ...] = ()
    iterations: str = ""
    seconds: str = ""
    options: dict[str, Any] = field(default_factory=dict)
    claims: dict[str, Claim] = field(default_factory=dict)

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        """Try it, then assemble and build. Raises Unavailable."""
        require(self.plugin, self._casadi(self.options), self.remedy)
        return casadi_nlp.prepare(
            Backend(self.plugin, self.claims), mpcc, setup, self._casadi(self.native_options(setup))
        )

    def native_options(self, setup: Setup) -> dict[str, Any]:
        """Return tolerance and limits under the names in the YAML."""
        own: dict[str, Any] = dict.fromkeys(self.tolerances, TOLERANCE[setup.accuracy])
        limits = {self.iterations: setup.iterations, self.seconds: setup.seconds}
        return own | {name: value for name, value in limits.items() if name} | self.options

    def version(self) -> str:
        """Name CasADi's version; plugins do not tell that of their library."""
        return casadi_nlp.version(self.plugin)

    def _casadi(self, options: dict[str, Any]) -> dict[str, Any]:
        return {self.section: options} if self.section else options
