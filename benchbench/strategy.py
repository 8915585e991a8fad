"""Interface of a strategy: what is done with several solves to get one plan."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from benchbench import posing
from benchbench.case import Case, Ledger, Task
from benchbench.errors import IncompatibleCase
from benchbench.formulation import Problem
from benchbench.homotopy import Solved, homotopy
from benchbench.mpcc import Mpcc
from benchbench.plan import Plan
from benchbench.posing import Made


@dataclass(frozen=True)
class Result:
    """The problem that was posed in the end, its claimed solution, and the plan it says.

    `account`: what the strategy did to get there, as columns of the record.
    """

    problem: Problem
    solved: Solved
    plan: Plan
    account: Mapping[str, Any] = field(default_factory=dict)

    @property
    def mpcc(self) -> Mpcc:
        """The MPCC of the problem."""
        return self.problem.mpcc


@dataclass(frozen=True)
class Outside:
    """A plan that was made elsewhere, by `planner`: none of our problems was posed, none can be checked."""

    plan: Plan
    planner: str


@dataclass(frozen=True)
class Answer:
    """An MPCC that came ready-made, and its claimed solution; there is no plan in it."""

    mpcc: Mpcc
    solved: Solved


class Strategy(ABC):
    """Turns a case into a plan."""

    @abstractmethod
    def solve(self, case: Case, ledger: Ledger) -> Result | Outside:
        """Return the best plan found; never judges it."""

    def answer(self, mpcc: Mpcc, case: Task, ledger: Ledger) -> Solved:
        """Return the best solution of an MPCC that is no flight; only strategies override it that need no more."""
        able = "continuation, relax, or another one that needs nothing but an MPCC"
        problem = f"'{case.names['strategy']}' plans flights, but '{case.names['scenario']}' is none"
        raise IncompatibleCase("strategy", problem, able)


def pose(problem: Problem, case: Case, ledger: Ledger, stage: str, near: Result | None = None) -> Result:
    """Solve one problem and decode it; `near`: what was found for a problem that nearly has this one's solution."""
    solved = homotopy(problem.mpcc, case, ledger, stage, near.solved if near else None)
    return Result(problem, solved, problem.decode(solved.values))


def from_phases(case: Case, ledger: Ledger, made: Made = None) -> Result:
    """Solve phases, then one step size with contacts, or gates, held at the nearest nodes; both are smooth.

    The second solve matters: the interpolated plan breaks the dynamics of the new grid, and IPOPT leaves the
    window on its way back.
    """
    start = posing.start(case, ledger, made)
    with ledger.building():
        problem = posing.phases(case, start)
    found = pose(problem, case, ledger, "guess: phases").plan
    with ledger.building():
        problem = posing.held(case, found)
    return pose(problem, case, ledger, "guess: window")
