"""A solve in a process of its own: it says what it says here, and nothing that it does keeps the program."""

from __future__ import annotations

import os
import signal
from typing import NoReturn

import numpy as np
import pytest

import benchbench as bb
from benchbench.ground.errors import BadInput
from benchbench.nlp.solver import Outcome, Point
from benchbench_plugins.solvers.apart import solve_apart

START = Point(np.array([1.0, 2.0]))

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="no child can be made here")


def test_it_says_what_it_says_here() -> None:
    def solve(start: Point) -> Outcome:
        assert os.getpid() != here
        return Outcome(
            "solved", Point(2 * start.x, lam_g=start.x), 3.0, 4, 5, 0.1, "fine", {"f": 0.2}, ((1.0, 2.0),)
        )

    here = os.getpid()
    told = solve_apart(solve, START, 60.0)
    assert (told.claim, told.iterations, told.detail, told.times, told.trace) == (
        "solved",
        4,
        "fine",
        {"f": 0.2},
        ((1.0, 2.0),),
    )
    np.testing.assert_array_equal(told.point.x, [2.0, 4.0])


def test_what_never_ends_is_ended() -> None:
    def solve(start: Point) -> NoReturn:
        while True:
            pass

    told = solve_apart(solve, START, 0.2)
    assert (told.claim, told.point) == ("time_limit", START)
    assert told.cpu_s == 0.2


def test_what_dies_fails_alone() -> None:
    def solve(start: Point) -> NoReturn:
        os.kill(os.getpid(), signal.SIGKILL)
        raise AssertionError

    told = solve_apart(solve, START, 60.0)
    assert told.claim == "failed"
    assert "SIGKILL" in told.detail


def test_what_it_raises_is_raised_here() -> None:
    def solve(start: Point) -> NoReturn:
        raise BadInput("solver", "no", "yes")

    with pytest.raises(BadInput, match="solver: no; allowed: yes"):
        solve_apart(solve, START, 60.0)


@pytest.mark.slow
def test_a_search_that_does_not_end_is_tried_again_with_a_coarser_rank() -> None:
    found = bb.plan("+scenario=circle", "solver=fatrop", "time_limit=30", "strategy.starts=1")
    assert found.certified, found.record["reasons"]
    assert found.record["solve_cpu_s"] > 10
    stuck = bb.plan(
        "+scenario=circle", "solver=fatrop", "+solver.options.linsol_lu_fact_tol=1e-4", "time_limit=3"
    )
    assert not stuck.certified
