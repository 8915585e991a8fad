"""Interface of a solver backend, and what it claims."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

from benchbench.assemble import Program
from benchbench.plan import Array

Claim = Literal["solved", "infeasible", "iteration_limit", "time_limit", "invalid", "failed"]
Progress = Callable[[int, Array, float], None]
"""Called with iteration, x (n,) and the worst constraint violation while a solver works."""


@dataclass(frozen=True)
class Point:
    """Where to start: x (n,), and multipliers of constraints and bounds when known."""

    x: Array
    lam_g: Array | None = None
    lam_x: Array | None = None


@dataclass(frozen=True)
class Outcome:
    """What a backend claims; nothing here is trusted.

    `detail` is the backend's own status text, `evaluations` the calls of objective, constraints, their
    derivatives and the Hessian.
    """

    claim: Claim
    point: Point
    objective: float
    iterations: int
    evaluations: int
    cpu_s: float
    detail: str = ""
    times: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Budget:
    """What one solve may use: wall seconds and iterations."""

    seconds: float
    iterations: int


Prepared = Callable[[float, Point, Budget], Outcome]


class Solver(ABC):
    """A nonlinear programming backend."""

    native_pairs: bool = False
    """Whether it takes complementarity pairs as they are."""

    @abstractmethod
    def prepare(self, program: Program, progress: Progress | None = None) -> Prepared:
        """Return a callable (sigma, start, budget) -> Outcome; all construction cost belongs here."""

    @abstractmethod
    def version(self) -> str:
        """Name and version of the library behind it."""
