"""Any solver that Pyomo can reach: through an .nl file and CasADi, or an AMPL executable."""

from __future__ import annotations

from dataclasses import field
from importlib import metadata
from typing import Any, ClassVar, Literal, final

from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.solver import Claim, Prepared, Setup, Solver
from benchbench_plugins.solvers import ipopt, sleqp, uno
from benchbench_plugins.solvers.pyomo_backend_model import build, pyomo
from benchbench_plugins.solvers.pyomo_backend_run import by_casadi, by_executable

OWN: dict[str, tuple[Solver, dict[str, Claim]]] = {
    "ipopt": (ipopt.Ipopt(), ipopt.CLAIMS),
    "uno": (uno.Uno(), uno.CLAIMS),
    "sleqp": (sleqp.Sleqp(), sleqp.CLAIMS),
}
"""How accuracy and limits are said to each, and what each answers."""


@final
@dataclass(frozen=True)
class Pyomo(Solver):
    """The problem as a Pyomo model (Bynum et al. 2021, doi:10.1007/978-3-030-68928-5), with Pyomo's own MPEC support.

    Without `executable` the model goes through an .nl file into CasADi and its plugin `through`; sigma stays
    a parameter, so one file serves the whole homotopy. CasADi differentiates the whole problem as one scalar
    graph. With `executable`, the name or path of a solver that reads .nl files (ipopt, knitro, ...), Pyomo
    calls that; accuracy and limits are passed on to an "ipopt" only.

    It takes pairs as they are (relaxation=none): `mpec.simple_nonlinear` turns them into G H <= 0.
    `options` are the solver's own and win.
    """

    native_pairs: ClassVar[bool] = True

    through: Literal["ipopt", "uno", "sleqp"] = "ipopt"
    executable: str | None = None
    options: dict[str, Any] = field(default_factory=dict)

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        """Build the model, and for CasADi write and read the file. Raises Unavailable."""
        model = build(mpcc)
        if self.executable:
            return by_executable(model, self.executable, self.native_options(setup), setup.seconds)
        return by_casadi(model, self.through, OWN[self.through][1], self.native_options(setup))

    def native_options(self, setup: Setup) -> dict[str, Any]:
        """The options of `through`, or of an executable named ipopt: tol, max_iter, max_cpu_time."""
        own = OWN[self.through][0].native_options(setup)
        if self.executable:
            known = ("tol", "max_iter", "max_cpu_time", "bound_relax_factor", "mu_strategy")
            own = {k: own[k] for k in known if k in own} if self.executable.endswith("ipopt") else {}
        return own | self.options

    def version(self) -> str:
        """Versions of Pyomo and of what solves."""
        pyomo()
        behind = self.executable or f"{self.through} (casadi {metadata.version('casadi')})"
        return f"pyomo {metadata.version('pyomo')}, {behind}"
