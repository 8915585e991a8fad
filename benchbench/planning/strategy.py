"""What strategies have in common: pose and solve, judge, retry."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from benchbench.certificate.certificate import Certificate
from benchbench.formulation.problem import Problem
from benchbench.ground.errors import IncompatibleCase
from benchbench.nlp.homotopy import homotopy
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.planning.case import AnyCase, Case, Strategy
from benchbench.planning.disturb import disturbed
from benchbench.planning.result import Result
from benchbench.planning.verdict import judged
from benchbench.transcription.prolongation import prolongation


def planned(strategy: Strategy, case: Case, ledger: Ledger) -> Result:
    """Solve by another strategy; raises IncompatibleCase for one that poses no problem of ours."""
    result = strategy.solve(case, ledger)
    if result.posed is None:
        raise IncompatibleCase(
            "strategy", f"the plan of {result.planner} poses no problem", "a strategy that solves"
        )
    return result


def pose(problem: Problem, case: Case, ledger: Ledger, stage: str, near: Result | None = None) -> Result:
    """Solve one problem and decode it; `near`: what was found for a problem that nearly has this one's solution."""
    if near is None:
        return Result.of(problem, homotopy(problem.mpcc, case, ledger, stage))
    between = prolongation(near.problem.trajectory.grid, problem.trajectory.grid)
    solved = homotopy(problem.mpcc, case, ledger, stage, near.solved, between=between)
    return Result.of(problem, solved)


def judge(result: Result, case: AnyCase, ledger: Ledger) -> Certificate:
    """Return the certificate of a result: the same for strategies that look at it as for the record, which takes it once."""
    with ledger.judging():
        return judged(result, case, ledger)


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
            solve(
                replace(case, iteration_limit=limit), disturbed(guessed, case, start_seed(case.seed, attempt))
            )
        )
        if found[-1].claimed:
            return found[-1]
        if ledger.over:
            break
    return found[-1]


def start_seed(seed: int, attempt: int) -> int:
    """Return the seed of the disturbance of each attempt, from 0 on: the case's own seed, then 0, then seeds that no user's case has."""
    if attempt == 0:
        return seed
    return 0 if attempt == 1 and seed else 10**6 + 1000 * seed + attempt
