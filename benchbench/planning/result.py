"""What planning gives: a plan with the problem it solves, a plan from elsewhere, or the solution of a ready-made MPCC."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from benchbench.formulation.handover import Problem
from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.homotopy import Solved
from benchbench.ocp.plan import Plan


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
