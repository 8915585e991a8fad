"""Sequential convex programming and CVXPY's nonlinear interface."""

from __future__ import annotations

import importlib.util
import sys
import time
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from small_mpccs import by_hand

from benchbench.conformance.checks.smooth_programs import hs071
from benchbench.formulation.handover import free_contact, phases
from benchbench.ground.errors import IncompatibleCase, Unavailable
from benchbench.mpcc.problem import Mpcc, Variable, block, evaluate, rows
from benchbench.mpcc.residuals import residuals
from benchbench.nlp.homotopy import homotopy
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.program import assemble
from benchbench.nlp.relaxation import relax
from benchbench.nlp.solver import Point, Setup
from benchbench.planning.guess import straight_line
from benchbench.run.config import compose
from benchbench_plugins.relaxations.paper import Paper
from benchbench_plugins.relaxations.scholtes import Scholtes
from benchbench_plugins.solvers.cvxpy_backend import Cvxpy
from benchbench_plugins.solvers.cvxpy_backend_atoms import Atoms
from benchbench_plugins.solvers.cvxpy_backend_model import LocalModel
from benchbench_plugins.solvers.cvxpy_backend_nlp import PACKAGES, CvxpyNlp
from benchbench_plugins.solvers.cvxpy_backend_qp import Subproblem
from benchbench_plugins.solvers.ipopt import Ipopt

cp = pytest.importorskip("cvxpy")


def handover(intervals: int, scenario: str = "static") -> Mpcc:
    case = compose(f"+scenario={scenario}", f"scenario.intervals={intervals}")
    return phases(case, straight_line(case)).mpcc


def test_handover_to_certified_quality() -> None:
    """N = 25: violation at most 1e-6 in less than 120 s, and the objective that IPOPT finds."""
    mpcc = handover(25)
    wanted = Ipopt().prepare(mpcc, Setup())(0.0, Point(mpcc.guess))
    began = time.perf_counter()
    outcome = Cvxpy().prepare(mpcc, Setup(120.0, 300, "medium"))(0.0, Point(mpcc.guess))
    assert time.perf_counter() - began < 120.0
    assert outcome.claim == "solved", outcome.detail
    assert residuals(mpcc, outcome.point.x).max_violation <= 1e-6
    assert outcome.objective == pytest.approx(wanted.objective, abs=1e-6)


def test_multipliers_of_a_handover() -> None:
    """Grad f + J' lam_g + lam_x = 0 with complementary multipliers, from derivatives of our own."""
    mpcc = handover(10)
    outcome = Cvxpy().prepare(mpcc, Setup(iterations=300, accuracy="high"))(0.0, Point(mpcc.guess))
    program, point = assemble(mpcc, "never"), outcome.point
    assert outcome.claim == "solved" and point.lam_g is not None and point.lam_x is not None
    gradient = np.asarray(program.gradient(point.x, 0.0)[1]).ravel()
    g, jacobian = program.jacobian(point.x, 0.0)
    slope = gradient + np.asarray(jacobian.T @ point.lam_g).ravel() + point.lam_x
    assert np.abs(slope).max() < 1e-5
    for lam, value, low, high in (
        (point.lam_g, np.asarray(g).ravel(), program.lower_g, program.upper_g),
        (point.lam_x, point.x, program.lower_x, program.upper_x),
    ):
        assert np.all(high[lam > 1e-4] - value[lam > 1e-4] < 1e-4)
        assert np.all(value[lam < -1e-4] - low[lam < -1e-4] < 1e-4)


