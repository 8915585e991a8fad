"""The assembled program against CasADi's own derivatives of the same problem written as one expression."""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from benchbench.formulation.handover import free_contact, phases
from benchbench.ground.arrays import Array
from benchbench.mpcc import derivatives
from benchbench.mpcc.problem import Block, Mpcc, Slot, Variable, gather
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.program import Program, assemble
from benchbench.nlp.relaxation import relax
from benchbench.planning.guess import straight_line
from benchbench.planning.strategy import pose
from benchbench.run import config


def variable(name: str, rows: int, columns: int, seed: int) -> Variable:
    draw = np.random.default_rng(seed)
    guess = draw.uniform(-1, 1, (rows, columns))
    return Variable(name, guess - 1, guess + 1, guess)


def block(name: str, rule, slots: tuple[Slot, ...], parameters: Array, outputs: int) -> Block:
    z = ca.SX.sym("z", sum(slot.index.shape[1] for slot in slots))
    p, s = ca.SX.sym("p", parameters.shape[1]), ca.SX.sym("sigma")
    out = ca.vertcat(*rule(z, p, s))
    shape = (len(parameters), outputs)
    return Block(
        name,
        ca.Function(name, [z, p, s], [out]),
        slots,
        parameters,
        np.full(shape, -1.0),
        np.full(shape, 2.0),
    )


def several() -> Mpcc:
    """Two variables; two costs and three constraints with many instances, shared and repeated unknowns."""
    draw = np.random.default_rng(0)
    a, b = variable("a", 4, 2, 1), variable("b", 3, 1, 2)
    pairs = Slot("a", np.array([[0, 1, 2, 3], [2, 3, 4, 5], [4, 5, 6, 7]]))
    each, everyone = Slot("b", np.array([[0], [1], [2]])), Slot("b", np.zeros((3, 1), dtype=np.int64))
    twice = Slot("a", np.array([[3, 3, 1], [6, 0, 6]]))
    numbers = draw.uniform(0.5, 1.5, (3, 2))
    costs = (
        block(
            "sum",
            lambda z, p, s: [p[0] * z[0] ** 2 * z[4] + ca.exp(z[1] * z[3]) + s * z[2]],
            (pairs, each),
            numbers,
            1,
        ),
        block("square", lambda z, p, s: [z[0] * z[1] ** 2 * z[2] + z[0] ** 3], (twice,), np.zeros((2, 0)), 1),
    )
    constraints = (
        block("chain", lambda z, p, s: [z[2] - z[0] * p[0] + ca.sin(z[3]) * z[4], z[4] ** 2 * p[1] - s, z[1]],
              (pairs, everyone), numbers, 3),
        block("again", lambda z, p, s: [z[0] * z[1] * z[2], ca.cos(z[0] - 2 * z[1])], (twice,), np.zeros((2, 0)), 2),
        block("linear", lambda z, p, s: [3 * z[0] + p[1]], (each,), numbers, 1),
    )  # fmt: skip
    return Mpcc((a, b), constraints, costs)


def whole(mpcc: Mpcc) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
    """x, sigma, f, g as one SX graph, instance by instance."""
    x, sigma = ca.SX.sym("x", mpcc.size), ca.SX.sym("sigma")

    def outputs(of: Block) -> list[ca.SX]:
        return [
            of.function(x[index.tolist()], numbers, sigma)
            for index, numbers in zip(gather(of, mpcc.offsets), of.parameters, strict=True)
        ]

    f = sum((out for of in mpcc.costs for out in outputs(of)), ca.SX(0))
    return x, sigma, f, ca.vertcat(ca.SX(0, 1), *(out for of in mpcc.constraints for out in outputs(of)))


def check_against_casadi(mpcc: Mpcc, program: Program, points: int = 3) -> None:
    x, sigma, f, g = whole(mpcc)
    lam_f, lam_g = ca.SX.sym("lam_f"), ca.SX.sym("lam_g", g.shape[0])
    hessian = ca.triu(ca.hessian(lam_f * f + ca.dot(lam_g, g), x)[0])
    oracle = ca.Function(
        "oracle", [x, sigma, lam_f, lam_g], [f, g, ca.gradient(f, x), ca.jacobian(g, x), hessian]
    )
    draw = np.random.default_rng(7)
    for _ in range(points):
        at = np.clip(mpcc.guess + draw.uniform(-0.1, 0.1, mpcc.size), mpcc.lower, mpcc.upper)
        s, weight, lam = draw.uniform(0.1, 1.0), draw.uniform(0.5, 2.0), draw.normal(size=g.shape[0])
        wanted = oracle(at, s, weight, lam)
        value, gradient = program.gradient(at, s)
        rows, jacobian = program.jacobian(at, s)
        found = (value, rows, gradient, jacobian, program.hessian(at, s, weight, lam))
        for ours, theirs in zip(found, wanted, strict=True):
            ours, theirs = np.asarray(ca.densify(ours)), np.asarray(ca.densify(theirs))
            scale = 1 + np.max(np.abs(theirs), initial=0.0)
            np.testing.assert_allclose(ours / scale, theirs.reshape(ours.shape) / scale, rtol=0, atol=1e-11)
            np.testing.assert_allclose(ours, theirs.reshape(ours.shape), rtol=1e-10, atol=1e-10 * scale)
        graph = ca.Function("graph", [program.x, program.p], [program.f, program.g])
        for ours, theirs in zip(graph(at, s), wanted[:2], strict=True):
            np.testing.assert_allclose(np.asarray(ours), np.asarray(theirs), rtol=1e-12, atol=1e-12)


