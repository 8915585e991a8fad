"""What is active of a small MPCC and its gradients, all of which can be written down; multipliers and descent of cones by hand."""

from __future__ import annotations

import time
from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.sparse import csr_array
from small_mpccs import NONE, SIGMA, problem

from benchbench.certificate.descent import b_stationary
from benchbench.certificate.linearised import Active, Linearised, Tangent
from benchbench.certificate.multipliers import classify, weak
from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, Pair, PairKind, Variable, rows

TOL = 1e-6
INF = np.inf


def shared(name: str, out: list[Any], z: ca.SX, low: float, high: float) -> Block:
    """The same function on both rows (a, b) of the variable "ab"."""
    function = ca.Function(name, [z, NONE, SIGMA], [ca.vertcat(*out)])
    shape = (2, len(out))
    return Block(
        name,
        function,
        (rows("ab", 2, range(2)),),
        np.zeros((2, 0)),
        np.full(shape, low),
        np.full(shape, high),
    )


def two_rows(kind: PairKind = "complementarity") -> Mpcc:
    """(a, b) twice, a >= -1, b <= 100: a b <= 4 and a + b >= -9; pairs (a, a + b) and (b, a - b); then (a, b) once more."""
    z = ca.SX.sym("z", 2)
    a, b = z[0], z[1]
    ab = Variable("ab", np.tile([-1.0, -INF], (2, 1)), np.tile([INF, 100.0], (2, 1)), np.zeros((2, 2)))
    pairs = (
        Pair(shared("touch", [a, b, a + b, a - b], z, 0, 0), kind),
        Pair(shared("again", [a, b], z, 0, 0), "complementarity"),
    )
    under, over = shared("under", [a * b, a], z, -INF, 4.0), shared("over", [a + b], z, -9.0, INF)
    return Mpcc((ab,), (under, over), (shared("cost", [a + 2 * b], z, 0, 0),), pairs)


X = np.array([2.0, -1.0, 3.0, 5.0])
"""a, b; a, b."""


def test_all_that_is_bounded_in_its_order() -> None:
    local = Linearised(two_rows("vanishing"))
    under, over = [-2.0, 2.0, 15.0, 3.0], [1.0, 8.0]
    touch, again = [2.0, -1.0, 1.0, 3.0, 3.0, 5.0, 8.0, -2.0], [2.0, -1.0, 3.0, 5.0]
    expected = [*X, *under, *over, *touch, *again]
    np.testing.assert_allclose(local.values(X), expected, rtol=1e-14)
    np.testing.assert_allclose(local.values(X)[local.g], [2, -1, 3, 5, 2, 3])
    np.testing.assert_allclose(local.values(X)[local.h], [1, 3, 8, -2, -1, 5])
    assert local.vanishing.tolist() == [True] * 4 + [False] * 2
    assert local.lower.tolist() == [-1, -INF, -1, -INF, *[-INF] * 4, -9, -9, *[-INF] * 12]
    assert local.upper.tolist() == [INF, 100, INF, 100, *[4.0] * 4, INF, INF, *[INF] * 12]
    assert np.flatnonzero(local.curved).tolist() == [4, 6]  # only a b


def test_gradients_are_those_of_the_values() -> None:
    local = Linearised(two_rows())
    found = local.gradients(X).toarray()
    step = 1e-6 * np.eye(4)
    slopes = [(local.values(X + e) - local.values(X - e)) / 2e-6 for e in step]
    np.testing.assert_allclose(found, np.array(slopes).T, atol=1e-8)
    assert found.shape == (22, 4)


def flat(lower: Any = -INF, upper: Any = INF, kind: PairKind = "complementarity", **more: Any) -> Linearised:
    """One pair (x_0, x_1), bounds on x."""
    return Linearised(
        problem(
            np.zeros(3), lambda x: x[2], lambda x: [x[0]], lambda x: [x[1]], lower, upper, kind=kind, **more
        )
    )


def said(active: Active) -> tuple[list[int], list[int], list[bool], list[int]]:
    return (
        np.flatnonzero(active.floor).tolist(), np.flatnonzero(active.roof).tolist(), active.both.tolist(),
        np.flatnonzero(active.pairs).tolist(),
    )  # fmt: skip


