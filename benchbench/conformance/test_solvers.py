"""Every installed solver against `checks.solvers`; one whose library is missing is skipped with its reason."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from benchbench.conformance.candidates import Configured, candidates
from benchbench.conformance.checks.programs import Known, known
from benchbench.conformance.checks.smooth_programs import SmoothProgram, convex, hard
from benchbench.conformance.checks.solvers import CHECKS, check_claim, check_pairs, check_solves, solved
from benchbench.conformance.checks.staged_programs import lands_at, rest_to_rest, tracking
from benchbench.ground.errors import IncompatibleCase, Unavailable
from benchbench.nlp.solver import Setup, Solver
from benchbench.run import config

SOLVERS = pytest.mark.parametrize("candidate", candidates("solvers"), ids=lambda c: c.name)


def available(candidate: Configured) -> Solver:
    """Build the solver; skip the test when `prepare` says that it is unavailable."""
    solver: Solver = candidate.build()
    try:
        solver.prepare(tracking().mpcc, Setup(compile="never"))
    except Unavailable as reason:
        pytest.skip(f"unavailable: {reason}")
    return solver


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@SOLVERS
def test_solver(candidate: Configured, check: Callable[[Solver], None]) -> None:
    """One check of one solver."""
    check(available(candidate))


@pytest.mark.parametrize("problem", known(), ids=lambda p: p.name)
@pytest.mark.parametrize(
    "candidate",
    [c for c in candidates("solvers") if getattr(c.kind, "native_pairs", False)],
    ids=lambda c: c.name,
)
def test_pairs(candidate: Configured, problem: Known, record_property: Callable[[str, object], None]) -> None:
    """MPCCs for solvers that take pairs."""
    case = config.compose("+scenario=static", "compile=never", "iteration_limit=300")
    record_property("measured", f"{candidate.name}, {check_pairs(available(candidate), problem, case)}")


@pytest.mark.parametrize("problem", [rest_to_rest(), lands_at(0.7), tracking()], ids=lambda p: p.name)
@SOLVERS
def test_solves(candidate: Configured, problem: SmoothProgram) -> None:
    """Known solutions, programs over a time axis."""
    check_solves(available(candidate), problem)


@pytest.mark.parametrize("problem", convex(), ids=lambda p: p.name)
@SOLVERS
def test_solves_without_structure(candidate: Configured, problem: SmoothProgram) -> None:
    """Known solutions, convex programs of any form; a solver that needs stages may refuse them."""
    solver = available(candidate)
    try:
        check_solves(solver, problem)
    except IncompatibleCase as reason:
        pytest.skip(f"incompatible: {reason}")


@pytest.mark.parametrize("problem", hard(), ids=lambda p: p.name)
@SOLVERS
def test_hard(candidate: Configured, problem: SmoothProgram) -> None:
    """Solved, or an honest claim."""
    solver = available(candidate)
    try:
        outcome = solved(solver, problem)
    except IncompatibleCase as reason:
        pytest.skip(f"incompatible: {reason}")
    check_claim(problem, outcome)
    if outcome.claim != "solved":
        pytest.skip(f"honest: claims {outcome.claim} ({outcome.detail})")
