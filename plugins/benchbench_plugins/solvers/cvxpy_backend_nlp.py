"""CVXPY's nonlinear interface: the problem in CVXPY's atoms, solved by IPOPT or Uno."""

from __future__ import annotations

import re
import tempfile
import time
import warnings
from collections.abc import Mapping
from dataclasses import field
from functools import cache
from importlib import metadata, util
from pathlib import Path
from typing import Any, Literal, final

import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.ground.errors import IncompatibleCase, Unavailable
from benchbench.mpcc.problem import Block, Mpcc, evaluate
from benchbench.nlp.solver import Claim, Outcome, Point, Prepared, Setup, Solver
from benchbench_plugins.solvers.cvxpy_backend_atoms import Atoms
from benchbench_plugins.solvers.cvxpy_backend_qp import cvxpy
from benchbench_plugins.solvers.ipopt import Ipopt
from benchbench_plugins.solvers.uno import Uno
from benchbench_plugins.solvers.walk import record

PACKAGES = {"IPOPT": "cyipopt", "UNO": "unopy"}
STATUS: Mapping[str, Claim] = {
    "optimal": "solved", "optimal_inaccurate": "solved", "infeasible": "infeasible",
    "user_limit": "iteration_limit",
}  # fmt: skip
"""CVXPY's words; its user_limit is the time's when the time is over."""


@final
@dataclass(frozen=True)
class CvxpyNlp(Solver):
    """Disciplined nonlinear programming (CVXPY 1.9): smooth atoms, exact derivatives, a nonlinear solver.

    `solver` is IPOPT (through cyipopt) or UNO (unopy), `options` are its own and win. Values used more than
    once become unknowns, so the program is ten times larger than ours, with the same solutions; its
    iterations are not comparable. CVXPY gives no multipliers, and has no smooth atom for min, max and abs.
    """

    solver: Literal["IPOPT", "UNO"] = "IPOPT"
    options: dict[str, Any] = field(default_factory=dict)

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        """Build for each sigma once. Raises Unavailable, and IncompatibleCase for a missing atom."""
        cvxpy()
        package = PACKAGES[self.solver]
        if util.find_spec(package) is None:
            raise Unavailable(f"solver 'cvxpy_nlp' needs {package}: pip install 'benchbench[cvxpy-nlp]'")
        built = cache(lambda sigma: _build(mpcc, sigma))
        moves = any(record(block.function).reads(2) for block in (*mpcc.costs, *mpcc.constraints))
        if not moves:
            built(0.0)

        def solve(sigma: float, start: Point) -> Outcome:
            if not all(np.all(np.isfinite(evaluate(b, mpcc, start.x, sigma))) for b in _blocks(mpcc)):
                detail = "not finite at the start, which CVXPY would move"
                return Outcome("invalid", start, np.nan, 0, 0, 0.0, detail)
            return _solve(built(sigma if moves else 0.0), self.solver, self.native_options(setup), start)

        return solve

    def native_options(self, setup: Setup) -> dict[str, Any]:
        """The options of our IPOPT or Uno, as CVXPY hands them on."""
        own = Ipopt().native_options(setup) if self.solver == "IPOPT" else Uno().native_options(setup)
        return own | self.options

    def version(self) -> str:
        """Versions of CVXPY and of the solver's Python package."""
        cvxpy()
        package = {"IPOPT": "cyipopt-wheels", "UNO": "unopy"}[self.solver]
        return f"cvxpy {metadata.version('cvxpy')}, {package} {metadata.version(package)}"


def _build(mpcc: Mpcc, sigma: float) -> Atoms:
    atoms = Atoms(mpcc, sigma)
    if not atoms.problem.is_dnlp():
        raise IncompatibleCase("solver", "the problem breaks CVXPY's rules for nonlinear programs", "ipopt")
    return atoms


def _blocks(mpcc: Mpcc) -> list[Block]:
    return [block for block in (*mpcc.costs, *mpcc.constraints) if block.instances]


def _solve(atoms: Atoms, solver: str, options: dict[str, Any], start: Point) -> Outcome:
    """Run CVXPY; after a failure it does not say where the solver ended, so the start is returned."""
    cp, problem = cvxpy(), atoms.problem
    atoms.start(start.x)
    began, cpu = time.perf_counter(), time.process_time()
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # advice on initial values
        log = Path(folder) / "ipopt.txt"
        file = {"output_file": str(log), "file_print_level": 5} if solver == "IPOPT" else {}
        try:
            problem.solve(solver=solver, nlp=True, **options, **file)
        except cp.SolverError:
            status, iterations = "solver_error", 0
        else:
            status, iterations = problem.status, problem.solver_stats.num_iters
        claim, evaluations, detail = STATUS.get(status, "failed"), 0, str(status)
        if status == "user_limit" and time.perf_counter() - began >= options.get("time_limit", np.inf):
            claim = "time_limit"
        if file:
            claim, iterations, evaluations, detail = _ipopt(log.read_text())
    found = status in ("optimal", "optimal_inaccurate", "user_limit")
    return Outcome(
        claim="infeasible" if atoms.broken else claim,
        point=Point(np.asarray(atoms.x.value, float) if found else start.x),
        objective=float(problem.value) if found else np.nan,
        iterations=int(iterations), evaluations=evaluations, cpu_s=time.process_time() - cpu,
        detail=atoms.broken or detail,
    )  # fmt: skip


ENDED: Mapping[str, Claim] = {
    "Optimal Solution Found.": "solved",
    "Solved To Acceptable Level.": "solved",
    "Converged to a point of local infeasibility. Problem may be infeasible.": "infeasible",
    "Maximum Number of Iterations Exceeded.": "iteration_limit",
    "Maximum wallclock time exceeded.": "time_limit",
    "Invalid number in NLP function or derivative detected.": "invalid",
}


def _ipopt(log: str) -> tuple[Claim, int, int, str]:
    """Claim, iterations, evaluations and last words of IPOPT, from its log: CVXPY passes on none of them."""
    iterations = re.search(r"Number of Iterations\.*: (\d+)", log)
    calls = re.findall(r"Number of (?:objective|equality|Lagrangian).* evaluations += (\d+)", log)
    words = re.search(r"EXIT: (.*)", log)
    detail = words[1].strip() if words else "ended without a word"
    return ENDED.get(detail, "failed"), int(iterations[1]) if iterations else 0, sum(map(int, calls)), detail