G, H = 3, 4
"""Rows of the pair, after the three unknowns."""


@pytest.mark.parametrize(
    ("kind", "g", "h", "floor", "roof", "both", "pairs"),
    [
        ("complementarity", 0.5, 0.0, [H], [H], False, [H]),
        ("complementarity", 0.5, TOL, [H], [H], False, [H]),
        ("complementarity", 0.5, 1.01 * TOL, [], [], False, []),
        ("complementarity", 0.0, 0.5, [G], [G], False, [G]),
        ("complementarity", TOL, 0.5, [G], [G], False, [G]),
        ("complementarity", 0.0, 0.0, [], [], True, [G, H]),
        ("complementarity", TOL, TOL, [], [], True, [G, H]),
        ("vanishing", 0.5, 0.0, [], [H], False, [H]),
        ("vanishing", 0.5, -TOL, [], [H], False, [H]),
        ("vanishing", 0.5, -1.01 * TOL, [], [], False, []),
        ("vanishing", 0.0, 0.5, [G], [G], False, [G]),
        ("vanishing", 0.0, -0.5, [G], [], False, [G]),
        ("vanishing", 0.0, -TOL, [], [], True, [G, H]),
    ],
)
def test_what_is_active_of_a_pair(
    kind: PairKind, g: float, h: float, floor: list[int], roof: list[int], both: bool, pairs: list[int]
) -> None:
    assert said(flat(kind=kind).active(np.array([g, h, 9.0]), TOL)) == (floor, roof, [both], pairs)


@pytest.mark.parametrize(
    ("lower", "upper", "x", "floor", "roof"),
    [
        (2.0, 50.0, 2.0, [2], []),
        (2.0, 50.0, 2.0 + 1.9 * TOL, [2], []),  # relative above 1
        (2.0, 50.0, 2.0 + 2.1 * TOL, [], []),
        (0.5, 50.0, 0.5 + 0.9 * TOL, [2], []),  # and not below
        (0.5, 50.0, 0.5 + 1.1 * TOL, [], []),
        (-50.0, 2.0, 2.0 - 1.9 * TOL, [], [2]),
        (-50.0, 2.0, 2.0 - 2.1 * TOL, [], []),
        (-50.0, 2.0, 2.0 + 0.5, [], [2]),
        (-3.0, -3.0, -3.0, [2], [2]),
        (0.0, INF, 0.0, [2], []),
        (0.0, INF, TOL, [2], []),
        (-INF, 0.0, -TOL, [], [2]),
        (-INF, 0.0, 0.0, [], [2]),
    ],
)
def test_what_is_active_of_a_bound(
    lower: float, upper: float, x: float, floor: list[int], roof: list[int]
) -> None:
    local = flat([-INF, -INF, lower], [INF, INF, upper])
    found = local.active(np.array([1.0, 1.0, x]), TOL)
    assert said(found) == (floor, roof, [False], [])
    assert np.flatnonzero(found.rows).tolist() == sorted({*floor, *roof})


def test_a_point_is_moved_to_where_all_that_is_active_is_so_and_no_farther() -> None:
    """x_0 = 0, and x_1 + x_2 = 1 from (1e-4, 0.5, 0.7): the nearest point is half of the excess away in both."""
    local = flat(equal=lambda x: [x[1] + x[2] - 1])
    x = np.array([1e-4, 0.5, 0.7])
    active = local.active(x, 1e-3)
    np.testing.assert_allclose(local.snapped(x, active), [0.0, 0.4, 0.6], atol=1e-9)
    apart = local.active(x, 1e-6)
    assert not apart.pairs.any()
    np.testing.assert_allclose(local.snapped(x, apart), [1e-4, 0.4, 0.6], atol=1e-9)


def test_what_is_curved_is_reached_by_newtons_steps() -> None:
    """On the unit sphere, at x_1 <= 0.6 and x_0 = 0."""
    local = flat([-INF, -INF, -INF], [INF, 0.6, INF], equal=lambda x: [x[0] ** 2 + x[1] ** 2 + x[2] ** 2 - 1])
    x = np.array([1e-4, 0.6001, 0.85])
    moved = local.snapped(x, local.active(x, 1e-2))
    np.testing.assert_allclose(moved, [0.0, 0.6, 0.8], atol=1e-10)


