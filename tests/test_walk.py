"""The instruction walker against CasADi's own evaluation."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest

from benchbench.formulation.handover import free_contact, phases
from benchbench.mpcc.problem import Block, Mpcc, evaluate, gather
from benchbench.planning.guess import straight_line
from benchbench.run.config import compose
from benchbench_plugins.solvers.walk import ALGEBRA, NUMBERS, Inexpressible, record

UNARY: dict[str, Callable[[Any], Any]] = {
    "twice": lambda a: 2 * a, "sq": lambda a: a * a, "inv": lambda a: 1 / a, "neg": operator.neg,
    "exp": ca.exp, "log": ca.log, "sqrt": ca.sqrt, "log1p": ca.log1p, "expm1": ca.expm1, "erf": ca.erf,
    "sin": ca.sin, "cos": ca.cos, "tan": ca.tan, "asin": ca.asin, "acos": ca.acos, "atan": ca.atan,
    "sinh": ca.sinh, "cosh": ca.cosh, "tanh": ca.tanh, "asinh": ca.asinh, "atanh": ca.atanh,
    "acosh": lambda a: ca.acosh(a + 1), "fabs": ca.fabs, "sign": ca.sign, "floor": ca.floor, "ceil": ca.ceil,
    "constpow": lambda a: a**2.5, "not": ca.logic_not,
}  # fmt: skip
BINARY: dict[str, Callable[[Any, Any], Any]] = {
    "add": operator.add, "sub": operator.sub, "mul": operator.mul, "div": operator.truediv,
    "pow": operator.pow, "fmod": ca.fmod, "hypot": ca.hypot, "atan2": ca.atan2, "copysign": ca.copysign,
    "fmin": ca.fmin, "fmax": ca.fmax, "lt": operator.lt, "le": operator.le, "eq": ca.eq, "ne": ca.ne,
    "and": ca.logic_and, "or": ca.logic_or, "if_else_zero": lambda a, b: ca.if_else(a < b, a, 0),
}  # fmt: skip
OPERATIONS = {**UNARY, **BINARY, "acosh": ca.acosh, "constpow": operator.pow, "assign": lambda a: a,
              "if_else_zero": lambda c, a: ca.if_else(c, a, 0)}  # fmt: skip
"""Walking over CasADi symbols: they are no numbers, so this is the way that modelling languages go."""


def numbers(function: ca.Function, inputs: list[np.ndarray]) -> np.ndarray:
    return np.asarray(ca.densify(function(*inputs))).ravel(order="F")


@pytest.mark.parametrize("name", [*UNARY, *BINARY])
def test_every_operation(name: str) -> None:
    x = ca.SX.sym("x", 2)
    made = UNARY[name](x[0]) if name in UNARY else BINARY[name](x[0], x[1])
    function = ca.Function("f", [x], [made])
    tape = record(function)
    assert name in {step.name for step in tape.steps}
    for point in np.random.default_rng(0).uniform(0.05, 0.95, (20, 2)):
        wanted = numbers(function, [point])
        assert tape.run([list(point)], {})[0] == pytest.approx(wanted, rel=1e-14, abs=1e-300)
        symbol = ca.SX.sym("y", 2)
        again = ca.Function("g", [symbol], [ca.vertcat(*tape.run([[symbol[0], symbol[1]]], OPERATIONS)[0])])
        assert numbers(again, [point]) == pytest.approx(wanted, rel=1e-14, abs=1e-300)


def test_no_operation_is_untested() -> None:
    assert set(NUMBERS) - {"assign"} == set(UNARY) | set(BINARY)


@pytest.mark.parametrize("seed", range(25))
def test_random_graphs(seed: int) -> None:
    """Graphs of 60 operations with repeated use, some inputs numbers, some symbols."""
    rng = np.random.default_rng(seed)
    x, p = ca.SX.sym("x", 4), ca.SX.sym("p", 3)
    values = [*ca.vertsplit(x), *ca.vertsplit(p), ca.SX(0.0), ca.SX(1.0), ca.SX(0.7)]
    smooth = [
        "sin",
        "cos",
        "tanh",
        "neg",
        "sq",
        "twice",
        "atan",
        "fabs",
        "add",
        "sub",
        "mul",
        "fmin",
        "fmax",
        "hypot",
    ]
    for _ in range(60):
        name = str(rng.choice(smooth))
        chosen = [values[i] for i in rng.integers(len(values), size=2)]
        values.append(UNARY[name](chosen[0]) if name in UNARY else BINARY[name](*chosen))
    function = ca.Function("f", [x, p], [ca.vertcat(*values[-8:])])
    tape = record(function)
    parameters = rng.choice([0.0, 1.0, -0.3, 2.0], 3).tolist()
    symbol = ca.SX.sym("y", 4)
    again = ca.Function(
        "g", [symbol], [ca.vertcat(*tape.run([ca.vertsplit(symbol), parameters], OPERATIONS)[0])]
    )
    for point in rng.normal(size=(5, 4)):
        wanted = numbers(function, [point, np.array(parameters)])
        assert np.array(tape.run([list(point), parameters], {})[0]) == pytest.approx(
            wanted, rel=1e-12, abs=1e-12
        )
        assert numbers(again, [point]) == pytest.approx(wanted, rel=1e-12, abs=1e-12)


def handover(problem: str) -> Mpcc:
    case = compose("+scenario=circle", "scenario.intervals=10")
    return (phases if problem == "phases" else free_contact)(case, straight_line(case)).mpcc


@pytest.mark.parametrize("problem", ["phases", "free_contact"])
def test_blocks_of_a_handover(problem: str) -> None:
    """All instances at once: entries are arrays."""
    mpcc = handover(problem)
    x = mpcc.guess + 0.1 * np.random.default_rng(1).normal(size=mpcc.size)
    blocks: list[Block] = [*mpcc.constraints, *mpcc.costs, *(pair.block for pair in mpcc.pairs)]
    for block in blocks:
        columns = list(x[gather(block, mpcc.offsets)].T)
        out = record(block.function).run([columns, list(block.parameters.T), [0.3]], {})[0]
        found = np.stack([np.broadcast_to(column, block.instances) for column in out], axis=1)
        assert found == pytest.approx(evaluate(block, mpcc, x, 0.3), rel=1e-11, abs=1e-11), block.name


def test_sparse_inputs_and_outputs() -> None:
    x = ca.SX.sym("x", ca.Sparsity.triplet(3, 1, [0, 2], [0, 0]))
    function = ca.Function("f", [x], [ca.diag(ca.vertcat(x[0], x[2]))])
    assert record(function).run([[3.0, 5.0, 7.0]], {})[0] == [3.0, 0.0, 0.0, 7.0]


def test_mx_functions_are_expanded() -> None:
    x = ca.MX.sym("x", 2)
    function = ca.Function("f", [x], [ca.norm_2(x) * x])
    assert record(function).run([[3.0, 4.0]], {})[0] == pytest.approx([15.0, 20.0])


def test_parameters_select_without_a_trace() -> None:
    """0 a + 1 b is b itself, as with phase weights."""
    x, p = ca.SX.sym("x", 2), ca.SX.sym("p", 2)
    a, b = object(), object()
    assert record(ca.Function("f", [x, p], [ca.dot(p, x)])).run([[a, b], [0.0, 1.0]], ALGEBRA) == [[b]]


def test_share_sees_what_is_used_twice() -> None:
    x = ca.SX.sym("x")
    repeated = ca.sin(x)
    tape = record(ca.Function("f", [x], [ca.cos(repeated) + repeated]))
    seen: list[ca.SX] = []
    symbol = ca.SX.sym("y")
    tape.run([[symbol]], OPERATIONS, lambda value: seen.append(value) or value)
    assert len(seen) == 1
    assert float(ca.Function("g", [symbol], seen)(0.3)) == pytest.approx(np.sin(0.3))


def test_missing_operation_is_named() -> None:
    x = ca.SX.sym("x")
    with pytest.raises(Inexpressible, match="fmax"):
        record(ca.Function("f", [x], [ca.fmax(x, 1)])).run([[object()]], ALGEBRA)
    assert record(ca.Function("f", [x], [ca.fmax(x, 1)])).run([[0.5]], ALGEBRA) == [[1.0]]


def test_reads() -> None:
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    tape = record(ca.Function("f", [x, y], [x**2]))
    assert tape.reads(0) and not tape.reads(1)
