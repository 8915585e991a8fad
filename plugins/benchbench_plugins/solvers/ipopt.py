"""IPOPT through CasADi, with the assembled derivatives."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import field, replace
from typing import Any, final

import casadi as ca
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.program import Program
from benchbench.nlp.solver import TOLERANCE, Claim, Parametric, Prepared, Setup, Solver, Warmth
from benchbench_plugins.solvers import casadi_nlp
from benchbench_plugins.solvers.casadi_nlp import Backend
from benchbench_plugins.solvers.trial import require

CLAIMS: dict[str, Claim] = {
    "Solve_Succeeded": "solved",
    "Solved_To_Acceptable_Level": "solved",
    "Infeasible_Problem_Detected": "infeasible",
    "Maximum_Iterations_Exceeded": "iteration_limit",
    "Maximum_CpuTime_Exceeded": "time_limit",
    "Maximum_WallTime_Exceeded": "time_limit",
    "Invalid_Number_Detected": "invalid",
}
LIBRARIES = ("ma27", "ma57", "ma77", "ma86", "ma97", "pardiso")
"""Linear solvers whose library the wheel does not have; IPOPT refuses unknown names by itself."""
REMEDY = (
    "linear_solver=mumps or spral, or put the linear solver's library (HSL: libhsl.so) on LD_LIBRARY_PATH"
)

BACKEND = Backend("ipopt", CLAIMS, watched=True)
PUSH: dict[Warmth, float] = {"near": 1e-6, "prolongated": 1e-3}
"""How far a start with multipliers is kept from bounds.

Of nearly the same problem: replans of a moving target at N = 50 took 9 iterations (median) with the adaptive mu that cold starts
have too; monotone from mu_init 1e-3, 1e-4, 1e-6 took 24, 17, 9, and up to 217 after a turn of the target where adaptive
took 46. Of another grid: four handovers took 94, 69, 44, 53 iterations at N = 100 and 200 with 1e-3, and 157, 75, 89, 58 with
1e-6; monotone from 1e-3 never ended on one of them.
"""
LARGEST = 1e9
"""Largest shift of the Hessian from multipliers, as IPOPT names its correction of the inertia; those that solve need 1e6 or less.

