"""The waist as plain data: adding parts, guesses, hashes, evaluation."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, Pair, Slot, Variable, block, evaluate, gather, rows


def variable(
    name: str = "x", low: float = -1.0, high: float = 1.0, shape: tuple[int, int] = (3, 2)
) -> Variable:
    guess = np.linspace(low, high, shape[0] * shape[1]).reshape(shape)
    return Variable(name, np.full(shape, low), np.full(shape, high), guess)


def product(name: str = "product", factor: float = 1.0, instances: int = 2, of: str = "x") -> Block:
    z, p, s = ca.SX.sym("z", 2), ca.SX.sym("p", 1), ca.SX.sym("sigma")
    function = ca.Function(name, [z, p, s], [ca.vertcat(factor * z[0] * z[1] + p, z[0] - s)])
    numbers = np.arange(1.0, instances + 1)[:, None]
    return Block(
        name,
        function,
        (rows(of, 2, range(instances)),),
        numbers,
        np.zeros((instances, 2)),
        np.ones((instances, 2)),
    )


def example() -> Mpcc:
    pair = Pair(product("touch"), "complementarity", limit=(0.02,))
    return Mpcc((variable(),), (product(),), (), (pair,))


def test_a_block_is_made_of_a_rule() -> None:
    """Two instances of p - |row|^2 <= bound on rows 2 and 0 of x, each with its own p and bound."""
    x = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]])
    made = block(
        "far", [rows("x", 1, [4, 0]), rows("x", 1, [5, 1])], lambda a, b, p: p[0] - a**2 - b**2,
        -np.inf, [[1.0], [2.0]], parameters=np.array([[100.0], [10.0]]), unit="m^2", function="distance",
    )  # fmt: skip
    mpcc = Mpcc((variable(),), (made,))
    np.testing.assert_array_equal(evaluate(made, mpcc, x.ravel()), [[39.0], [5.0]])
    assert made.lower.tolist() == [[-np.inf]] * 2 and made.upper.tolist() == [[1.0], [2.0]]
    assert (made.name, made.function.name(), made.unit) == ("far", "distance", "m^2")
    by_name = block("far", [rows("x", 2, [2, 0])], lambda z: ca.sumsqr(z), symbols="place")
    np.testing.assert_array_equal(evaluate(by_name, mpcc, x.ravel()), [[61.0], [5.0]])
    with pytest.raises(ValueError, match="block far: 1 names for 2 slots"):
        block("far", [rows("x", 1, [0]), rows("x", 1, [1])], lambda a, b: a - b, symbols="a")


def test_parts_add_up_and_offsets_follow() -> None:
    both = Mpcc((variable("x"),), (product(),)) + Mpcc(
        (variable("y", shape=(1, 4)),), (product("second", of="y"),)
    )
    assert both.offsets == {"x": 0, "y": 6}
    assert both.size == 10
    np.testing.assert_array_equal(gather(both.constraints[1], both.offsets), [[6, 7], [8, 9]])
    assert (both + Mpcc()).digest == both.digest


def test_two_parts_must_not_define_one_variable() -> None:
    with pytest.raises(ValueError, match="'x'"):
        Mpcc((variable(),)) + Mpcc((variable(),))


def test_split_undoes_stacking() -> None:
    mpcc = Mpcc((variable("x"), variable("y", shape=(2, 1))))
    x = np.arange(8.0)
    parts = mpcc.split(x)
    assert parts["x"].shape == (3, 2) and parts["y"].shape == (2, 1)
    np.testing.assert_array_equal(np.concatenate([parts["x"].ravel(), parts["y"].ravel()]), x)


def test_guesses_are_clipped_into_the_bounds_and_others_kept() -> None:
    mpcc = Mpcc((variable("x"), variable("y")))
    moved = mpcc.start_from({"x": np.linspace(-5, 5, 6), "unknown": np.zeros(3)})
    np.testing.assert_array_equal(
        moved.split(moved.guess)["x"].ravel(), np.clip(np.linspace(-5, 5, 6), -1, 1)
    )
    np.testing.assert_array_equal(moved.split(moved.guess)["y"], mpcc.variables[1].guess)
    assert moved.digest == mpcc.digest, "a guess is not part of the problem"


def with_variable(mpcc: Mpcc, **changes: Array) -> Mpcc:
    return replace(mpcc, variables=(replace(mpcc.variables[0], **changes),))


def with_constraint(mpcc: Mpcc, **changes: object) -> Mpcc:
    return replace(mpcc, constraints=(replace(mpcc.constraints[0], **changes),))


def with_pair(mpcc: Mpcc, **changes: object) -> Mpcc:
    return replace(mpcc, pairs=(replace(mpcc.pairs[0], **changes),))


DIFFERENT = {
    "lower bound": lambda m: with_variable(m, lower=m.variables[0].lower - 1e-12),
    "upper bound": lambda m: with_variable(m, upper=m.variables[0].upper + 1e-12),
    "name of a variable": lambda m: replace(m, variables=(replace(m.variables[0], name="x"), variable("y"))),
    "function": lambda m: with_constraint(m, function=product(factor=2.0).function),
    "parameters": lambda m: with_constraint(m, parameters=m.constraints[0].parameters + 1e-12),
    "bounds of a row": lambda m: with_constraint(m, upper=m.constraints[0].upper + 1e-12),
    "which unknowns": lambda m: with_constraint(m, slots=(rows("x", 2, [0, 2]),)),
    "kind of pair": lambda m: with_pair(m, kind="vanishing"),
    "limit of pair": lambda m: with_pair(m, limit=(0.03,)),
    "known sign": lambda m: with_pair(m, sign_known=True),
    "constraint missing": lambda m: replace(m, constraints=()),
    "constraint as cost": lambda m: replace(m, constraints=(), costs=m.constraints),
}


@pytest.mark.parametrize("change", DIFFERENT)
def test_different_problems_have_different_digests(change: str) -> None:
    assert DIFFERENT[change](example()).digest != example().digest


def test_equal_problems_have_equal_digests() -> None:
    assert example().digest == example().digest


def test_evaluate_is_instance_by_instance() -> None:
    mpcc = example()
    x = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    np.testing.assert_allclose(evaluate(mpcc.constraints[0], mpcc, x, 0.5), [[2 + 1, 0.5], [12 + 2, 2.5]])


def test_pair_count() -> None:
    assert example().pairs[0].count == 2


@pytest.mark.parametrize(("low", "high"), [(1.0, 0.0), (np.nan, 1.0), (0.0, np.nan)])
def test_crossed_or_undefined_bounds_are_refused(low: float, high: float) -> None:
    with pytest.raises(ValueError, match="speed"):
        Variable("speed", np.array([[low]]), np.array([[high]]), np.zeros((1, 1)))


def test_shapes_must_agree() -> None:
    with pytest.raises(ValueError, match="one shape"):
        Variable("x", np.zeros((2, 1)), np.ones((2, 1)), np.zeros((1, 2)))


def test_rows_address_whole_rows() -> None:
    slot = rows("x", 3, [2, 0])
    assert slot.variable == "x"
    np.testing.assert_array_equal(slot.index, [[6, 7, 8], [0, 1, 2]])
    np.testing.assert_array_equal(gather(Block("b", product().function, (slot, Slot("y", np.array([[0], [1]]))),
                                               np.zeros((2, 1)), np.zeros((2, 2)), np.zeros((2, 2))),
                                         {"x": 10, "y": 100}), [[16, 17, 18, 100], [10, 11, 12, 101]])  # fmt: skip