def test_curvature_is_convex_and_only_cut() -> None:
    """B is positive semidefinite and B - H is too: per block only negative eigenvalues were removed."""
    mpcc = handover(6)
    model, rng = LocalModel(mpcc, "never"), np.random.default_rng(5)
    x = np.clip(mpcc.guess + 0.1 * rng.normal(size=mpcc.size), mpcc.lower, mpcc.upper)
    model.begin(x, 0.0)
    lam = rng.normal(size=model.m)
    stand_in = np.zeros((model.n, model.n))
    stand_in[model.curvature_pattern] = model.curvature(x, 0.0, lam)
    upper = np.asarray(ca.densify(assemble(mpcc, "never").hessian(x, 0.0, 1.0, lam * model.scale)))
    hessian = upper + np.triu(upper, 1).T
    assert stand_in == pytest.approx(stand_in.T)
    size = np.abs(hessian).max()
    assert size > 1.0
    assert np.linalg.eigvalsh(stand_in).min() > -1e-9 * size
    assert np.linalg.eigvalsh(stand_in - hessian).min() > -1e-9 * size
    assert np.linalg.eigvalsh(hessian).min() < -1e-3 * size, "nothing was cut: the test shows nothing"


def test_subproblem_is_compiled_once_and_right() -> None:
    """Two solves with other parameters; the answer against the optimality conditions of the quadratic program."""
    mpcc = hs071().mpcc
    model = LocalModel(mpcc, "never")
    subproblem = Subproblem(model, "CLARABEL", {})
    compiled = set()
    for x in (np.array([1.0, 5.0, 5.0, 1.0]), np.array([1.2, 4.5, 3.9, 1.5])):
        model.begin(x, 0.0)
        at, curvature = model.at(x, 0.0), model.curvature(x, 0.0, np.ones(model.m))
        subproblem.pose(at, curvature, np.full(model.m, 100.0))
        step = subproblem.solve(at.g, np.maximum(1 - x, -0.5), np.minimum(5 - x, 0.5))
        compiled.add(id(subproblem.problem._cache.param_prog))
        assert step is not None
        matrix = np.zeros((4, 4))
        matrix[model.curvature_pattern] = curvature
        slope = at.gradient + matrix @ step.d + at.jacobian.T @ step.lam_g + step.lam_d
        assert np.abs(slope).max() < 1e-6
        left = model.outside(at.g + at.jacobian @ step.d) > 1e-7
        assert np.abs(step.lam_g)[left] == pytest.approx(100.0), "a row with slack pays its weight"
        assert np.all(np.abs(step.lam_g) < 100.0 + 1e-6)
    assert len(compiled) == 1


def at_rest() -> Mpcc:
    """Min (v - 2)^2 with (v / 0.01)^2 - 1 <= 0 from v = 0, where the row has no slope: v = 0.01."""
    one, slots = np.ones((1, 1)), [rows("v", 1, [0])]
    cost = block("cost", slots, lambda v: (v - 2) ** 2)
    row = block("row", slots, lambda v: (v / 0.01) ** 2 - 1, -np.inf, 0.0)
    return Mpcc((Variable("v", -9 * one, 9 * one, 0 * one),), (row,), (cost,))


def test_row_without_a_slope_at_the_start() -> None:
    outcome = Cvxpy().prepare(at_rest(), Setup(compile="never", iterations=100))(0.0, Point(np.zeros(1)))
    assert outcome.claim == "solved"
    assert outcome.point.x == pytest.approx([0.01], abs=1e-8)


def test_infeasible_row_is_named_so() -> None:
    mpcc = at_rest()
    rows = replace(mpcc.constraints[0], upper=np.full((1, 1), -1.5))
    outcome = Cvxpy().prepare(replace(mpcc, constraints=(rows,)), Setup(compile="never", iterations=200))(
        0.0, Point(np.ones(1))
    )
    assert outcome.claim == "infeasible" and "violation 5.0e-01" in outcome.detail


@pytest.mark.parametrize("name", ["scholtes3", "scale1", "cubic", "forced", "academic", "vanished"])
def test_small_mpccs(name: str) -> None:
    """Through Scholtes' homotopy, as with any other solver."""
    small = next(s for s in by_hand() if s.name == name)
    case = replace(compose("+scenario=static", "iteration_limit=200", "compile=never"), solver=Cvxpy())
    done = homotopy(small.mpcc, case, Ledger(60.0), "test")
    assert done.outcome.objective == pytest.approx(small.optimum, abs=5e-3 + small.tolerance)


