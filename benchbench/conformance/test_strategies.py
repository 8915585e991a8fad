"""Every installed strategy against `checks.strategies`."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from benchbench.conformance.candidates import Configured, candidates
from benchbench.conformance.checks.strategies import CHECKS
from benchbench.errors import BadInput, Unavailable
from benchbench.planning.case import Case, Strategy
from benchbench.run import config

STRATEGIES = pytest.mark.parametrize("candidate", candidates("strategies"), ids=lambda c: c.name)


@pytest.fixture(scope="module")
def case() -> Case:
    """A target at rest on a coarse grid, from the plain guess."""
    return config.compose(
        "+scenario=static", "solver=ipopt", "guess=line", "scenario.intervals=12", "compile=never",
        "iteration_limit=500", "time_limit=600",
    )  # fmt: skip


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@STRATEGIES
def test_strategy(candidate: Configured, check: Callable[[Strategy, Case], None], case: Case) -> None:
    """One check of one strategy; one that refuses this case (made for races, reads a file) is skipped."""
    try:
        check(candidate.build(), case)
    except (BadInput, Unavailable) as reason:
        pytest.skip(str(reason))