@pytest.mark.parametrize(("near", "bound"), [(2.0001, 2.0), (1.9999, 2.0), (4.9999, 5.0), (5.0001, 5.0)])
def test_a_point_is_moved_to_the_bound_that_is_active(near: float, bound: float) -> None:
    local = flat([-INF, -INF, 2.0], [INF, INF, 5.0])
    x = np.array([0.5, 0.5, near])
    np.testing.assert_allclose(local.snapped(x, local.active(x, 1e-3)), [0.5, 0.5, bound], atol=1e-9)


@pytest.mark.parametrize("scale", [1.0, 1e-3])
def test_a_point_that_newtons_steps_only_lead_away_from_stays(scale: float) -> None:
    """x_2^2 + 1 = 0 is true nowhere: from 0.6 to -0.53, 0.67, -0.41, and 1.01, which is worst; or all that a thousandth."""
    local = flat(equal=lambda x: [x[2] ** 2 + scale**2])
    x = np.array([0.5, 0.5, 0.6 * scale])
    assert local.snapped(x, local.active(x, 1e-3)) is x


def test_without_anything_active_a_point_stays_where_it_is() -> None:
    local = flat()
    x = np.array([0.5, 0.5, 0.1])
    np.testing.assert_array_equal(local.snapped(x, local.active(x, TOL)), x)


def test_the_gradients_of_what_is_active_have_length_one() -> None:
    """At (0, 0, 4): the pair, 3 x_0 + 4 x_2 <= 16 and the equation x_2^2 = 16; x_1 + 1 >= 0 is not."""
    local = Linearised(
        problem(
            np.zeros(3), lambda x: x[0] ** 2 + 5 * x[1] - x[2], lambda x: [2 * x[0]], lambda x: [x[1]], lower=[-INF, -1, -INF],
            below=lambda x: [3 * x[0] + 4 * x[2] - 16], equal=lambda x: [x[2] ** 2 - 16],
        )
    )  # fmt: skip
    x = np.array([0.0, 0.0, 4.0])
    found = local.tangent(x, local.active(x, TOL))
    np.testing.assert_allclose(found.gradient, [0, 5, -1])
    np.testing.assert_allclose(found.rows.toarray(), [[0.6, 0, 0.8], [0, 0, 1], [1, 0, 0], [0, 1, 0]])
    assert (found.floor.tolist(), found.roof.tolist()) == (
        [False, True, False, False],
        [True, True, False, False],
    )
    assert (found.biactive.tolist(), found.vanishing.tolist(), found.affine) == ([[2, 3]], [False], False)
    assert found.independent is False  # four gradients in three dimensions


def test_short_gradients_are_made_long() -> None:
    local = flat(below=lambda x: [0.25 * x[2]])
    x = np.array([0.5, 0.5, 0.0])
    assert local.tangent(x, local.active(x, TOL)).rows.toarray().tolist() == [[0, 0, 1]]


def test_what_is_curved_counts_where_it_is_active() -> None:
    local = flat(below=lambda x: [x[2] ** 2 - 16])
    for height, affine in ((1.0, True), (4.0, False), (-4.0, False)):
        x = np.array([0.0, 0.0, height])
        assert local.tangent(x, local.active(x, TOL)).affine == affine


def test_a_row_without_a_gradient_is_left_as_it_is() -> None:
    """x_2^2 = 0 at its tip."""
    local = flat(equal=lambda x: [x[2] ** 2])
    x = np.array([0.5, 0.5, 0.0])
    found = local.tangent(x, local.active(x, TOL))
    assert found.rows.toarray().tolist() == [[0, 0, 0]]


