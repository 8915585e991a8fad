"""The bookkeeping of one run: what it has spent, and who watches."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from benchbench.mpcc.spending import collecting, cpu_s
from benchbench.nlp.program import DERIVATIVES, INTERPRETED
from benchbench.nlp.solver import Outcome, Progress

SHORTEST = 0.1
"""CPU seconds that any solve is granted."""


@dataclass(frozen=True)
class Spent:
    """CPU seconds of one solve; `functions` is None where the backend does not tell function evaluations apart.

    guess: it only made an initial guess; trace: objective and violation by iteration, as in `Outcome`.
    """

    stage: str
    total: float
    functions: float | None
    guess: bool = False
    trace: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class Milestone:
    """What is known after one solve; `solve_cpu_s` and `iterations` are sums over the run so far.

    travel_time_s is that of the point where the solver stopped, None unless it claims success. guess: the solve only
    made an initial guess.
    """

    stage: str
    sigma: float
    travel_time_s: float | None
    solve_cpu_s: float
    iterations: int
    guess: bool = False


@dataclass
class Ledger:
    """What a run has spent so far, and where its progress is shown.

    time_limit  CPU seconds of this process and of its children that have ended, from when the ledger is made
    """

    time_limit: float
    watch: Watch | None = None
    build_cpu: float = 0.0
    derivatives_cpu: float = 0.0
    interpreted: int = 0
    """Blocks of one problem that could not be compiled, at most."""
    judging_cpu: float = 0.0
    """Certificates, also those that a strategy looked at on its way."""
    verdicts: list[object] = field(default_factory=list)
    """What has been judged, see `benchbench.planning.verdict`."""
    solves: list[Spent] = field(default_factory=list)
    iterations: int = 0
    evaluations: int = 0
    repeated: bool = False
    """The run was solved before; only its times count."""
    relaxed: bool = False
    """Complementarity pairs were met, so the relaxation played a part."""
    guesses: bool = False
    """What is solved now only makes an initial guess."""
    began: float = field(default_factory=cpu_s)

    @contextmanager
    def building(self) -> Iterator[None]:
        """Count the CPU time of the body as construction, compilers' included."""
        before = cpu_s()
        with collecting() as parts:
            yield
        self.build_cpu += cpu_s() - before
        self.derivatives_cpu += parts.get(DERIVATIVES, 0.0)
        self.interpreted = max(self.interpreted, int(parts.get(INTERPRETED, 0)))

    @contextmanager
    def judging(self) -> Iterator[None]:
        """Count the CPU time of the body as certificate."""
        before = cpu_s()
        yield
        self.judging_cpu += cpu_s() - before

    @contextmanager
    def guessing(self) -> Iterator[None]:
        """Count the solves of the body as those of an initial guess."""
        before, self.guesses = self.guesses, True
        try:
            yield
        finally:
            self.guesses = before

    def count(self, outcome: Outcome, stage: str = "") -> None:
        """Add a solve."""
        functions = sum(outcome.times.values()) if outcome.times else None
        self.solves.append(Spent(stage, outcome.cpu_s, functions, self.guesses, outcome.trace))
        self.iterations += outcome.iterations
        self.evaluations += outcome.evaluations

    def step(self, stage: str, sigma: float, travel_time: float | None) -> None:
        """Tell the watch that a solve has ended; it may raise Pruned."""
        if self.watch and not self.repeated:
            step = Milestone(stage, sigma, travel_time, self.solve_cpu, self.iterations, self.guesses)
            self.watch.step(step)

    @property
    def solve_cpu(self) -> float:
        """CPU seconds of all solves."""
        return sum(one.total for one in self.solves)

    def costs(self) -> dict[str, float | int | None]:
        """Return the columns of the record that say where the CPU time went."""
        told = [one.functions for one in self.solves if one.functions is not None]
        functions = sum(told) if self.solves and len(told) == len(self.solves) else None
        guess = sum(one.total for one in self.solves if one.guess)
        return {
            "build_cpu_s": self.build_cpu,
            "derivatives_cpu_s": self.derivatives_cpu,
            "interpreted_blocks": self.interpreted,
            "solve_cpu_s": self.solve_cpu,
            "functions_cpu_s": functions,
            "linear_algebra_cpu_s": None if functions is None else max(self.solve_cpu - functions, 0.0),
            "guess_cpu_s": guess,
            "homotopy_cpu_s": sum(one.total for one in self.solves[:-1] if not one.guess),
        }

    @property
    def seconds_left(self) -> float:
        """CPU seconds left for the next solve, at least `SHORTEST`: what else runs on a machine takes nothing away."""
        return max(self.time_limit - (cpu_s() - self.began), SHORTEST)

    @property
    def over(self) -> bool:
        """Whether no time is left for another solve."""
        return self.seconds_left <= SHORTEST


class Watch:
    """Where live progress goes; this one shows nothing."""

    def step(self, step: Milestone) -> None:
        """Hear that a solve has ended. Raises Pruned to give the run up."""

    def stage(self, name: str, shape: tuple[int, int] | None) -> Progress | None:
        """Start a stage; `shape` is where in x the durations stand (first, count). Returns the callback."""
        return None
