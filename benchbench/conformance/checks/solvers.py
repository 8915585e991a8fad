"""What is required of a solver.

structure   programs over a time axis, one row of unknowns per node, are all taken; others may be refused with
            IncompatibleCase
solves      programs over a time axis and convex ones from their guesses: claim "solved", x and objective right,
            bounds kept. Harder ones (HS071, Rosenbrock) may end otherwise if the claim says so: how much a
            solver can do is for the benchmark to measure
multipliers CasADi's signs: grad f + J^T lam_g + lam_x = 0, lam >= 0 at upper and <= 0 at lower bounds;
            a backend that has none returns None
honest      never "solved" for an infeasible, unbounded or undefined program, nor when the iterations ran out,
            which is "iteration_limit"; no exception for any of them
state       sigma is respected; the same call gives the same answer, whatever was solved before;
            a start at the solution, with its multipliers, is accepted and no more work than a cold one
pairs       with `native_pairs`: MPCCs with known solutions, pairs unrelaxed
accounts    iterations (calls of the gradient where the library does not say) and evaluations counted, CPU time,
            status text, version, native options
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from benchbench.conformance.checks.programs import Known
from benchbench.conformance.checks.relaxations import check_solution
from benchbench.conformance.checks.require import close, require
from benchbench.conformance.checks.smooth_programs import SmoothProgram
from benchbench.conformance.checks.staged_programs import (
    falls_forever,
    impossible,
    lands_at,
    tracking,
    undefined,
)
from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Mpcc, PairKind
from benchbench.nlp.program import assemble
from benchbench.nlp.relaxation import Gap, Relaxation, Relaxed
from benchbench.nlp.solver import Accuracy, Outcome, Point, Setup, Solver
from benchbench.planning.case import Case

SETUP = Setup(seconds=300.0, iterations=3000, accuracy="high", compile="never")
TRIES = 3
"""Solves of a solver that says that it is not repeatable: SLEQP's last digits decide whether it needs 6 to 8 iterations for a problem of
38 unknowns or, in one of some thousand solves, calls it a dead point."""
X_ERROR: dict[Accuracy, float] = {"low": 2e-2, "medium": 2e-3, "high": 1e-5}
"""Allowed relative error of x, much above what a KKT residual of 1e-4, 1e-6, 1e-8 gives."""


def solved(
    solver: Solver, problem: SmoothProgram, setup: Setup = SETUP, start: Point | None = None
) -> Outcome:
    """Prepare and solve once."""
    return solver.prepare(problem.mpcc, setup)(problem.sigma, start or Point(problem.mpcc.guess))


def check_solves(solver: Solver, problem: SmoothProgram) -> None:
    """A known solution, its multipliers and accounts; one that is not repeatable has `TRIES`, and all that it claims must be true."""
    for _ in range(1 if solver.repeatable else TRIES):
        outcome = solved(solver, problem)
        check_claim(problem, outcome)
        if outcome.claim == "solved":
            return
    require(False, f"{problem.name}: claims {outcome.claim} ({outcome.detail})")


def check_claim(problem: SmoothProgram, outcome: Outcome) -> None:
    """If the outcome claims to be solved, it is: x, objective, bounds, multipliers; and work was counted."""
    require(outcome.iterations >= 1, f"{problem.name}: {outcome.iterations} iterations")
    require(outcome.evaluations >= 1, f"{problem.name}: {outcome.evaluations} evaluations")
    require(outcome.cpu_s >= 0 and bool(outcome.detail), f"{problem.name}: no CPU time or status text")
    if outcome.claim != "solved":
        return
    mpcc, x = problem.mpcc, outcome.point.x
    close(x, problem.solution, 1e-5, f"{problem.name}: x")
    close(outcome.objective, problem.objective, 1e-6, f"{problem.name}: objective")
    outside = float(np.max(np.maximum(mpcc.lower - x, x - mpcc.upper)))
    require(outside <= 1e-7, f"{problem.name}: bounds violated by {outside:.1e}")
    _check_multipliers(problem, outcome.point)


def _check_multipliers(problem: SmoothProgram, point: Point) -> None:
    if point.lam_g is None or point.lam_x is None:
        return
    program, x, lam_g, lam_x = assemble(problem.mpcc, "never"), point.x, point.lam_g, point.lam_x
    _, gradient = program.gradient(x, problem.sigma)
    g, jacobian = program.jacobian(x, problem.sigma)
    residual = np.asarray(gradient).ravel() + np.asarray(jacobian.T @ lam_g).ravel() + lam_x
    scale = 1 + float(np.max(np.abs(np.concatenate([lam_g, lam_x]))))
    worst = float(np.max(np.abs(residual))) / scale
    require(worst <= 1e-5, f"{problem.name}: |grad f + J^T lam_g + lam_x| = {worst:.1e}")
    rows = np.asarray(g).ravel()
    for lam, value, low, high, what in (
        (lam_g, rows, program.lower_g, program.upper_g, "lam_g"),
        (lam_x, x, program.lower_x, program.upper_x, "lam_x"),
    ):
        _check_signs(lam / scale, value, low, high, f"{problem.name}: {what}")


def _check_signs(lam: Array, value: Array, low: Array, high: Array, what: str) -> None:
    at_upper, at_lower = high - value < 1e-4, value - low < 1e-4
    require(bool(np.all(at_upper[lam > 1e-4])), f"{what} > 0 away from an upper bound")
    require(bool(np.all(at_lower[lam < -1e-4])), f"{what} < 0 away from a lower bound")


def check_accuracy(solver: Solver) -> None:
    """Low, medium and high accuracy all solve a tracking problem, each as well as it must."""
    problem = tracking()
    for accuracy, allowed in X_ERROR.items():
        outcome = solved(solver, problem, replace(SETUP, accuracy=accuracy))
        require(outcome.claim == "solved", f"accuracy {accuracy}: claims {outcome.claim} ({outcome.detail})")
        close(outcome.point.x, problem.solution, allowed, f"accuracy {accuracy}: x")


def check_sigma(solver: Solver) -> None:
    """One prepared solver follows sigma, and answers do not depend on what was solved before."""
    problem = lands_at(1.0)
    solve, start = solver.prepare(problem.mpcc, SETUP), Point(problem.mpcc.guess)
    answers = [solve(sigma, start).point.x for sigma in (1.0, -1.0, 0.7, 1.0)]
    for x, sigma in zip(answers, (1.0, -1.0, 0.7), strict=False):
        close(x, sigma * problem.solution, 1e-5, f"x of a problem that ends at sigma = {sigma}")
    same = np.array_equal if solver.repeatable else np.allclose
    require(same(answers[0], answers[3]), "the same sigma from the same start gave another x later")


def check_warm_start(solver: Solver) -> None:
    """Starting at the solution, with and without its multipliers, is accepted and no more work than a cold start."""
    problem = tracking()
    solve = solver.prepare(problem.mpcc, SETUP)
    cold = solve(0.0, Point(problem.mpcc.guess))
    for start, what in ((cold.point, "with multipliers"), (Point(cold.point.x), "without multipliers")):
        warm = solve(0.0, start)
        require(warm.claim == "solved", f"warm start {what}: claims {warm.claim} ({warm.detail})")
        close(warm.point.x, problem.solution, 1e-5, f"warm start {what}: x")
        limit = 2 * cold.iterations + 5
        require(
            warm.iterations <= limit, f"{what}: {warm.iterations} iterations, from afar {cold.iterations}"
        )


def check_infeasible(solver: Solver) -> None:
    """A force too weak to arrive."""
    _check_not_solved(solver, impossible(), "an infeasible program")


def check_unbounded(solver: Solver) -> None:
    """An objective that falls without end."""
    _check_not_solved(solver, falls_forever(), "an unbounded program")


def check_undefined(solver: Solver) -> None:
    """NaN at the start is "invalid" or "failed"."""
    outcome = _check_not_solved(solver, undefined(), "a program that is NaN at its start")
    require(outcome.claim in ("invalid", "failed"), f"NaN at the start is claimed as {outcome.claim}")


def check_iteration_limit(solver: Solver) -> None:
    """One iteration is not enough; a few gradients of it, or a second try, may be counted."""
    outcome = solved(solver, tracking(), replace(SETUP, iterations=1))
    require(
        outcome.claim == "iteration_limit", f"after one iteration: claims {outcome.claim} ({outcome.detail})"
    )
    require(outcome.iterations <= 20, f"{outcome.iterations} iterations where one was allowed")


class Unrelaxed(Relaxation):
    """Leaves complementarity pairs as they are."""

    schedule = (0.0,)

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, gap: Gap | None) -> Relaxed:
        """The pair itself."""
        return Relaxed(ca.SX(0, 1), (), (), pairs=((g, h),), signs=False)


def check_pairs(solver: Solver, problem: Known, case: Case) -> str:
    """An MPCC with known solutions; returns what was measured."""
    return check_solution(Unrelaxed(), problem, replace(case, solver=solver))


def check_description(solver: Solver) -> None:
    """Version text and native options; more accuracy changes some option."""
    require(bool(solver.version().strip()), "version() is empty")
    low, high = (solver.native_options(Setup(accuracy=accuracy)) for accuracy in ("low", "high"))
    require(low != high, "native_options do not depend on the accuracy")
    few = solver.native_options(Setup(iterations=7))
    require(
        few != solver.native_options(Setup(iterations=8)),
        "native_options do not depend on the iteration limit",
    )


def _check_not_solved(solver: Solver, mpcc: Mpcc, what: str) -> Outcome:
    outcome = solver.prepare(mpcc, Setup(10.0, 300, "high", "never"))(0.0, Point(mpcc.guess))
    require(outcome.claim != "solved", f"{what} is claimed to be solved ({outcome.detail})")
    return outcome


CHECKS = (
    check_accuracy, check_sigma, check_warm_start, check_infeasible, check_unbounded, check_undefined,
    check_iteration_limit, check_description,
)  # fmt: skip
