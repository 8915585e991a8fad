"""Sequential convex programming with CVXPY."""

from __future__ import annotations

from dataclasses import field
from importlib import metadata
from typing import Annotated, Any, final

from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.solver import TOLERANCE, Outcome, Point, Prepared, Setup, Solver
from benchbench_plugins.solvers.cvxpy_backend_loop import Rules, SequentialSolve
from benchbench_plugins.solvers.cvxpy_backend_model import LocalModel
from benchbench_plugins.solvers.cvxpy_backend_qp import Subproblem, cvxpy

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


@final
@dataclass(frozen=True)
class Cvxpy(Solver):
    """Sequential convex programming: an Sl1QP method with a convexified Hessian.

    Each iteration solves one convex problem in the step d, posed to CVXPY once with parameters:

        min  grad f . d + d' B d / 2 + sum_i w_i (violation of linearised row i)
        s.t. bounds of the unknowns, |d_j| <= radius (unknowns that must be positive: relative to their value)

    * Penalty and trust region: Nocedal & Wright 2006, section 18.5 (Fletcher's Sl1QP). With B = 0 this is
      successive convexification (Mao, Szmuk & Acikmese 2016, doi:10.1109/CDC.2016.7798816); the cost here is
      nearly linear, but at the optimum some 30 degrees of freedom are at no bound, where B = 0 only creeps
      (N = 25: 2.866 s instead of 2.821 s after 250 iterations).
    * B: the Lagrangian's Hessian, instance by instance of each block with its negative eigenvalues cut off;
      halved, down to 1/1000, after a step that gained over 1.3 times what was promised, doubled up to 1
      after less than 0.75. Exact for one convex block; in general convergence is linear.
    * Rows are scaled by slope and curvature at the start, see `LocalModel`.
    * Acceptance: actual over promised fall of f + sum w_i violation_i above 1e-4. The radius grows by 2.5
      above 0.75 at the edge and is halved below 0.25; after a rejection it is 0.4 times the step. A rejected
      step that raised the violation gets a second-order correction first (section 18.3): the same problem
      with the rows' values from the rejected point.
    * Weights: twice the multiplier, at least 1, reached from above by averaging (Powell 1978); times four
      while a row keeps slack.
    * "solved": violations below the tolerance (1e-4, 1e-6, 1e-8), and either the KKT residual too or the
      promised fall below its square (at least 1e-11, what the convex solver can vouch for); or nothing moves
      and both are within 100 tolerances. "infeasible": nothing is promised, a violated row weighs 1e8.

    It finds KKT points: a start in a plane of symmetry stays in it, even where a better plan leaves it.
    `solver` is any conic solver of CVXPY that takes quadratic objectives, `options` are its own and win;
    `radius` is the first trust region in units of the unknowns, `weight` the first penalty of a scaled row.
    """

    solver: str = "CLARABEL"
    radius: Positive = 1.0
    weight: Positive = 10.0
    options: dict[str, Any] = field(default_factory=dict)

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        """Assemble, pose the subproblem. Raises Unavailable."""
        cvxpy()
        native = self.native_options(setup)
        model = LocalModel(mpcc, setup.compile, setup.seconds)
        subproblem = Subproblem(model, self.solver, native["options"])
        limits = (native["tolerance"], native["iterations"], native["seconds"])
        rules = Rules(*limits, self.radius, self.weight, setup.progress)

        def solve(sigma: float, start: Point) -> Outcome:
            return SequentialSolve(model, subproblem, rules, sigma).run(start.x)

        return solve

    def native_options(self, setup: Setup) -> dict[str, Any]:
        """Tolerance, iterations and seconds of the outer loop, and options of the convex solver."""
        return {
            "tolerance": TOLERANCE[setup.accuracy],
            "iterations": setup.iterations,
            "seconds": setup.seconds,
            "options": OPTIONS.get(self.solver.upper(), {}) | self.options,
        }

    def version(self) -> str:
        """Versions of CVXPY and, where it has one, of the convex solver."""
        cvxpy()
        return f"cvxpy {metadata.version('cvxpy')}, {self.solver.lower()}"


OPTIONS = {"CLARABEL": {"tol_gap_abs": 1e-10, "tol_gap_rel": 1e-10, "tol_feas": 1e-10}}
"""Its default 1e-8 leaves noise in the last steps."""