Beyond it MUMPS takes 0.3 s in place of 15 ms for each iteration of a flight at N = 150, and none ended well.
"""

PLAIN = {"mumps_permuting_scaling": 0}
"""MUMPS does not match rows and columns by size: that cost time and made solves on fine grids creep. `static`, N = 800 from N = 400: 10
iterations and 0.9 s in place of 52 and 8.0 s; of 29 other tasks, every kind of dynamics among them, all stayed certified, many in fewer
iterations, a few in more.
Without scaling (mumps_scaling=0) nothing is gained but on replans, and a known optimum of a small MPCC is missed.
"""
FILL = 3.0
"""Entries of the factor by minimum degree, over those of the matrix, up to which that is the order in which MUMPS eliminates: it takes a
quarter of the time of METIS, and as long to factorise or less. Verlet has 0.7, rk4 and hermite_simpson 1.6, all at N = 100; collocation
has 7.7, and took ten times longer so than with METIS.
"""
DEGREE, METIS = 0, 5
"""Numbers of these orders in MUMPS."""
NEARBY = {
    **{f"warm_start_{what}": 1e-3 for what in ("bound_push", "bound_frac", "slack_bound_push", "slack_bound_frac")},
    "warm_start_mult_bound_push": 1e-6, "alpha_for_y": "bound-mult", "mumps_scaling": 0, "fast_step_computation": "yes",
}  # fmt: skip
"""For a moving target. 180 replans of static, linear and circle at N = 25 to 100, the target off by 3 mm to 0.1 m, took 10.7 iterations in
the mean and 27 at most; with all pushes 1e-6 and alpha_for_y primal 13.7 and 63. In flights after a turning target 60 of 60 were solved
within 60 iterations, in place of 57. Residuals of linear systems are not looked at (`fast_step_computation`): the same plans to 1e-10 in 0.9 of the time.
"""
LEAST = 1 / 11
"""Smallest mu of replans over the tolerance, as IPOPT's monotone strategy has it. The adaptive one goes on to 1e-11: in flat directions of
nearly the same problem each smaller mu asks for a step of its own, and a start at the very edge is a bad one for the next.
"""


@final
@dataclass(frozen=True)
class Ipopt(Solver):
    """Interior-point method (Waechter & Biegler 2006, doi:10.1007/s10107-004-0559-y).

    `options` are IPOPT's own and win over what is set here; `linear_solver` is mumps or spral in the
    CasADi wheel; another one is first tried in a child process, because it kills the process when its
    library is missing.
    """

    linear_solver: str = "mumps"
    options: dict[str, Any] = field(default_factory=dict)

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        """Assemble once, build one CasADi solver with sigma as its parameter."""
        native = self._checked(self.native_options(setup))
        return casadi_nlp.prepare_with_derivatives(BACKEND, mpcc, setup, lambda p: self._ordered(native, p))

    def prepare_parametric(self, mpcc: Mpcc, setup: Setup, adjustable: Collection[str]) -> Parametric:
        """One CasADi solver whose parameters are those of the adjustable blocks, started warm."""
        least = {"mu_min": TOLERANCE[setup.accuracy] * LEAST}
        native = self._checked(
            self.native_options(replace(setup, warm="near")) | NEARBY | least | self.options
        )
        return casadi_nlp.prepare_parametric(
            BACKEND, mpcc, setup, lambda p: self._ordered(native, p), adjustable
        )

    def _ordered(self, native: dict[str, Any], program: Program) -> dict[str, Any]:
        """CasADi's options, with the order in which MUMPS eliminates the unknowns of this program."""
        order = {"mumps_pivot_order": DEGREE if _fill(program) <= FILL else METIS}
        return {"ipopt": native | order | self.options}

    def _checked(self, native: dict[str, Any]) -> dict[str, Any]:
        if native["linear_solver"] in LIBRARIES:
            require("ipopt", {"ipopt": {"linear_solver": native["linear_solver"], "print_level": 0}}, REMEDY)
        return native

    def native_options(self, setup: Setup) -> dict[str, Any]:
        """IPOPT's tol, max_iter and max_cpu_time; mu and bounds as measured best for MPCCs."""
        own = {
            "tol": TOLERANCE[setup.accuracy],
            "linear_solver": self.linear_solver,
            "mumps_pivot_order": METIS,  # unless `_ordered` knows better
            **PLAIN,
            "mu_strategy": "adaptive",
            "bound_relax_factor": 0.0,
            "max_iter": setup.iterations,
            "max_cpu_time": setup.seconds,
            "print_level": 0,
            "sb": "yes",
        }
        return own | _warm(setup.warm) | self.options

    def version(self) -> str:
        """CasADi's version names the bundled IPOPT."""
        return casadi_nlp.version("ipopt")


def _fill(program: Program) -> float:
    """Entries of the factor of the KKT matrix by approximate minimum degree, over those of the matrix."""
    upper = program.hessian.sparsity_out(0)
    matrix = ca.Sparsity.kkt(upper + upper.T, program.jacobian.sparsity_out(1))
    return float(matrix.ldl()[0].nnz() / matrix.nnz())


def _warm(warmth: Warmth) -> dict[str, Any]:
    """What differs where multipliers are known."""
    if warmth == "no":
        return {}
    pushed = ("bound_push", "bound_frac", "slack_bound_push", "slack_bound_frac", "mult_bound_push")
    own: dict[str, Any] = {"warm_start_init_point": "yes", "max_hessian_perturbation": LARGEST}
    return own | {f"warm_start_{what}": PUSH[warmth] for what in pushed}
