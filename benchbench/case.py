"""A case: one choice from every family, and the bookkeeping of one run."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from benchbench.blocks import Compile
from benchbench.certificate.limits import Limits
from benchbench.dynamics import Dynamics
from benchbench.model import Model
from benchbench.relaxation import Relaxation
from benchbench.scenario import Scenario
from benchbench.solver import Accuracy, Outcome, Progress, Solver

if TYPE_CHECKING:
    from benchbench.guess import Guess
    from benchbench.strategy import Strategy


@dataclass(frozen=True)
class Case:
    """Everything that decides a run; `names` are the names of the choices, by family."""

    scenario: Scenario
    model: Model
    dynamics: Dynamics
    relaxation: Relaxation
    solver: Solver
    strategy: Strategy
    guess: Guess
    limits: Limits
    names: Mapping[str, str]
    seed: int = 0
    accuracy: Accuracy = "high"
    compile: Compile = "auto"
    time_limit: float = 300.0
    iteration_limit: int = 3000


@dataclass
class Ledger:
    """What a run has spent so far, and where its progress is shown."""

    time_limit: float
    watch: Watch | None = None
    build_cpu: float = 0.0
    solve_cpu: float = 0.0
    iterations: int = 0
    evaluations: int = 0
    began: float = field(default_factory=time.perf_counter)

    @contextmanager
    def building(self) -> Iterator[None]:
        """Count the CPU time of the body as construction, compilers' included."""
        before = _cpu()
        yield
        self.build_cpu += _cpu() - before

    def count(self, outcome: Outcome) -> None:
        """Add a solve."""
        self.solve_cpu += outcome.cpu_s
        self.iterations += outcome.iterations
        self.evaluations += outcome.evaluations

    @property
    def seconds_left(self) -> float:
        """Wall seconds left for the next solve, at least 0.1."""
        return max(self.time_limit - (time.perf_counter() - self.began), 0.1)


class Watch:
    """Where live progress goes; this one shows nothing."""

    def stage(self, name: str, shape: tuple[int, int] | None) -> Progress | None:
        """Start a stage; `shape` is where in x the durations stand (first, count). Returns the callback."""
        return None


def _cpu() -> float:
    spent = time.process_time()
    try:
        import resource
    except ImportError:  # not on Windows
        return spent
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent + children.ru_utime + children.ru_stime