def test_derivatives_equal_casadis() -> None:
    mpcc = several()
    check_against_casadi(mpcc, assemble(mpcc, "never"))


def test_hessian_is_upper_triangular_and_sparse() -> None:
    program = assemble(several(), "never")
    pattern = program.hessian.sparsity_out(0)
    assert pattern.is_triu()
    assert program.jacobian.sparsity_out(1).nnz() < program.jacobian.sparsity_out(1).numel()
    assert program.gradient.sparsity_out(1).is_dense(), "a sparse gradient is misread by nlpsol"


def test_bounds_and_guess_are_stacked_in_order() -> None:
    mpcc = several()
    program = assemble(mpcc, "never")
    np.testing.assert_array_equal(program.guess[:8], mpcc.variables[0].guess.ravel())
    np.testing.assert_array_equal(program.lower_x, mpcc.lower)
    assert len(program.lower_g) == len(program.upper_g) == 3 * 3 + 2 * 2 + 3


@pytest.mark.parametrize("parts", ["no constraints", "no costs", "nothing"])
def test_missing_parts(parts: str) -> None:
    mpcc = several()
    costs = mpcc.costs if parts == "no constraints" else ()
    constraints = mpcc.constraints if parts == "no costs" else ()
    less = Mpcc(mpcc.variables, constraints, costs)
    check_against_casadi(less, assemble(less, "never"))


def test_block_without_instances_is_left_out() -> None:
    mpcc = several()
    empty = block(
        "empty", lambda z, p, s: [z[0]], (Slot("b", np.zeros((0, 1), dtype=np.int64)),), np.zeros((0, 0)), 1
    )
    more = mpcc + Mpcc((), (empty,), (empty,))
    check_against_casadi(more, assemble(more, "never"))


def test_order_of_parts_does_not_matter() -> None:
    mpcc = several()
    halves = Mpcc(mpcc.variables[:1], mpcc.constraints[:1]) + Mpcc(
        mpcc.variables[1:], mpcc.constraints[1:], mpcc.costs
    )
    one, other = assemble(mpcc, "never"), assemble(halves, "never")
    for a, b in zip(one.jacobian(mpcc.guess, 0.3), other.jacobian(mpcc.guess, 0.3), strict=True):
        np.testing.assert_array_equal(np.asarray(ca.densify(a)), np.asarray(ca.densify(b)))


def test_compiled_equals_interpreted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BENCHBENCH_CACHE", str(tmp_path))
    monkeypatch.setattr(derivatives, "LARGE", 0)  # these blocks are too small to be compiled otherwise
    mpcc = several()
    plain, fast = assemble(mpcc, "never"), assemble(mpcc, "auto")
    if not fast.compiled:
        pytest.skip("no gcc here")
    assert not plain.compiled
    lam = np.linspace(-1, 1, len(plain.lower_g))
    for x in (mpcc.guess, mpcc.lower, mpcc.upper):
        for name, more in (("gradient", ()), ("jacobian", ()), ("hessian", (1.0, lam))):
            left, right = (getattr(p, name).call([x, 0.3, *more]) for p in (plain, fast))
            for a, b in zip(left, right, strict=True):
                np.testing.assert_allclose(np.asarray(b), np.asarray(a), rtol=1e-12, atol=1e-12)


def test_pairs_must_be_relaxed_first() -> None:
    case = config.compose("+scenario=static", "scenario.intervals=10", "compile=never")
    problem = free_contact(case, straight_line(case))
    with pytest.raises(ValueError, match="relaxed"):
        assemble(problem.mpcc)


@pytest.mark.parametrize("relaxation", ["scholtes", "elastic", "augmented_lagrangian"])
def test_a_real_problem_with_free_contact(relaxation: str) -> None:
    case = config.compose(
        "+scenario=circle", "scenario.intervals=6", f"relaxation={relaxation}", "guess=line"
    )
    mpcc = relax(free_contact(case, straight_line(case)).mpcc, case.relaxation)
    check_against_casadi(mpcc, assemble(mpcc, "never"), points=1)


def test_start_at_a_solution_of_phases_keeps_it() -> None:
    """Encode, assemble, solve and decode agree: solving again from the found plan does not move it."""
    case = config.compose("+scenario=static", "scenario.intervals=12", "compile=never")
    first = pose(phases(case, straight_line(case)), case, Ledger(60.0), "first")
    again = pose(phases(case, first.plan), case, Ledger(60.0), "again")
    assert first.solved.outcome.claim == again.solved.outcome.claim == "solved"
    np.testing.assert_allclose(again.plan.travel_time, first.plan.travel_time, rtol=1e-6)
