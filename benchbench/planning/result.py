"""What planning gives: a plan, and the solution of the problem that says it; either may be missing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, final

from benchbench.formulation.problem import Problem
from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.residuals import Residuals, residuals
from benchbench.nlp.homotopy import Solved
from benchbench.ocp.plan import Plan


@final
@dataclass(frozen=True)
class Solution:
    """An MPCC as it was posed in the end, and the solution that is claimed of it.

    problem: how a plan is read from it; None where the MPCC came ready-made.
    """

    mpcc: Mpcc
    solved: Solved
    problem: Problem | None = None

    @property
    def residuals(self) -> Residuals:
        """By how much the claimed solution violates the MPCC."""
        return residuals(self.mpcc, self.solved.x)


@final
@dataclass(frozen=True, kw_only=True)
class Result:
    """What planning gives.

    posed    the solution; None for a plan that was made elsewhere: no problem of ours was posed, none can be checked
    planned  the plan; None where the MPCC came ready-made and is no flight
    planner  who made a plan elsewhere
    account  what the strategy did to get there, as columns of the record
    refined  the scenario's own grid was refined because its plan was not certified; so the plan, on another grid, is the
             answer to the task, and its travel time may be compared with others'

    Strategies, which pose flights, read `solution` and `plan`, which are never None.
    """

    posed: Solution | None = None
    planned: Plan | None = None
    planner: str = ""
    account: Mapping[str, Any] = field(default_factory=dict)
    refined: bool = False

    @classmethod
    def of(cls, problem: Problem, solved: Solved) -> Result:
        """Return the plan that a solved problem says."""
        solution = Solution(problem.mpcc, solved, problem)
        return cls(posed=solution, planned=problem.decode(solved.values))

    @property
    def solution(self) -> Solution:
        """The problem and its claimed solution; raises ValueError where none was posed."""
        if self.posed is None:
            raise ValueError(f"the plan of {self.planner} poses no problem")
        return self.posed

    @property
    def plan(self) -> Plan:
        """The plan; raises ValueError where what was solved is no flight."""
        if self.planned is None:
            raise ValueError("what was solved is no flight, there is no plan in it")
        return self.planned

    @property
    def problem(self) -> Problem:
        """The problem whose solution says the plan; raises ValueError where there is none."""
        if self.solution.problem is None:
            raise ValueError("what was solved is no flight, no plan is read from it")
        return self.solution.problem

    @property
    def mpcc(self) -> Mpcc:
        """The MPCC of the solution."""
        return self.solution.mpcc

    @property
    def solved(self) -> Solved:
        """What the homotopy gave of it."""
        return self.solution.solved

    @property
    def claimed(self) -> bool:
        """Whether the solver says it succeeded."""
        return self.solved.outcome.claim == "solved"

    @property
    def objective(self) -> float:
        """Value of the cost, infinite where the solver claims no success."""
        return self.solved.outcome.objective if self.claimed else float("inf")

    def telling(self, **account: Any) -> Result:
        """The same result with more columns of its account."""
        return replace(self, account={**self.account, **account})
