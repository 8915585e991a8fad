"""Interface of a strategy: what is done with several solves to get one plan; and what strategies have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from benchbench.certificate.certificate import Certificate
from benchbench.certificate.certify import certify
from benchbench.errors import IncompatibleCase
from benchbench.formulation.handover import Problem
from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.residuals import residuals
from benchbench.nlp.homotopy import Solved, homotopy
from benchbench.ocp.plan import Plan
from benchbench.planning import posing
from benchbench.planning.case import Case, Ledger, Task
from benchbench.planning.disturb import disturbed


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


class Strategy(ABC):
    """Turns a case into a plan."""

    @abstractmethod
    def solve(self, case: Case, ledger: Ledger) -> Result | Outside:
        """Return the best plan found; the last word on it is not the strategy's."""

    def answer(self, mpcc: Mpcc, case: Task, ledger: Ledger) -> Solved:
        """Return the best solution of an MPCC that is no flight; only strategies override it that need no more."""
        able = "continuation, relax, or another one that needs nothing but an MPCC"
        problem = f"'{case.names['strategy']}' plans flights, but '{case.names['scenario']}' is none"
        raise IncompatibleCase("strategy", problem, able)


def planned(strategy: Strategy, case: Case, ledger: Ledger) -> Result:
    """Solve by another strategy; raises IncompatibleCase for one that poses no problem of ours."""
    result = strategy.solve(case, ledger)
    if isinstance(result, Outside):
        raise IncompatibleCase(
            "strategy", f"the plan of {result.planner} poses no problem", "a strategy that solves"
        )
    return result


def pose(problem: Problem, case: Case, ledger: Ledger, stage: str, near: Result | None = None) -> Result:
    """Solve one problem and decode it; `near`: what was found for a problem that nearly has this one's solution."""
    solved = homotopy(problem.mpcc, case, ledger, stage, near.solved if near else None)
    return Result(problem, solved, problem.decode(solved.values))


def from_phases(case: Case, ledger: Ledger, start: Plan) -> Result:
    """Solve phases, then one step size with contacts, or gates, held at the nearest nodes; both are smooth.

    The second solve matters: the interpolated plan breaks the dynamics of the new grid, and IPOPT leaves the
    window on its way back. It starts from the multipliers of the first, with which it takes half as many iterations.
    """
    with ledger.building():
        problem = posing.phases(case, start)
    found = pose(problem, case, ledger, "guess: phases")
    with ledger.building():
        problem = posing.held(case, found.plan)
    return pose(problem, case, ledger, "guess: window", found)


def judge(result: Result, case: Case, ledger: Ledger) -> Certificate:
    """Return the certificate of a result: the same for strategies that look at it as for the record."""
    with ledger.judging():
        found = residuals(result.problem.mpcc, result.solved.x)
        return certify(result.plan, case.scenario, case.model, case.limits, found)


def retried(
    case: Case, ledger: Ledger, attempts: int, patience: int, solve: Callable[[Case, Plan], Result]
) -> Result:
    """Solve from the guess of the case; while no success is claimed, from it undisturbed, then from disturbances.

    All but the last attempt may use at most `patience` iterations: a good start needs a tenth of that. Returns the
    last result when none succeeds, the one that had the whole iteration limit.
    """
    guessed = case.guess.plan(case, ledger)
    found: list[Result] = []
    for attempt in range(attempts):
        last = attempt == attempts - 1
        limit = case.iteration_limit if last else min(case.iteration_limit, patience)
        found.append(
            solve(replace(case, iteration_limit=limit), disturbed(guessed, case, _seed(case.seed, attempt)))
        )
        if found[-1].claimed:
            return found[-1]
        if ledger.over:
            break
    return found[-1]


def _seed(seed: int, attempt: int) -> int:
    """The case's own seed, then 0, then seeds that no user's case has."""
    if attempt == 0:
        return seed
    return 0 if attempt == 1 and seed else 10**6 + 1000 * seed + attempt
