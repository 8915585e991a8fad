"""The loop over sigma, driven by a solver that does what it is told: which sigmas, from where, and what is returned."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from small_mpccs import by_hand, problem

from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, Variable
from benchbench.nlp.homotopy import Path, Solved, homotopy
from benchbench.nlp.ledger import SHORTEST, Ledger
from benchbench.nlp.method import Method
from benchbench.nlp.solver import Claim, Outcome, Point, Prepared, Setup, Solver
from benchbench.nlp.warm_start import carried
from benchbench_plugins.relaxations.augmented_lagrangian import AugmentedLagrangian
from benchbench_plugins.relaxations.scholtes import Scholtes

MPCC = next(small.mpcc for small in by_hand() if small.name == "ralph2")
"""Two unknowns, which are the pair: their product is that of the pair."""


class Scripted(Solver):
    """Claims what it is told, at the points it is told, and remembers what it was asked."""

    def __init__(self, *script: tuple[Claim, Sequence[float]]) -> None:
        self.script = list(script)
        self.sigmas: list[float] = []
        self.starts: list[Point] = []
        self.problems: list[Mpcc] = []

    def native_options(self, setup: Setup) -> dict[str, Any]:
        return {}

    def version(self) -> str:
        return "1"

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        def solve(sigma: float, start: Point) -> Outcome:
            claim, x = self.script[len(self.sigmas)]
            self.sigmas.append(sigma)
            self.starts.append(start)
            self.problems.append(mpcc)
            whole = np.concatenate([x, mpcc.guess[len(x) :]])
            return Outcome(claim, Point(whole), 0.0, 1, 1, 0.0, claim)

        return solve


def solve(solver: Scripted, path: Path | None = None, near: Solved | None = None, **changes: Any) -> Solved:
    relaxation = changes.pop("relaxation", Scholtes(schedule=(1.0, 0.1, 0.01)))
    method = Method(
        relaxation=relaxation, solver=solver, names={"solver": "x", "relaxation": "x"}, compile="never"
    )
    return homotopy(MPCC, method, changes.pop("ledger", Ledger(60.0)), "test", near, path)


def starts(solver: Scripted) -> list[list[float]]:
    return [start.x[:2].tolist() for start in solver.starts]


GUESS = MPCC.guess.tolist()
A, B, C, D = [0.5, 0.5], [0.25, 0.5], [0.125, 0.5], [0.0, 1.0]


def test_every_sigma_in_order_each_from_the_last_good_point() -> None:
    """What went wrong is no start; what ran out of iterations is."""
    solver = Scripted(("solved", A), ("infeasible", B), ("solved", C))
    found = solve(solver)
    assert solver.sigmas == [1.0, 0.1, 0.01]
    assert starts(solver) == [GUESS, A, A]
    assert (found.sigma, found.x.tolist()) == (0.01, C)
    solver = Scripted(("solved", A), ("iteration_limit", B), ("failed", C))
    found = solve(solver)
    assert starts(solver) == [GUESS, A, B]
    assert (found.outcome.claim, found.x.tolist()) == ("failed", C)


@pytest.mark.parametrize("at", [0, 1])
def test_a_point_with_one_number_missing_is_none(at: int) -> None:
    spoiled = list(B)
    spoiled[at] = np.nan
    solver = Scripted(("solved", A), ("solved", spoiled), ("solved", C))
    solve(solver)
    assert starts(solver)[2] == A
    found = solve(Scripted(("solved", A), ("solved", B), ("solved", spoiled)))
    assert (found.outcome.claim, found.x.tolist()) == ("invalid", B)


def test_spent_time_stops() -> None:
    solver = Scripted(("solved", A), ("time_limit", B))
    assert solve(solver).outcome.claim == "time_limit"
    assert solver.sigmas == [1.0, 0.1]
    solver = Scripted(("solved", A))
    found = solve(solver, ledger=Ledger(0.0))
    assert found.outcome.claim == "time_limit" and "0.1" in found.outcome.detail
    assert found.x.tolist() == A
    last = solve(Scripted(("solved", A)), relaxation=Scholtes(schedule=(1.0,)), ledger=Ledger(0.0))
    assert last.outcome.claim == "solved"


def test_time_is_spent_by_working_not_by_waiting() -> None:
    """On a loaded machine a run waits for its turn; that is none of its time."""
    ledger = Ledger(SHORTEST + 0.05)
    time.sleep(0.1)
    assert not ledger.over
    until = time.process_time() + 0.06
    while time.process_time() < until:
        pass
    assert ledger.over


def test_a_failed_sigma_is_reached_for_over_the_geometric_mean() -> None:
    """From the last point solved; with the retries used up the next ones go on as ever."""
    script: list[tuple[Claim, Sequence[float]]] = [
        ("solved", A),
        ("infeasible", B),
        ("solved", C),
        ("solved", D),
    ]
    solver = Scripted(*script)
    found = solve(solver, Path((1.0, 0.01), retries=1))
    assert solver.sigmas == pytest.approx([1.0, 0.01, 0.1, 0.01])
    assert starts(solver) == [GUESS, A, A, C]
    assert (found.sigma, found.x.tolist()) == (0.01, D)
    solver = Scripted(("solved", A), ("infeasible", B), ("infeasible", C), ("infeasible", D))
    found = solve(solver, Path((1.0, 0.01), retries=1))
    assert solver.sigmas == pytest.approx([1.0, 0.01, 0.1, 0.01])
    assert (found.outcome.claim, found.x.tolist(), found.sigma) == ("infeasible", A, 1.0)
    solver = Scripted(("infeasible", A), ("infeasible", B))
    solve(solver, Path((1.0, 0.01), retries=1))
    assert solver.sigmas == [1.0, 0.01], "nothing was solved that one could go back to"


@pytest.mark.parametrize(
    ("enough", "solves"), [(0.5, 1), (0.25, 1), (0.2, 2), (0.125, 2), (0.1, 3), (0.0, 3)]
)
def test_a_path_ends_where_products_are_small_enough(enough: float, solves: int) -> None:
    """Products are 0.25, 0.125 and 0.0625."""
    solver = Scripted(("solved", A), ("solved", B), ("solved", C))
    found = solve(solver, Path((1.0, 0.1, 0.01), enough=enough))
    assert len(solver.sigmas) == solves
    assert found.outcome.claim == "solved"


def test_what_is_near_a_solution_takes_the_last_sigma_and_the_multipliers() -> None:
    before = solve(Scripted(("solved", A), ("solved", B), ("solved", C)))
    assert before.relaxed is not None
    lam_g, lam_x = np.arange(3.0), np.array([5.0, 6.0])
    outcome = Outcome("solved", Point(before.outcome.point.x, lam_g, lam_x), 0.0, 1, 1, 0.0)
    solver = Scripted(("solved", D))
    solve(solver, near=Solved(outcome, before.values, before.x, before.sigma, before.relaxed))
    assert solver.sigmas == [0.01]
    start = solver.starts[0]
    assert start.lam_g is not None and start.lam_x is not None
    np.testing.assert_array_equal(start.lam_g, lam_g)
    np.testing.assert_array_equal(start.lam_x, lam_x)


def test_held_unknowns_move_after_success_only() -> None:
    """Multiplier estimates of the augmented Lagrangian: m <- m + G H / sigma, with G H = 0.25, then 0.125."""
    for claim, moved in (("solved", True), ("iteration_limit", False)):
        solver = Scripted((claim, A), ("solved", B))  # type: ignore[arg-type]
        solve(solver, relaxation=AugmentedLagrangian(schedule=(1.0, 1.0)))
        held = [problem.split(problem.guess)["touch_held"].item() for problem in solver.problems]
        assert (held[1] != held[0]) == moved


# --- multipliers of one problem for another ------------------------------------------------------------------


def rows_of(count: int, width: int, name: str = "row", variable: str = "x", room: float = 0.0) -> Mpcc:
    """A variable and a block of `count` rows of that width; room: between their bounds, 0: equations."""
    values = np.zeros((count, width))
    function = problem([0.0], lambda x: x[0], lambda x: [x[0]], lambda x: [x[0]]).costs[0].function
    block = Block(name, function, (), np.zeros((count, 0)), values, values + room)
    return Mpcc((Variable(variable, values, values, values),), (block,))


def along(solved: Mpcc, mpcc: Mpcc) -> tuple[Array, Array]:
    """What is carried over of multipliers 1, 2, 3, ... of rows and -1, -2, ... of bounds."""
    lam = np.arange(1.0, solved.size + 1)
    start = carried(mpcc, solved, Point(solved.guess, lam, -lam))
    assert start.lam_g is not None and start.lam_x is not None
    return start.lam_g, start.lam_x


@pytest.mark.parametrize(
    ("count", "expected"), [(3, [1, 2, 3]), (6, [1, 1, 2, 2, 3, 3]), (1, [2]), (2, [1, 3]), (4, [1, 2, 2, 3])]
)
def test_multipliers_come_from_the_same_share_of_the_way(count: int, expected: list[float]) -> None:
    """The middle of each new row decides; a middle on an edge takes the later row."""
    lam_g, lam_x = along(rows_of(3, 1), rows_of(count, 1))
    np.testing.assert_array_equal(lam_g, expected)
    np.testing.assert_allclose(lam_x, -np.array(expected) * 3 / count)


def test_inequalities_share_their_multipliers_among_more_rows_and_equations_do_not() -> None:
    """The sum along the way stays: a limit that binds for a second costs the same on any grid. An adjoint is a value."""
    for count in (3, 6, 12):
        (bound, _), (adjoint, _) = (
            along(rows_of(3, 2, room=r), rows_of(count, 2, room=r)) for r in (1.0, 0.0)
        )
        assert bound.sum() == pytest.approx(1 + 2 + 3 + 4 + 5 + 6)
        assert adjoint.reshape(count, 2)[-1] == pytest.approx([5, 6])


def test_multipliers_need_the_same_name_and_width() -> None:
    lam_g, lam_x = along(rows_of(2, 2), rows_of(2, 2))
    np.testing.assert_array_equal(lam_g, [1, 2, 3, 4])
    for other in (rows_of(2, 3), rows_of(2, 2, "other", "y"), rows_of(2, 1)):
        lam_g, lam_x = along(rows_of(2, 2), other)
        assert not lam_g.any() and not lam_x.any()
        assert lam_g.shape == lam_x.shape == (other.size,)
    several = rows_of(2, 1) + rows_of(3, 1, "more", "y")
    lam_g, _ = along(several, rows_of(3, 1, "more", "y") + rows_of(2, 1))
    np.testing.assert_array_equal(lam_g, [3, 4, 5, 1, 2])
    no_multipliers = carried(rows_of(2, 1), rows_of(2, 1), Point(np.zeros(2)))
    assert no_multipliers.lam_g is None and no_multipliers.lam_x is None
