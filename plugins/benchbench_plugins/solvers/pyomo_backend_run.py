"""The two ways from a Pyomo model to a solution."""

from __future__ import annotations

import io
import os
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from shutil import which
from subprocess import TimeoutExpired
from typing import Any

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ground.errors import Unavailable
from benchbench.nlp.solver import Claim, Outcome, Point, Prepared
from benchbench_plugins.solvers.casadi_nlp import COMMON, claim, function_times, quiet
from benchbench_plugins.solvers.pyomo_backend_model import PyomoModel


@dataclass(frozen=True)
class Nl:
    """A model as read back from its .nl file, with sigma as parameter p.

    problem              x, p, f, g as CasADi wants them
    variables, rows      the Pyomo objects behind the entries of x and g
    lower_x ... upper_g  bounds
    """

    problem: dict[str, ca.SX]
    variables: list[Any]
    rows: list[Any]
    lower_x: Array
    upper_x: Array
    lower_g: Array
    upper_g: Array


def read_back(model: PyomoModel) -> Nl:
    """Write an .nl file and read it with CasADi; Pyomo's presolve and scaling are off."""
    from pyomo.repn.plugins.nl_writer import NLWriter

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.nl"
        with path.open("w", newline="") as file:
            info = NLWriter().write(model.model, file, linear_presolve=False, scale_model=False)
        builder = ca.NlpBuilder()
        builder.import_nl(str(path), {})
    whole = ca.Function(
        "nl", [ca.vertcat(*builder.x)], [builder.f, ca.vertcat(ca.MX(0, 1), *builder.g)]
    ).expand()
    free = [i for i, variable in enumerate(info.variables) if variable is not model.sigma]
    x, sigma = ca.SX.sym("x", len(free)), ca.SX.sym("sigma")
    full = ca.SX(len(info.variables), 1)
    full[:] = sigma
    full[free] = x
    f, g = whole(full)
    limits = (builder.x_lb, builder.x_ub, builder.g_lb, builder.g_ub)
    low, high, *rows = (np.asarray(limit, float) for limit in limits)
    variables = [info.variables[i] for i in free]
    return Nl(
        {"x": x, "p": sigma, "f": f, "g": g}, variables, list(info.constraints), low[free], high[free], *rows
    )


def by_casadi(
    model: PyomoModel, plugin: str, claims: Mapping[str, Claim], options: dict[str, Any]
) -> Prepared:
    """Solve with a plugin of CasADi's nlpsol, which differentiates the whole graph."""
    nl = read_back(model)
    own = {k: v for k, v in COMMON.items() if k != "no_nlp_grad"}
    with quiet():
        solver = ca.nlpsol("pyomo", plugin, nl.problem, {**own, plugin: options})

    def solve(sigma: float, start: Point) -> Outcome:
        model.start(start.x)
        first = np.clip([variable.value for variable in nl.variables], nl.lower_x, nl.upper_x)
        began = time.process_time()
        with quiet():
            result = solver(x0=first, p=sigma, lbx=nl.lower_x, ubx=nl.upper_x, lbg=nl.lower_g, ubg=nl.upper_g)
        spent, stats = time.process_time() - began, solver.stats()
        x, lam_x, lam_g = (np.asarray(result[k]).ravel() for k in ("x", "lam_x", "lam_g"))
        calls = sum(int(v) for k, v in stats.items() if k.startswith(("n_call_nlp", "n_call_fwd1_nlp")))
        return Outcome(
            claim="infeasible" if model.broken else claim(stats, claims),
            point=Point(
                _ordered(model.unknowns, nl.variables, x, start.x),
                _ordered(model.rows, nl.rows, lam_g, np.zeros(len(model.rows))),
                _ordered(model.unknowns, nl.variables, lam_x, np.zeros(len(start.x))),
            ),
            objective=float(result["f"]),
            iterations=int(stats["iter_count"]) if calls else 0,
            evaluations=calls,
            cpu_s=spent,
            detail=model.broken or str(stats["return_status"]),
            times=function_times(stats),
        )

    return solve


def by_executable(model: PyomoModel, name: str, options: dict[str, Any], seconds: float) -> Prepared:
    """Let Pyomo run a solver that reads .nl and writes .sol files. Raises Unavailable."""
    from pyomo.common.errors import ApplicationError
    from pyomo.common.log import LoggingIntercept
    from pyomo.environ import SolverFactory, value

    if which(name) is None:
        raise Unavailable(
            f"solver 'pyomo' finds no executable '{name}' on the PATH: install one that reads .nl files, "
            "or set solver.executable=null to solve through CasADi"
        )

    def solve(sigma: float, start: Point) -> Outcome:
        model.sigma.fix(sigma)
        model.start(start.x)
        began = _cpu()
        try:
            claimed, detail = _run(name, model.model, options, seconds)
        except TimeoutExpired:
            claimed, detail = "time_limit", f"stopped after {seconds:g} s"
        except ApplicationError as error:
            claimed, detail = "failed", str(error)
        return Outcome(
            claim="infeasible" if model.broken else claimed,
            point=Point(np.array([variable.value for variable in model.unknowns], float)),
            objective=float(value(model.model.cost, exception=False) or np.nan),
            iterations=0, evaluations=0, cpu_s=_cpu() - began, detail=model.broken or detail,
        )  # fmt: skip

    def _run(name: str, model: Any, options: dict[str, Any], seconds: float) -> tuple[Claim, str]:
        solver = SolverFactory(f"asl:{name}")
        result = solver.solve(model, options=options, load_solutions=False, timelimit=seconds)
        with LoggingIntercept(io.StringIO(), "pyomo.core"):  # it warns when the status is not optimal
            model.solutions.load_from(result)
        claimed = ENDED.get(str(result.solver.termination_condition), "failed")
        return claimed, str(result.solver.message).replace("\\x3a", ":")

    return solve


ENDED: dict[str, Claim] = {
    "optimal": "solved", "locallyOptimal": "solved", "globallyOptimal": "solved", "infeasible": "infeasible",
    "maxIterations": "iteration_limit", "maxTimeLimit": "time_limit", "maxEvaluations": "iteration_limit",
}  # fmt: skip
"""Pyomo's termination conditions; a solver called so does not say how many iterations it took."""


def _ordered(wanted: tuple[Any, ...], given: list[Any], numbers: Array, otherwise: Array) -> Array:
    """Numbers of the given Pyomo objects in the order wanted; `otherwise` for those that were not written."""
    place = {id(thing): i for i, thing in enumerate(given)}
    return np.array(
        [numbers[place[id(w)]] if id(w) in place else o for w, o in zip(wanted, otherwise, strict=True)]
    )


def _cpu() -> float:
    """CPU seconds of this process and of the children that have ended."""
    return sum(os.times()[:4])