REPEATS = [
    # bounds and rows beside the pair (x_0, x_1) at the origin, and how many rows are left with those of the pair
    ({"lower": [0.0, -INF, -INF]}, 2),
    ({"lower": [0.0, 0.0, -INF]}, 2),
    ({"upper": [0.0, INF, INF]}, 3),  # x_0 may not rise: says more
    ({"lower": [0.0, -INF, -INF], "upper": [0.0, INF, INF]}, 3),  # an equation says more
    ({"below": lambda x: [-3 * x[0]]}, 2),
    ({"below": lambda x: [3 * x[0]]}, 3),
    ({"below": lambda x: [-x[0] - x[1]]}, 3),
    ({"below": lambda x: [-x[2]]}, 3),
]


@pytest.mark.parametrize(("more", "count"), REPEATS)
def test_what_repeats_the_sign_of_a_pair_counts_once(more: dict[str, Any], count: int) -> None:
    local = flat(**more)
    found = local.tangent(np.zeros(3), local.active(np.zeros(3), TOL))
    assert found.rows.shape[0] == count
    at = found.biactive[0]
    np.testing.assert_allclose(found.rows.toarray()[at], [[1, 0, 0], [0, 1, 0]])


def test_what_is_only_near_the_gradient_of_a_pair_is_no_repeat() -> None:
    for slope, count in ((0.4, 2), (0.3, 3), (0.4 + 1e-6, 3), (0.4 + 1e-11, 2)):
        local = Linearised(
            problem(
                np.zeros(2), lambda x: x[0], lambda x: [x[0] + 0.4 * x[1]], lambda x: [x[1]],
                below=lambda x, slope=slope: [-x[0] - slope * x[1]],
            )
        )  # fmt: skip
        assert local.tangent(np.zeros(2), local.active(np.zeros(2), TOL)).rows.shape[0] == count


def test_pairs_that_repeat_each_other_are_all_kept() -> None:
    local = Linearised(problem(np.zeros(2), lambda x: x[0], lambda x: [x[0], x[0]], lambda x: [x[1], x[1]]))
    found = local.tangent(np.zeros(2), local.active(np.zeros(2), TOL))
    assert found.biactive.tolist() == [[0, 2], [1, 3]] and not found.floor.any()
    assert found.independent is False


# --- multipliers and descent of a cone -----------------------------------------------------------------------


def soon() -> float:
    return time.perf_counter() + 60.0


def cone(
    gradient: Any, matrix: Any, sides: str, biactive: Any = (), vanishing: Any = (), affine: bool = True
) -> Tangent:
    """A row for each side: > may not fall, < may not rise, = neither, . one of a pair."""
    return Tangent(
        np.array(gradient, float), csr_array(np.array(matrix, float)), np.array([s in ">=" for s in sides], bool),
        np.array([s in "<=" for s in sides], bool), np.array(biactive, np.int64).reshape(-1, 2), np.array(vanishing, bool), affine,
    )  # fmt: skip


AXES: Array = np.eye(3)
FITS = [
    # grad f, sides of the three axes, multipliers, largest component left, over max(1, |grad f|)
    ([3, -4, 2], ">==", [3, -4, 2], 0.0),
    ([3, -4, 2], "><=", [3, -4, 2], 0.0),
    ([3, -4, 2], "<><", [0, 0, 0], 1.0),
    ([0.5, 0.25, 0], "<>>", [0, 0.25, 0], 0.5),
    ([-8, 2, 0], ">>>", [0, 2, 0], 1.0),
    ([-2, 8, 0], ">>>", [0, 8, 0], 0.25),
]


@pytest.mark.parametrize(("gradient", "sides", "values", "residual"), FITS)
def test_multipliers_have_the_signs_of_their_rows(
    gradient: Any, sides: str, values: Any, residual: float
) -> None:
    found = weak(cone(gradient, AXES, sides), soon())
    assert found.residual == pytest.approx(residual, abs=1e-9)
    if residual == 0.0:
        np.testing.assert_allclose(found.values, values, atol=1e-9)
    else:
        assert all(v >= 0 for v, s in zip(found.values, sides, strict=True) if s == ">")
        assert all(v <= 0 for v, s in zip(found.values, sides, strict=True) if s == "<")


