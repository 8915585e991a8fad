"""Does a backend work here? Found out in a child process, because a missing library can end a process.

The children are forked by one process that has imported what all need, where the system can fork.
"""

from __future__ import annotations

import json
import os
import signal
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from multiprocessing import get_all_start_methods, get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from benchbench.ground.errors import BenchBenchError, Unavailable
from benchbench.mpcc.problem import Mpcc, Variable, block, rows
from benchbench.nlp.solver import Point, Setup

IMPORTED = ("benchbench.nlp.quiet_interrupt", "casadi", "hydra", __name__)
"""Modules of the process that forks."""


@dataclass(frozen=True)
class Availability:
    """Whether something works here, and if not, why and what to do about it."""

    works: bool
    reason: str = ""


def works(config: Mapping[str, Any], seconds: float = 60.0) -> Availability:
    """Try a solver, given as the configuration that makes it (`_target_` and fields)."""
    return ask(__name__, json.dumps(config, sort_keys=True), seconds)


def begin() -> None:
    """Start the process that forks, deaf to Ctrl-C until it knows how to end quietly; for the main thread, before others ask."""
    if "forkserver" not in get_all_start_methods():
        return
    from multiprocessing import forkserver

    get_context("forkserver").set_forkserver_preload(list(IMPORTED))
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        forkserver.ensure_running()
    finally:
        signal.signal(signal.SIGINT, before)


@cache
def ask(module: str, question: str, seconds: float = 60.0) -> Availability:
    """Call `fault(question)` of a module in a child; it returns why something does not work, "" if it does."""
    forks = "forkserver" in get_all_start_methods()
    context = get_context("forkserver") if forks else get_context("spawn")
    context.set_forkserver_preload(list(IMPORTED))  # heard once, when the process starts
    ours, theirs = context.Pipe(duplex=False)
    with ours, tempfile.NamedTemporaryFile() as printed:
        child = context.Process(target=_answer, args=(module, question, theirs, printed.name))
        child.start()
        theirs.close()
        child.join(seconds)
        if child.exitcode is None:
            child.kill()
            child.join()
            return Availability(False, f"a tiny problem was not solved within {seconds:g} s")
        with suppress(EOFError):  # it ended before it had said anything
            said = str(ours.recv())
            return Availability(not said, said)
        return Availability(False, _death(child.exitcode, Path(printed.name).read_text(errors="replace")))


def _answer(module: str, question: str, channel: Connection, printed: str) -> None:
    """Be the child; what it prints goes to a file."""
    with open(printed, "wb") as file:
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
    channel.send(import_module(module).fault(question))


def _death(code: int, printed: str) -> str:
    if code < 0:
        return f"it ends the process ({signal.Signals(-code).name})"
    lines = printed.strip().splitlines()
    return lines[-1] if lines else f"it ends the process (exit code {code})"


def tiny() -> tuple[Mpcc, np.ndarray]:
    """A problem with stages, and its solution: go from 0 to 3 in three steps with least effort."""
    q = np.array([[0.0], [np.nan], [np.nan], [3.0]])
    free = np.isnan(q)
    state = Variable("q", np.where(free, -9.0, q), np.where(free, 9.0, q), np.where(free, 0.5, q))
    u = Variable("u", np.full((3, 1), -5.0), np.full((3, 1), 5.0), np.zeros((3, 1)))
    slots = (rows("q", 1, range(3)), rows("q", 1, range(1, 4)), rows("u", 1, range(3)))
    dynamics = block("step", slots, lambda here, there, u: there - here - u)
    cost = block("effort", slots[2:], lambda u: u**2)
    return Mpcc((state, u), (dynamics,), (cost,)), np.array([0.0, 1.0, 2.0, 3.0, 1.0, 1.0, 1.0])


def fault(question: str) -> str:
    """Return why the solver of a configuration (JSON) does not work, "" if it does."""
    import hydra

    config = json.loads(question)
    problem, solution = tiny()
    try:
        solver = hydra.utils.instantiate(config, _convert_="all")
        outcome = solver.prepare(problem, Setup(10.0, 500, "medium", "never"))(0.0, Point(problem.guess))
    except Unavailable as error:
        return str(error)
    except (BenchBenchError, ImportError, RuntimeError, hydra.errors.HydraException) as error:
        return f"{type(error).__name__}: {str(error).strip().splitlines()[-1]}"
    wrong = float(np.max(np.abs(outcome.point.x - solution)))
    if outcome.claim != "solved" or not wrong < 1e-3:
        return f"it did not solve a tiny problem (claim {outcome.claim}, {outcome.detail or 'no detail'}, error {wrong:.1e})"
    return ""