needs_cyipopt = pytest.mark.skipif(
    importlib.util.find_spec("cyipopt") is None,
    reason="cyipopt is not installed: pip install 'benchbench[cvxpy-nlp]'",
)


@needs_cyipopt
def test_nonlinear_interface_agrees() -> None:
    """Same objective as IPOPT on the problem as it is, though here thousands of values are unknowns."""
    mpcc = handover(10)
    wanted = Ipopt().prepare(mpcc, Setup())(0.0, Point(mpcc.guess))
    outcome = CvxpyNlp().prepare(mpcc, Setup(120.0))(0.0, Point(mpcc.guess))
    assert outcome.claim == "solved" and outcome.iterations > 5 and outcome.evaluations > 20
    assert residuals(mpcc, outcome.point.x).max_violation <= 1e-6
    assert outcome.objective == pytest.approx(wanted.objective, abs=1e-6)


@needs_cyipopt
def test_nonlinear_interface_follows_sigma() -> None:
    mpcc = relax(by_hand()[1].mpcc, Scholtes())
    solve = CvxpyNlp().prepare(mpcc, Setup(30.0))
    direct = Ipopt().prepare(mpcc, Setup(compile="never"))
    for sigma in (0.5, 0.1, 1e-6):
        wanted = direct(sigma, Point(mpcc.guess)).objective
        assert solve(sigma, Point(mpcc.guess)).objective == pytest.approx(wanted, abs=1e-6)


@pytest.mark.skipif(importlib.util.find_spec("unopy") is None, reason="unopy is not installed")
def test_nonlinear_interface_with_uno() -> None:
    problem = hs071()
    solve = CvxpyNlp(solver="UNO").prepare(problem.mpcc, Setup(30.0, 200))
    outcome = solve(0.0, Point(problem.mpcc.guess))
    assert outcome.claim == "solved"
    assert outcome.point.x == pytest.approx(problem.solution, abs=1e-6)


def test_atoms_say_the_same() -> None:
    """Cost and rows in CVXPY at a random point; the lifted rows hold there by construction."""
    case = compose("+scenario=circle", "scenario.intervals=6")
    mpcc = relax(free_contact(case, straight_line(case)).mpcc, Scholtes())
    x = np.clip(mpcc.guess + 0.05 * np.random.default_rng(4).normal(size=mpcc.size), mpcc.lower, mpcc.upper)
    atoms = Atoms(mpcc, 0.2)
    atoms.start(x)
    cost = sum(evaluate(block, mpcc, x, 0.2).sum() for block in mpcc.costs)
    assert atoms.problem.objective.value == pytest.approx(cost, rel=1e-12)
    wanted = []
    for row in mpcc.constraints:
        value = evaluate(row, mpcc, x, 0.2)
        wanted.append(np.maximum(row.lower - value, value - row.upper).clip(0))
    found = np.concatenate([np.ravel(rule.violation()) for rule in atoms.problem.constraints])
    assert found.sum() == pytest.approx(sum(w.sum() for w in wanted), rel=1e-9)
    assert found.max() == pytest.approx(max(w.max() for w in wanted), rel=1e-9)


def test_missing_atom_is_named() -> None:
    case = compose("+scenario=static", "scenario.intervals=6")
    mpcc = relax(free_contact(case, straight_line(case)).mpcc, Paper())
    with pytest.raises(IncompatibleCase, match="has no 'fmax'"):
        Atoms(mpcc, 0.0)


def test_missing_library(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cvxpy", None)
    for solver in (Cvxpy(), CvxpyNlp()):
        with pytest.raises(Unavailable, match=r"pip install 'benchbench\[cvxpy\]'"):
            solver.prepare(hs071().mpcc, Setup(compile="never"))


@pytest.mark.parametrize("solver", ["IPOPT", "UNO"])
def test_missing_nonlinear_solver(solver: str, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: None if name in PACKAGES.values() else seen(name)
    )
    with pytest.raises(Unavailable, match=r"pip install 'benchbench\[cvxpy-nlp\]'"):
        CvxpyNlp(solver=solver).prepare(hs071().mpcc, Setup(compile="never"))  # type: ignore[arg-type]
