"""What all backends behind CasADi's nlpsol share: the form of the problem, running it, reading what it says."""

from __future__ import annotations

import contextlib
import ctypes
import io
import logging
import math
import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from typing import Any, final

import casadi as ca
import numpy as np

from benchbench.assemble import Program, assemble
from benchbench.mpcc import Mpcc
from benchbench.solver import Claim, Outcome, Point, Prepared, Progress, Setup
from benchbench_plugins.solvers.library import oracle, signatures

log = logging.getLogger(__name__)
COMMON = {"calc_lam_p": False, "print_time": False, "error_on_fail": False}
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
    watched  it calls `iteration_callback`: live progress, and an end at the time limit where it has none
    """

    plugin: str
    claims: Mapping[str, Claim]
    change: Callable[[Program], Program] = lambda program: program
    fixed: Mapping[str, Any] | None = None
    watched: bool = False


def prepare(backend: Backend, mpcc: Mpcc, setup: Setup, options: Mapping[str, Any]) -> Prepared:
    """Build the solver with `options` (CasADi's), with compiled derivatives where possible.

    Without a compiler, or for a plugin that wants functions we do not have, the blocks are expanded into
    one scalar graph that CasADi differentiates (3 s and 13 ms per iteration for N = 50, against 0.9 s and
    3 ms).
    """
    options = {**COMMON, **options}
    with quiet():
        program = backend.change(assemble(mpcc, setup.compile))
        problem: Any = oracle(program, mpcc, signatures(backend.plugin, options)) if program.compiled else None
        if problem is None:
            program = backend.change(assemble(mpcc, "never")) if program.compiled else program
            problem, options["expand"] = _problem(program), True
        return finish(backend, program, problem, setup, {**options, **(backend.fixed or {})})


def prepare_with_derivatives(
    backend: Backend, mpcc: Mpcc, setup: Setup, options: Mapping[str, Any]
) -> Prepared:
    """Build a solver that takes derivative functions as options (IPOPT, BONMIN): nothing more to compile.

    Without the two switches in `COMMON` CasADi would ask blocks for derivatives they do not have.
    """
    program = backend.change(assemble(mpcc, setup.compile))
    own = {
        "grad_f": program.gradient, "jac_g": program.jacobian, "hess_lag": program.hessian,
        "no_nlp_grad": True, "calc_f": False, "calc_g": False,
    }  # fmt: skip
    return finish(backend, program, _problem(program), setup, {**COMMON, **own, **options, **(backend.fixed or {})})


def finish(backend: Backend, program: Program, problem: Any, setup: Setup, options: dict[str, Any]) -> Prepared:
    """Create the nlpsol and what runs it."""
    watch = Watch(program, setup) if backend.watched else None
    if watch:
        options = {**options, "iteration_callback": watch}
    solver = ca.nlpsol(backend.plugin, backend.plugin, problem, options)

    def solve(sigma: float, start: Point) -> Outcome:
        if watch:
            watch.begin()
        with quiet(setup.progress is None):
            return _run(solver, program, backend.claims, watch, sigma, start)

    solve.keep = watch  # type: ignore[attr-defined]  # CasADi holds no reference to its callback
    return solve


def _problem(program: Program) -> dict[str, ca.MX]:
    return {"x": program.x, "p": program.p, "f": program.f, "g": program.g}


def _run(
    solver: ca.Function, program: Program, claims: Mapping[str, Claim], watch: Watch | None, sigma: float, start: Point
) -> Outcome:  # fmt: skip
    arguments: dict[str, Any] = {
        "x0": start.x, "p": sigma,
        "lbx": program.lower_x, "ubx": program.upper_x, "lbg": program.lower_g, "ubg": program.upper_g,
    }  # fmt: skip
    if start.lam_g is not None and start.lam_x is not None:
        arguments |= {"lam_g0": start.lam_g, "lam_x0": start.lam_x}
    began = time.process_time()
    try:
        result = solver(**arguments)
    except RuntimeError as error:  # CasADi's only exception; some plugins raise where others set a status
        cause = str(error).strip().splitlines()[-1]
        return Outcome("failed", start, math.nan, 0, 0, time.process_time() - began, cause)
    spent = time.process_time() - began
    stats = solver.stats()
    calls = sum(int(v) for k, v in stats.items() if k.startswith(("n_call_nlp", "n_call_fwd1_nlp")))
    late = watch is not None and watch.late
    return Outcome(
        claim="time_limit" if late else claim(stats, claims),
        point=Point(*(np.asarray(result[k]).ravel() for k in ("x", "lam_g", "lam_x"))),
        objective=float(result["f"]),
        iterations=int(stats.get("iter_count", 0)) if calls else 0,  # garbage if refused before the start
        evaluations=calls,
        cpu_s=spent,
        detail="stopped by us at the time limit" if late else str(stats.get("return_status", stats["unified_return_status"])),
        times={k.removeprefix("t_proc_"): float(v) for k, v in stats.items() if k.startswith("t_proc_nlp")},
    )  # fmt: skip


def claim(stats: Mapping[str, Any], claims: Mapping[str, Claim]) -> Claim:
    """Read a plugin's statistics; its own word on the status comes first, since some always say success."""
    said = claims.get(str(stats.get("return_status", "")))
    if said:
        return said
    return "solved" if stats["success"] else UNIFIED.get(stats["unified_return_status"], "failed")


def version(plugin: str) -> str:
    """CasADi's version names the library bundled in its wheel."""
    return f"{plugin} (casadi {metadata.version('casadi')})"


@contextlib.contextmanager
def quiet(errors: bool = True) -> Iterator[None]:
    """Send what CasADi prints (and with `errors` its warnings) to the debug log; drop what libraries print."""
    text = io.StringIO()
    with contextlib.ExitStack() as stack:
        stack.enter_context(_descriptor_closed(1))
        stack.enter_context(contextlib.redirect_stdout(text))
        if errors:
            stack.enter_context(contextlib.redirect_stderr(text))
        yield
    if text.getvalue():
        log.debug(text.getvalue())


@contextlib.contextmanager
def _descriptor_closed(number: int) -> Iterator[None]:
    """Point a file descriptor at nothing: Uno prints a line for each fixed unknown, whatever its options say."""
    if os.name != "posix":
        yield
        return
    sys.stdout.flush()
    flush = ctypes.CDLL(None).fflush
    kept, nowhere = os.dup(number), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, number)
    try:
        yield
    finally:
        flush(None)
        os.dup2(kept, number)
        os.close(kept)
        os.close(nowhere)


