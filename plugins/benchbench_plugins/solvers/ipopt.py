"""IPOPT through CasADi, with the assembled derivatives."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import field
from importlib import metadata
from typing import Any, final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.assemble import Program, assemble
from benchbench.mpcc import Mpcc
from benchbench.solver import TOLERANCE, Claim, Outcome, Point, Prepared, Progress, Setup, Solver

CLAIMS: dict[str, Claim] = {
    "Solve_Succeeded": "solved",
    "Solved_To_Acceptable_Level": "solved",
    "Infeasible_Problem_Detected": "infeasible",
    "Maximum_Iterations_Exceeded": "iteration_limit",
    "Maximum_CpuTime_Exceeded": "time_limit",
    "Maximum_WallTime_Exceeded": "time_limit",
    "Invalid_Number_Detected": "invalid",
}


@final
@dataclass(frozen=True)
class Ipopt(Solver):
    """Interior-point method (Waechter & Biegler 2006, doi:10.1007/s10107-004-0559-y).

    `options` are IPOPT's own and win over what is set here; `linear_solver` is mumps or spral in the
    CasADi wheel (others crash without their library).
    """

    linear_solver: str = "mumps"
    options: dict[str, Any] = field(default_factory=dict)

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        """Assemble once, build one CasADi solver with sigma as its parameter."""
        program = assemble(mpcc, setup.compile)
        options = _casadi_options(program) | {"ipopt": self.native_options(setup)}
        if setup.progress:
            options["iteration_callback"] = watch = _Watch(program, setup.progress)
        solver = ca.nlpsol("ipopt", "ipopt", _problem(program), options)

        def solve(sigma: float, start: Point) -> Outcome:
            return _run(solver, program, sigma, start)

        solve.keep = watch if setup.progress else None  # type: ignore[attr-defined]  # CasADi holds no reference
        return solve

    def native_options(self, setup: Setup) -> dict[str, Any]:
        """IPOPT's tol, max_iter and max_wall_time; mu and bounds as measured best for MPCCs."""
        own = {
            "tol": TOLERANCE[setup.accuracy],
            "linear_solver": self.linear_solver,
            "mumps_pivot_order": 5,  # METIS; MUMPS' own choice took 20 times longer on collocation
            "mu_strategy": "adaptive",
            "bound_relax_factor": 0.0,
            "max_iter": setup.iterations,
            "max_wall_time": setup.seconds,
            "print_level": 0,
            "sb": "yes",
        }
        return own | self.options

    def version(self) -> str:
        """CasADi's version names the bundled IPOPT."""
        return f"ipopt (casadi {metadata.version('casadi')})"


def _casadi_options(program: Program) -> dict[str, Any]:
    """Own derivatives; without the two switches CasADi would ask blocks for derivatives they do not have."""
    return {
        "grad_f": program.gradient,
        "jac_g": program.jacobian,
        "hess_lag": program.hessian,
        "no_nlp_grad": True,
        "calc_lam_p": False,
        "calc_f": False,
        "calc_g": False,
        "print_time": False,
        "error_on_fail": False,
    }


def _problem(program: Program) -> dict[str, ca.MX]:
    return {"x": program.x, "p": program.p, "f": program.f, "g": program.g}


def _run(solver: ca.Function, program: Program, sigma: float, start: Point) -> Outcome:
    arguments: dict[str, Any] = {
        "x0": start.x, "p": sigma,
        "lbx": program.lower_x, "ubx": program.upper_x, "lbg": program.lower_g, "ubg": program.upper_g,
    }  # fmt: skip
    if start.lam_g is not None and start.lam_x is not None:
        arguments |= {"lam_g0": start.lam_g, "lam_x0": start.lam_x}
    began = time.process_time()
    result = solver(**arguments)
    spent = time.process_time() - began
    stats = solver.stats()
    status = stats["return_status"]
    known = status in CLAIMS  # on Invalid_Option the iteration count is garbage
    return Outcome(
        claim=CLAIMS.get(status, "failed"),
        point=Point(*(np.asarray(result[k]).ravel() for k in ("x", "lam_g", "lam_x"))),
        objective=float(result["f"]),
        iterations=int(stats["iter_count"]) if known else 0,
        evaluations=sum(int(v) for k, v in stats.items() if k.startswith("n_call_nlp") and known),
        cpu_s=spent,
        detail=status,
        times={k.removeprefix("t_proc_"): float(v) for k, v in stats.items() if k.startswith("t_proc_nlp")},
    )


@final
class _Watch(ca.Callback):
    """Hands iterations to the progress display."""

    def __init__(self, program: Program, progress: Progress) -> None:
        ca.Callback.__init__(self)
        n, m = len(program.lower_x), len(program.lower_g)
        self.sizes = {"x": n, "f": 1, "g": m, "lam_x": n, "lam_g": m, "lam_p": 1}
        self.program, self.progress, self.count = program, progress, 0
        self.construct("watch", {})

    def get_n_in(self) -> int:
        return ca.nlpsol_n_out()

    def get_n_out(self) -> int:
        return 1

    def get_name_in(self, i: int) -> str:
        return ca.nlpsol_out(i)

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(self.sizes[ca.nlpsol_out(i)], 1)

    def eval(self, arguments: Sequence[ca.DM]) -> list[int]:
        values = dict(zip(map(ca.nlpsol_out, range(ca.nlpsol_n_out())), arguments, strict=True))
        g = np.asarray(values["g"]).ravel()
        violation = np.maximum(self.program.lower_g - g, g - self.program.upper_g).max(initial=0.0)
        self.progress(self.count, np.asarray(values["x"]).ravel(), float(violation))
        self.count += 1
        return [0]
