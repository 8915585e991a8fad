"""What all backends behind CasADi's nlpsol share: the form of the problem, running it, reading what it says."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from importlib import metadata
from typing import Any

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput, Unavailable
from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.program import Program, assemble
from benchbench.nlp.solver import Claim, Outcome, Parametric, Point, Prepared, Setup
from benchbench_plugins.solvers.library import oracle, signatures
from benchbench_plugins.solvers.output import last_line
from benchbench_plugins.solvers.output import quiet as quiet
from benchbench_plugins.solvers.watch import SolverWatch

COMMON = {"calc_lam_p": False, "print_time": False, "error_on_fail": False}
PATIENCE = 120.0
"""CPU seconds that building a program for many solves may take, half of them compilers, however short each solve has to be."""
OVERRUN = 1.2
"""Share of its time from which on a backend that took more is told to have."""
UNIFIED: dict[str, Claim] = {
    "SOLVER_RET_LIMITED": "iteration_limit",
    "SOLVER_RET_INFEASIBLE": "infeasible",
    "SOLVER_RET_NAN": "invalid",
}
"""CasADi's own reading of a failure, used where `Backend.claims` says nothing."""


@dataclass(frozen=True)
class Backend:
    """A plugin of CasADi's nlpsol.

    claims   what its `return_status` means where success and CasADi's unified status do not say it
    change   what is done to the assembled program before it is solved, such as sorting rows into stages
    fixed    CasADi options that belong to this problem only (structure, integrality)
    watched  it calls `iteration_callback`, so its progress can be shown
    timed    it stops at a time limit by itself; what is watched but not timed is stopped by us
    wall     the clock that it goes by is the wall's; else CPU
    """

    plugin: str
    claims: Mapping[str, Claim]
    change: Callable[[Program], Program] = lambda program: program
    fixed: Mapping[str, Any] | None = None
    watched: bool = False
    timed: bool = True
    wall: bool = True


def prepare(backend: Backend, mpcc: Mpcc, setup: Setup, options: Mapping[str, Any]) -> Prepared:
    """Build the solver with `options` (CasADi's), with compiled derivatives where possible.

    Without a compiler, or for a plugin that wants functions we do not have, the blocks are expanded into
    one scalar graph that CasADi differentiates (3 s and 13 ms per iteration for N = 50, against 0.9 s and
    3 ms).
    """
    options = {**COMMON, **options}
    with quiet():
        program = backend.change(assemble(mpcc, setup.compile, seconds=setup.seconds))
        problem: Any = None
        if program.compiled:
            wanted = signatures(_create(backend.plugin, _tiny(), options))
            problem = oracle(program, mpcc, wanted, setup.seconds / 2)
        if problem is None:
            program = backend.change(assemble(mpcc, "never")) if program.compiled else program
            problem, options["expand"] = _problem(program), True
        return finish(backend, program, problem, setup, {**options, **(backend.fixed or {})})


Choice = Callable[[Program], Mapping[str, Any]]
"""CasADi's options for a program."""


def prepare_with_derivatives(backend: Backend, mpcc: Mpcc, setup: Setup, options: Choice) -> Prepared:
    """Build a solver that takes derivative functions as options (IPOPT, BONMIN): nothing more to compile."""
    program = backend.change(assemble(mpcc, setup.compile, seconds=setup.seconds))
    given = {**_derivatives(program), **options(program), **(backend.fixed or {})}
    return finish(backend, program, _problem(program), setup, given)


def prepare_parametric(
    backend: Backend, mpcc: Mpcc, setup: Setup, options: Choice, adjustable: Collection[str]
) -> Parametric:
    """Build one solver for all problems that differ in numbers only (see `Solver.prepare_parametric`)."""
    program = assemble(mpcc, setup.compile, adjustable, max(setup.seconds, PATIENCE))
    run = _runner(backend, program, _problem(program), setup, {**_derivatives(program), **options(program)})
    return lambda moved, start: run(program.moved(moved), program.numbers(moved, 0.0), start)


def _derivatives(program: Program) -> dict[str, Any]:
    """Options; without `no_nlp_grad` and `calc_lam_p` CasADi would ask blocks for derivatives they do not have."""
    own = {"grad_f": program.gradient, "jac_g": program.jacobian, "hess_lag": program.hessian}
    return {**COMMON, **own, "no_nlp_grad": True, "calc_f": False, "calc_g": False}


def finish(
    backend: Backend, program: Program, problem: Any, setup: Setup, options: dict[str, Any]
) -> Prepared:
    """Create the nlpsol and what runs it."""
    run = _runner(backend, program, problem, setup, options)
    return lambda sigma, start: run(program, np.array([sigma]), start)


def _runner(
    backend: Backend, program: Program, problem: Any, setup: Setup, options: dict[str, Any]
) -> Callable[[Program, Array, Point], Outcome]:
    """Create the nlpsol; what it returns solves the program for p, with the bounds it is given."""
    needed = setup.progress is not None or not backend.timed
    watch = SolverWatch(program, setup) if backend.watched and needed else None
    if watch:
        options = {**options, "iteration_callback": watch}
    solver = _create(backend.plugin, problem, options)

    def solve(bounded: Program, p: Array, start: Point) -> Outcome:
        if watch:  # named here, because CasADi holds no reference to its callback
            watch.begin()
        began = time.perf_counter()
        with quiet(setup.progress is None):
            outcome = _run(solver, bounded, backend.claims, watch, p, start, setup.iterations)
        took = time.perf_counter() - began if backend.timed and backend.wall else outcome.cpu_s
        return _limited(outcome, setup, took)

    return solve