def test_the_largest_component_that_is_left_is_the_smallest_possible() -> None:
    """One row (1, 1) for a gradient (1, 0): 0.5 leaves (0.5, -0.5)."""
    found = weak(cone([1, 0], [[1, 1]], ">"), soon())
    assert found.residual == pytest.approx(0.5) and found.values == pytest.approx([0.5])
    nothing = weak(cone([0.5, 3.0], np.zeros((0, 2)), ""), soon())
    assert nothing.residual == 1.0 and nothing.values.shape == (0,)
    small = weak(cone([0.5, 0.25], np.zeros((0, 2)), ""), soon())
    assert small.residual == 0.5


CLASSES = [
    # gamma and nu are the gradient's first two entries
    ((1, 2), False, "S"), ((0, -3), False, "M"), ((-3, 0), False, "M"), ((-1, -2), False, "C"), ((-1, 2), False, "W"),
    ((2, -1), False, "W"), ((2, 0), True, "S"), ((-2, 0), True, "M"), ((0, -2), True, "M"), ((-1, -1), True, "C"),
    ((1, -1), True, "W"), ((0, 1), True, "none"),
]  # fmt: skip


@pytest.mark.parametrize(("multipliers", "vanishing", "kind"), CLASSES)
def test_the_class_of_given_multipliers(multipliers: tuple[int, int], vanishing: bool, kind: str) -> None:
    tangent = cone((*multipliers, 7), AXES, "..=", [[0, 1]], [vanishing])
    assert classify(tangent, TOL, soon()) == kind
    assert b_stationary(tangent, TOL, soon()) == ("yes" if kind == "S" else "no")
    swapped = cone((7, *multipliers), AXES, "=..", [[1, 2]], [vanishing])
    assert classify(swapped, TOL, soon()) == kind


def test_each_of_two_pairs_has_its_own_side() -> None:
    """Multipliers (-1, 0) and (0, -1): M, with another side each; beside (-1, -1) it is C, beside (1, -1) W."""
    axes = np.eye(4)
    for second, kind in (((0, -1), "M"), ((-1, -1), "C"), ((1, -1), "W"), ((2, 3), "M")):
        tangent = cone((-1, 0, *second), axes, "....", [[0, 1], [2, 3]], [False, False])
        assert classify(tangent, TOL, soon()) == kind


def test_what_is_left_counts_as_nothing_up_to_the_tolerance() -> None:
    for left, kind in ((0.9 * TOL, "S"), (1.1 * TOL, "none")):
        assert classify(cone((1, 1, left), AXES[:2], "..", [[0, 1]], [False]), TOL, soon()) == kind


DESCENTS = [
    # grad f, sides of the axes of the plane
    ((1, 1), ">>", "yes"), ((-1, 1), ">>", "no"), ((-1, 1), "<>", "yes"), ((1, 1), "<>", "no"), ((-1, -1), "<=", "yes"),
    ((5, -5), "==", "yes"),
]  # fmt: skip


@pytest.mark.parametrize(("gradient", "sides", "answer"), DESCENTS)
def test_a_descent_direction_keeps_its_sides(gradient: Any, sides: str, answer: str) -> None:
    assert b_stationary(cone(gradient, np.eye(2), sides), TOL, soon()) == answer


def test_a_decrease_counts_above_the_tolerance_relative_to_the_gradient() -> None:
    """Along the third axis, which nothing bounds, the cost falls by `slope`; |grad f|_1 is 10 besides."""
    for gradient, slope, answer in (
        ((4.0, 6.0), 9e-6, "yes"), ((4.0, 6.0), 11e-6, "no"), ((0.04, 0.06), 0.9e-6, "yes"), ((0.04, 0.06), 1.1e-6, "no"),
    ):  # fmt: skip
        assert b_stationary(cone((*gradient, -slope), AXES[:2], ">>"), TOL, soon()) == answer


def test_a_descent_of_a_curved_set_is_sure_only_where_gradients_are_independent() -> None:
    one = cone((-1, 0), [[0, 1]], ">", affine=False)
    assert b_stationary(one, TOL, soon()) == "no"
    double = cone((-1, 0), [[0, 1], [0, 1]], ">>", affine=False)
    assert b_stationary(double, TOL, soon()) == "undecided"
    assert b_stationary(cone((-1, 0), [[0, 1], [0, 1]], ">>"), TOL, soon()) == "no"
