"""Interface of a solver backend, and what it claims."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal

from benchbench.ground.arrays import Array
from benchbench.ground.errors import IncompatibleCase
from benchbench.mpcc.derivatives import Compile
from benchbench.mpcc.problem import Mpcc

Accuracy = Literal["low", "medium", "high"]
TOLERANCE: dict[Accuracy, float] = {"low": 1e-4, "medium": 1e-6, "high": 1e-8}
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
    derivatives and the Hessian, `times` their CPU seconds by function; empty where the backend does not tell.
    `trace` is the objective and the worst constraint violation at each iteration, from the start on; empty likewise.
    """

    claim: Claim
    point: Point
    objective: float
    iterations: int
    evaluations: int
    cpu_s: float
    detail: str = ""
    times: Mapping[str, float] = field(default_factory=dict)
    trace: tuple[tuple[float, float], ...] = ()


Warmth = Literal["no", "near", "prolongated"]


@dataclass(frozen=True)
class Setup:
    """What a backend is told before it builds; each maps it onto its own option names.

    seconds, iterations  limits of each solve; seconds of CPU, but for libraries that have a wall clock only
    accuracy             "low", "medium", "high" ask for KKT residuals of about 1e-4, 1e-6, 1e-8
    warm                 what the starts bring: no multipliers; those of nearly the same problem; those of another grid
    """

    seconds: float = 300.0
    iterations: int = 3000
    accuracy: Accuracy = "high"
    compile: Compile = "auto"
    progress: Progress | None = None
    warm: Warmth = "no"


Prepared = Callable[[float, Point], Outcome]
Parametric = Callable[[Mpcc, Point], Outcome]


class Solver(ABC):
    """A nonlinear programming backend; with `native_pairs` it also takes complementarity pairs unrelaxed."""

    native_pairs: ClassVar[bool] = False
    repeatable: ClassVar[bool] = True
    """Whether the same start gives the same answer bit by bit; otherwise to the accuracy asked for."""

    @abstractmethod
    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        """Return a callable (sigma, start) -> Outcome; all construction cost belongs here.

        mpcc has no pairs left (they were relaxed), or with `native_pairs` perhaps pairs of kind
        "complementarity". Raises Unavailable when the library is not there.
        """

    def prepare_parametric(self, mpcc: Mpcc, setup: Setup, adjustable: Collection[str]) -> Parametric:
        """Return a callable (problem, start) -> Outcome that builds nothing again, unless overridden: none.

        The problems differ from `mpcc` in bounds, guesses and parameters of the blocks named in `adjustable`;
        the starts are near solutions, with their multipliers.
        """
        raise IncompatibleCase("solver", f"'{type(self).__name__}' builds each problem anew", "ipopt")

    @abstractmethod
    def native_options(self, setup: Setup) -> dict[str, Any]:
        """Return what accuracy and limits become in the backend's own option names; `options` win."""

    @abstractmethod
    def version(self) -> str:
        """Name and version of the library behind it."""