@final
class Watch(ca.Callback):
    """Called each iteration: hands it to the progress display, and stops a plugin without a time limit."""

    def __init__(self, program: Program, setup: Setup) -> None:
        ca.Callback.__init__(self)
        n, m = len(program.lower_x), len(program.lower_g)
        self.sizes = {"x": n, "f": 1, "g": m, "lam_x": n, "lam_g": m, "lam_p": 1}
        self.program, self.progress, self.seconds = program, setup.progress, setup.seconds
        self.begin()
        self.construct("watch", {})

    def begin(self) -> None:
        """Start counting iterations and time."""
        self.count, self.began, self.late = 0, time.perf_counter(), False

    def get_n_in(self) -> int:
        return ca.nlpsol_n_out()

    def get_n_out(self) -> int:
        return 1

    def get_name_in(self, i: int) -> str:
        return ca.nlpsol_out(i)

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(self.sizes[ca.nlpsol_out(i)], 1)

    def eval(self, arguments: Sequence[ca.DM]) -> list[int]:
        if self.progress:
            self._show(self.progress, dict(zip(map(ca.nlpsol_out, range(len(arguments))), arguments, strict=True)))
        self.count += 1
        self.late = time.perf_counter() - self.began > self.seconds
        return [int(self.late)]

    def _show(self, progress: Progress, values: Mapping[str, ca.DM]) -> None:
        g = np.asarray(values["g"]).ravel()
        violation = np.maximum(self.program.lower_g - g, g - self.program.upper_g).max(initial=0.0)
        progress(self.count, np.asarray(values["x"]).ravel(), float(violation))
