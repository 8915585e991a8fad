"""Does a backend work here? Found out in a child process, because a missing library can end a process.

`python -m benchbench.nlp.availability` reads a solver's configuration (JSON) on stdin, solves a tiny problem
with it, and ends with 0, or with 3 and the reason as its last line.
"""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from benchbench.errors import BenchBenchError, Unavailable
from benchbench.mpcc.problem import Mpcc, Variable, block, rows
from benchbench.nlp.solver import Point, Setup

REFUSED = 3
"""Exit code of a child that knows why it does not work."""


@dataclass(frozen=True)
class Availability:
    """Whether something works here, and if not, why and what to do about it."""

    works: bool
    reason: str = ""


def works(config: Mapping[str, Any], seconds: float = 60.0) -> Availability:
    """Try a solver, given as the configuration that makes it (`_target_` and fields)."""
    return ask("benchbench.nlp.availability", json.dumps(config, sort_keys=True), seconds)


@cache
def ask(module: str, question: str, seconds: float = 60.0) -> Availability:
    """Run `python -m module` on a question (JSON on stdin); see the module docstring for how it answers."""
    try:
        child = subprocess.run(
            [sys.executable, "-m", module], input=question, capture_output=True, text=True, timeout=seconds, check=False
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return Availability(False, f"a tiny problem was not solved within {seconds:g} s")
    if child.returncode == 0:
        return Availability(True)
    if child.returncode < 0:
        return Availability(False, f"it ends the process ({signal.Signals(-child.returncode).name})")
    lines = (child.stdout if child.returncode == REFUSED else child.stderr).strip().splitlines()
    return Availability(False, lines[-1] if lines else f"it ends the process (exit code {child.returncode})")


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


def _try(config: Mapping[str, Any]) -> str:
    """Return why a solver does not work, "" if it does."""
    import hydra

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


if __name__ == "__main__":
    answer = _try(json.load(sys.stdin))
    print(answer)
    raise SystemExit(REFUSED if answer else 0)
