"""Every installed relaxation against `checks.relaxations`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from benchbench.conformance.candidates import Configured, candidates
from benchbench.conformance.checks.programs import Known, known
from benchbench.conformance.checks.relaxations import CHECKS, check_solution
from benchbench.ground.errors import Unavailable
from benchbench.nlp.relaxation import Relaxation, relax
from benchbench.nlp.solver import Setup, Solver
from benchbench.planning.case import Case
from benchbench.run import config

RELAXATIONS = pytest.mark.parametrize("candidate", candidates("relaxations"), ids=lambda c: c.name)


@pytest.fixture(scope="module")
def case() -> Case:
    """Any case; its solver is IPOPT."""
    return config.compose("+scenario=static", "solver=ipopt", "compile=never", "iteration_limit=300")


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@RELAXATIONS
def test_relaxation(candidate: Configured, check: Callable[[Relaxation], None]) -> None:
    """One check of one relaxation."""
    check(candidate.build())


@pytest.mark.parametrize("problem", known(), ids=lambda p: p.name)
@RELAXATIONS
def test_solution(
    candidate: Configured, problem: Known, case: Case, record_property: Callable[[str, object], None]
) -> None:
    """Known solutions; a relaxation that leaves pairs needs a solver that takes them."""
    relaxation: Relaxation = candidate.build()
    if relax(problem.mpcc, relaxation).pairs:
        case = replace(case, solver=solver_for_pairs())
    record_property("measured", f"{candidate.name}, {check_solution(relaxation, problem, case)}")


def solver_for_pairs() -> Solver:
    """Build the first available solver with `native_pairs`; skip the test when there is none."""
    missing = ["no installed solver takes pairs"]
    for candidate in candidates("solvers"):
        if getattr(candidate.kind, "native_pairs", False):
            solver: Solver = candidate.build()
            try:
                solver.prepare(known()[0].mpcc, Setup(compile="never"))
                return solver
            except Unavailable as reason:
                missing.append(f"{candidate.name}: {reason}")
    pytest.skip(f"unavailable: {'; '.join(missing)}")
