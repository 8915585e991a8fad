"""Interface of a strategy: what is done with several solves to get one plan."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from benchbench.case import Case, Ledger
from benchbench.formulation import Problem
from benchbench.homotopy import Solved, homotopy
from benchbench.plan import Plan


@dataclass(frozen=True)
class Result:
    """The problem that was posed in the end, its claimed solution, and the plan it says.

    `account`: what the strategy did to get there, as columns of the record.
    """

    problem: Problem
    solved: Solved
    plan: Plan
    account: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Outside:
    """A plan that was made elsewhere, by `planner`: none of our problems was posed, none can be checked."""

    plan: Plan
    planner: str


class Strategy(ABC):
    """Turns a case into a plan."""

    @abstractmethod
    def solve(self, case: Case, ledger: Ledger) -> Result | Outside:
        """Return the best plan found; never judges it."""


def pose(problem: Problem, case: Case, ledger: Ledger, stage: str) -> Result:
    """Solve one problem and decode it."""
    solved = homotopy(problem.mpcc, case, ledger, stage)
    return Result(problem, solved, problem.decode(solved.values))