def _limited(outcome: Outcome, setup: Setup, took: float) -> Outcome:
    """Name the limit that an outcome is due to: CasADi calls both the same, some backends neither.

    took: seconds of the clock that limits it; a backend may overrun its limit by far where it looks at its clock between iterations only.
    """
    if outcome.claim not in ("failed", "iteration_limit"):
        return outcome
    if outcome.iterations >= setup.iterations:
        return replace(outcome, claim="iteration_limit")
    if took < setup.seconds:
        return outcome
    over = f", after {took:.1f} s of {setup.seconds:.3g} s" if took > OVERRUN * setup.seconds else ""
    return replace(outcome, claim="time_limit", detail=f"{outcome.detail}{over}")


def _create(plugin: str, problem: Any, options: dict[str, Any]) -> ca.Function:
    try:
        with quiet() as printed:
            return ca.nlpsol(plugin, plugin, problem, options)
    except RuntimeError as error:  # CasADi's only exception
        wrong = re.search(r"Setting: .* for Option: \w+", printed.getvalue())  # IPOPT's way
        text = wrong[0] if wrong else last_line(error)
        if "is not found" in text:
            raise Unavailable(
                f"{plugin}: {text}; remedy: pip install casadi (its wheel), or another choice"
            ) from error
        raise BadInput("solver", f"{plugin} refused its options: {text}", f"options of {plugin}") from error


def _problem(program: Program) -> dict[str, ca.MX]:
    return {"x": program.x, "p": program.p, "f": program.f, "g": program.g}


def _tiny() -> dict[str, ca.MX]:
    """A problem on which a plugin shows which functions it asks for."""
    x, p = ca.MX.sym("x", 2), ca.MX.sym("p")
    return {"x": x, "p": p, "f": ca.sumsqr(x - p) + x[0] ** 4, "g": x[0] * x[1]}


def _run(
    solver: ca.Function, program: Program, claims: Mapping[str, Claim], watch: SolverWatch | None, p: Array, start: Point,
    most: int,
) -> Outcome:  # fmt: skip
    arguments: dict[str, Any] = {
        "x0": start.x, "p": p,
        "lbx": program.lower_x, "ubx": program.upper_x, "lbg": program.lower_g, "ubg": program.upper_g,
    }  # fmt: skip
    if start.lam_g is not None and start.lam_x is not None:
        arguments |= {"lam_g0": start.lam_g, "lam_x0": start.lam_x}
    began = time.process_time()
    try:
        result = solver(**arguments)
        stats = solver.stats()
    except RuntimeError as error:  # CasADi's only exception; some plugins raise where others set a status
        return Outcome("failed", start, math.nan, 0, 0, time.process_time() - began, last_line(error))
    spent = time.process_time() - began
    calls = sum(int(v) for k, v in stats.items() if k.startswith(("n_call_nlp", "n_call_fwd1_nlp")))
    late = watch is not None and watch.late
    said = claim(stats, claims) if math.isfinite(float(result["f"])) else "invalid"
    return Outcome(
        claim="time_limit" if late and not stats["success"] else said,
        point=_point(*(np.asarray(result[k]).ravel() for k in ("x", "lam_g", "lam_x"))),
        objective=float(result["f"]),
        iterations=_iterations(stats, most) if calls else 0,
        evaluations=calls,
        cpu_s=spent,
        detail=str(stats.get("return_status", stats["unified_return_status"])),
        times=function_times(stats),
        trace=_trace(stats),
    )  # fmt: skip


def _point(x: Array, lam_g: Array, lam_x: Array) -> Point:
    """The point, without multipliers where the plugin gives NaN for them (BONMIN)."""
    return Point(x, lam_g, lam_x) if np.all(np.isfinite(np.append(lam_g, lam_x))) else Point(x)


def _iterations(stats: Mapping[str, Any], most: int) -> int:
    """Iterations; calls of the gradient where the library does not say (BONMIN, alpaqa).

    A library that refuses a problem before it starts leaves in its count whatever stood there before: a number that no
    run of at most `most` iterations can have is none.
    """
    gradients = max(int(stats.get(f"n_call_nlp_{name}", 0)) for name in ("grad_f", "grad_psi"))
    told = int(stats.get("iter_count", 0))
    return (told if 0 <= told <= most + 1 else 0) or gradients


def function_times(stats: Mapping[str, Any]) -> dict[str, float]:
    """CPU seconds of function evaluations by function."""
    timed = ("t_proc_nlp", "t_proc_fwd1_nlp")
    return {k.removeprefix("t_proc_"): float(v) for k, v in stats.items() if k.startswith(timed)}


def _trace(stats: Mapping[str, Any]) -> tuple[tuple[float, float], ...]:
    """Objective and violation by iteration, where the plugin keeps them (IPOPT)."""
    kept = stats.get("iterations")
    told = kept if isinstance(kept, Mapping) else {}
    return tuple(zip(map(float, told.get("obj", ())), map(float, told.get("inf_pr", ())), strict=False))


def claim(stats: Mapping[str, Any], claims: Mapping[str, Claim]) -> Claim:
    """Read a plugin's statistics; its own word on the status comes first, since some always say success."""
    said = claims.get(str(stats.get("return_status", "")))
    if said:
        return said
    return "solved" if stats["success"] else UNIFIED.get(stats["unified_return_status"], "failed")


def version(plugin: str) -> str:
    """CasADi's version names the library bundled in its wheel."""
    return f"{plugin} (casadi {metadata.version('casadi')})"
