"""Residuals against a small problem whose violations are worked out by hand."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, Pair, PairKind, Variable, rows
from benchbench.mpcc.residuals import PairResidual, Residuals, residuals

SIGMA = ca.SX.sym("sigma")


def block(name: str, out: ca.SX, z: ca.SX, lower: float, upper: float, instances: int = 3) -> Block:
    """The same function on rows (a_i, b_i) of variable "ab"."""
    p = ca.SX.sym("p", 0)
    shape = (instances, out.shape[0])
    function = ca.Function(name, [z, p, SIGMA], [out])
    slots = (rows("ab", 2, range(instances)),)
    low, high = np.full(shape, lower), np.full(shape, upper)
    return Block(name, function, slots, np.zeros((instances, 0)), low, high)


def problem(kind: PairKind = "complementarity") -> Mpcc:
    """a_i + b_i <= 1 for three rows, 0 <= a_i perpendicular to b_i (- 2 where it vanishes), |a|, |b| <= 5."""
    z = ca.SX.sym("z", 2)
    h = z[1] if kind == "complementarity" else z[1] - 2
    pair = block("touch", ca.vertcat(z[0], h), z, 0, 0)
    ab = Variable("ab", np.full((3, 2), -5.0), np.full((3, 2), 5.0), np.zeros((3, 2)))
    return Mpcc((ab,), (block("sum", z[0] + z[1], z, -np.inf, 1.0),), (), (Pair(pair, kind),))


def point(*rows_: tuple[float, float]) -> Array:
    return np.array(rows_, float).ravel()


def test_a_solution_has_no_residual() -> None:
    found = residuals(problem(), point((0, 1), (1, 0), (0, 0)))
    assert found.max_violation == 0
    assert found.max_complementarity == 0


def test_bounds_and_constraints_by_name() -> None:
    found = residuals(problem(), point((0, 0.25), (5.5, 0), (0, 0)))
    assert found.bounds == 0.5
    assert found.constraints == {"sum": 4.5}
    assert found.max_violation == 4.5
    assert found.worst_constraint == "sum"
    below = residuals(problem(), point((0, 0), (0, -7), (0, 0)))
    assert (below.worst_constraint, below.bounds, below.constraints) == ("bounds", 2.0, {"sum": 0.0})
    inside = residuals(problem(), point((-4, 4), (4, -4), (-5, 5)))
    assert (inside.bounds, inside.constraints) == (0.0, {"sum": 0.0})


def test_blocks_of_one_name_are_taken_together() -> None:
    z = ca.SX.sym("z", 2)
    part = Mpcc((), (block("sum", z[0], z, 0.75, np.inf, 1), block("sum", z[1], z, 0.0, np.inf, 1)))
    assert residuals(problem() + part, point((0, 0), (0, 0), (0, 0))).constraints == {"sum": 0.75}


def test_a_complementarity_pair() -> None:
    found = residuals(problem(), point((0.25, 0.5), (0, 1), (-0.125, 0)))
    assert found.pairs == {"touch": PairResidual(negativity=0.125, natural=0.25, product=0.125)}
    assert found.max_complementarity == 0.25


def test_a_negative_partner_counts_unless_the_pair_vanishes() -> None:
    x = point((0, -0.5), (0, 0), (0, 0))
    assert residuals(problem("complementarity"), x).max_complementarity == 0.5
    assert residuals(problem("vanishing"), x).max_complementarity == 0


def test_a_vanishing_pair() -> None:
    held, free, broken = (1.0, 1.5), (0.0, 4.0), (0.25, 2.5)
    assert residuals(problem("vanishing"), point(held, free, free)).max_complementarity == 0
    found = residuals(problem("vanishing"), point(held, free, broken))
    assert found.pairs["touch"] == PairResidual(negativity=0.0, natural=0.25, product=0.125)


@pytest.mark.parametrize(
    ("kind", "g", "h", "expected"),
    [
        ("complementarity", 2.0, 0.5, PairResidual(0.0, 0.5, 1.0)),
        ("complementarity", 0.0, 3.0, PairResidual(0.0, 0.0, 0.0)),
        ("complementarity", -0.25, 1.0, PairResidual(0.25, 0.25, 0.0)),
        ("complementarity", 1.0, -0.5, PairResidual(0.5, 0.5, 0.0)),
        ("complementarity", -0.125, -0.5, PairResidual(0.5, 0.5, 0.0625)),
        ("vanishing", 2.0, 0.5, PairResidual(0.0, 0.5, 1.0)),
        ("vanishing", 0.5, 2.0, PairResidual(0.0, 0.5, 1.0)),
        ("vanishing", 1.0, -0.5, PairResidual(0.0, 0.0, 0.0)),
        ("vanishing", -0.25, 1.0, PairResidual(0.25, 0.25, 0.0)),
        ("vanishing", -0.125, -0.5, PairResidual(0.125, 0.125, 0.0)),
    ],
)
@pytest.mark.parametrize("row", [0, 2])
def test_each_number_of_a_pair(kind: PairKind, g: float, h: float, expected: PairResidual, row: int) -> None:
    """One of three instances is off, the others are at G = 0, H = 1."""
    shift = 2.0 if kind == "vanishing" else 0.0
    pairs = np.array([(0.0, 1.0 + shift)] * 3)
    pairs[row] = g, h + shift
    found = residuals(problem(kind), pairs.ravel())
    assert found.pairs == {"touch": expected}
    assert found.max_negativity == expected.negativity
    assert found.max_product == expected.product
    assert found.max_complementarity == expected.natural


def test_pairs_of_one_name_are_taken_together_number_by_number() -> None:
    """The first block of the name is worst in sign, the second in what is left over."""
    z = ca.SX.sym("z", 2)
    first = Pair(block("touch", ca.vertcat(z[0], z[1]), z, 0, 0, 1), "complementarity")
    other = Pair(block("touch", ca.vertcat(z[0] + 2, z[1]), z, 0, 0, 1), "complementarity")
    ab = problem().variables
    for pairs in ((first, other), (other, first)):
        found = residuals(Mpcc(ab, (), (), pairs), point((-1, 3), (0, 0), (0, 0)))
        assert found.pairs == {"touch": PairResidual(1.0, 1.0, 3.0)}
    for pairs in ((first, other), (other, first)):
        found = residuals(Mpcc(ab, (), (), pairs), point((-0.5, 3), (0, 0), (0, 0)))
        assert found.pairs == {"touch": PairResidual(0.5, 1.5, 4.5)}


def test_each_worst_value_is_taken_over_all_blocks() -> None:
    found = Residuals(
        0.125, {"a": 0.5, "b": 0.25}, {"c": PairResidual(3.0, 1.0, 2.0), "d": PairResidual(0, 4, 5)}
    )
    assert (found.max_violation, found.worst_constraint) == (0.5, "a")
    assert (found.max_complementarity, found.max_negativity, found.max_product) == (4.0, 3.0, 5.0)
    signs = replace(found, bounds=1.0, pairs={"c": PairResidual(3.0, 1.0, 2.0)})
    assert (signs.max_violation, signs.worst_constraint) == (1.0, "bounds")
    assert signs.max_complementarity == 3.0
    nothing = Residuals(0.0, {}, {})
    assert (nothing.max_violation, nothing.max_complementarity, nothing.max_negativity) == (0.0, 0.0, 0.0)
    assert nothing.max_product == 0.0


def test_only_relaxed_complementarity_is_not_complementarity() -> None:
    sigma = 1e-6
    found = residuals(problem(), point((1e-3, 1e-3), (0, 0), (0, 0)))
    assert found.pairs["touch"].product <= sigma * (1 + 1e-12)
    assert found.max_complementarity == 1e-3


@pytest.mark.parametrize("row", [0, 1, 2])
def test_nan_is_never_the_best(row: int) -> None:
    x = np.zeros((3, 2))
    x[row] = np.nan
    found = residuals(problem(), x.ravel())
    assert np.isnan(found.max_violation)
    assert np.isnan(found.max_complementarity)


def test_a_diverged_point_has_infinite_residuals() -> None:
    """And no warning: solvers that diverge are no fault of the program."""
    far = residuals(problem(), point((1e200, 1e200), (0, 0), (0, 0)))
    assert far.max_violation > 1e199 and far.max_product == np.inf
    unbounded = Variable("ab", np.full((3, 2), -np.inf), np.full((3, 2), np.inf), np.zeros((3, 2)))
    nowhere = replace(problem(), variables=(unbounded,))
    for x in (np.inf, -np.inf):
        assert not np.isfinite(residuals(nowhere, point((x, 0), (0, 0), (0, 0))).max_violation)


def test_a_function_that_fails_only_inside_is_seen() -> None:
    z = ca.SX.sym("z", 2)
    part = Mpcc((), (block("root", ca.sqrt(z[0] - 1), z, -np.inf, np.inf),))
    found = residuals(problem() + part, point((0, 0), (0, 0), (0, 0)))
    assert found.worst_constraint == "root"
    assert np.isnan(found.max_violation)


def test_a_block_without_instances() -> None:
    z = ca.SX.sym("z", 2)
    part = Mpcc((), (block("none", z[0], z, 1, 1, 0),))
    assert residuals(problem() + part, np.zeros(6)).constraints["none"] == 0
