"""The Pyomo backend against the direct CasADi route, and its handling of pairs."""

from __future__ import annotations

import os
import sys
from dataclasses import replace
from pathlib import Path
from shutil import which

import casadi as ca
import numpy as np
import pytest
from small_mpccs import by_hand

from benchbench.conformance.checks.smooth_programs import hs071
from benchbench.formulation.handover import free_contact, phases
from benchbench.ground.errors import IncompatibleCase, Unavailable
from benchbench.mpcc.problem import Mpcc, block, evaluate
from benchbench.nlp.homotopy import homotopy
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.relaxation import relax
from benchbench.nlp.solver import Point, Setup
from benchbench.planning.guess import straight_line
from benchbench.run.config import compose
from benchbench_plugins.relaxations.none import NoRelaxation
from benchbench_plugins.relaxations.scholtes import Scholtes
from benchbench_plugins.relaxations.steffensen_ulbrich import SteffensenUlbrich
from benchbench_plugins.solvers.ipopt import Ipopt
from benchbench_plugins.solvers.pyomo_backend import Pyomo
from benchbench_plugins.solvers.pyomo_backend_model import build
from benchbench_plugins.solvers.pyomo_backend_run import read_back

pyo = pytest.importorskip("pyomo.environ")
SETUP = Setup(seconds=60.0, iterations=500)


def handover(intervals: int, free: bool = False) -> Mpcc:
    case = compose("+scenario=static", f"scenario.intervals={intervals}")
    return (free_contact if free else phases)(case, straight_line(case)).mpcc


@pytest.mark.parametrize("intervals", [8, 15])
def test_same_solution_as_casadi(intervals: int) -> None:
    """IPOPT to 1e-11 both times: the Hessian is nearly singular (1e-4), so 1e-8 leaves 2e-5 in x."""
    mpcc, options = handover(intervals), {"tol": 1e-11}
    direct = Ipopt(options=options).prepare(mpcc, SETUP)(0.0, Point(mpcc.guess))
    found = Pyomo(options=options).prepare(mpcc, SETUP)(0.0, Point(mpcc.guess))
    assert direct.claim == found.claim == "solved"
    assert found.objective == pytest.approx(direct.objective, abs=1e-9)
    assert found.point.x == pytest.approx(direct.point.x, abs=1e-6)
    assert found.point.lam_g == pytest.approx(direct.point.lam_g, abs=1e-6)
    assert found.point.lam_x == pytest.approx(direct.point.lam_x, abs=1e-6)


def test_model_says_the_same() -> None:
    """Every row and the cost of the Pyomo model, evaluated by Pyomo at a random point, for some sigma."""
    mpcc = relax(handover(6, free=True), Scholtes())
    model, sigma = build(mpcc), 0.37
    x = mpcc.guess + 0.1 * np.random.default_rng(3).normal(size=mpcc.size)
    model.start(x)
    model.sigma.set_value(sigma)
    rows = np.concatenate([evaluate(block, mpcc, x, sigma).ravel() for block in mpcc.constraints])
    lower, upper = (
        np.concatenate([getattr(b, k).ravel() for b in mpcc.constraints]) for k in ("lower", "upper")
    )
    written = [i for i, row in enumerate(model.rows) if row is not None]
    assert len(model.rows) == len(rows) and len(written) > 0.9 * len(rows)
    for i in written:
        row = model.rows[i]
        assert pyo.value(row.body) == pytest.approx(rows[i], rel=1e-10, abs=1e-10)
        assert (row.lb is None and lower[i] == -np.inf) or row.lb == lower[i]
        assert (row.ub is None and upper[i] == np.inf) or row.ub == upper[i]
    cost = sum(evaluate(block, mpcc, x, sigma).sum() for block in mpcc.costs)
    assert pyo.value(model.model.cost) == pytest.approx(cost, rel=1e-12)


def test_named_expressions_keep_the_file_small() -> None:
    """Operations grow with the number of intervals only; written out as trees they are 28 times as many."""
    mpcc = handover(10)
    nl = read_back(build(mpcc))
    block = max((b.function for b in mpcc.constraints), key=lambda f: f.n_instructions())
    whole = ca.Function("whole", [nl.problem["x"], nl.problem["p"]], [nl.problem["f"], nl.problem["g"]])
    assert whole.n_instructions() < 2 * 10 * block.n_instructions()


@pytest.mark.parametrize("small", by_hand(), ids=lambda s: s.name)
def test_native_pairs(small) -> None:  # type: ignore[no-untyped-def]
    """Unrelaxed pairs through mpec.simple_nonlinear; vanishing ones in slack form."""
    case = replace(compose("+scenario=static", "relaxation=none", "iteration_limit=500"), solver=Pyomo())
    done = homotopy(small.mpcc, case, Ledger(30.0), "test")
    assert done.outcome.claim == "solved"
    assert done.outcome.objective == pytest.approx(small.optimum, abs=1e-6)
    for pair in small.mpcc.pairs:
        g, h = np.split(evaluate(pair.block, small.mpcc, done.x), 2, axis=1)
        assert np.all(g >= -1e-6) and np.all(np.minimum(g, np.maximum(h, 0)) <= 1e-5)
        assert pair.kind == "vanishing" or np.all(h >= -1e-6)


def test_mpec_components() -> None:
    mpcc = relax(handover(6, free=True), NoRelaxation())
    assert {pair.kind for pair in mpcc.pairs} == {"complementarity"}
    model = build(mpcc).model
    moving = [pair for pair in mpcc.pairs if not pair.block.name.startswith("heading")]
    assert len(model.touch) >= sum(pair.count for pair in moving)
    assert all(hasattr(touch, "ccon") for touch in model.touch.values()), (
        "mpec.simple_nonlinear was not applied"
    )


def test_other_solvers_refuse_pairs() -> None:
    case = compose("+scenario=static", "relaxation=none", "solver=ipopt")
    with pytest.raises(IncompatibleCase, match=r"'none' leaves the pairs .* 'ipopt' takes none.*pyomo"):
        homotopy(by_hand()[0].mpcc, case, Ledger(30.0), "test")


def constant_row(value: float) -> Mpcc:
    mpcc = hs071().mpcc
    slots, number = mpcc.constraints[0].slots, np.full((1, 1), value)
    fixed = block("fixed", slots, lambda z, p: p + 0 * z[0], 0, 1, parameters=number)
    return replace(mpcc, constraints=(fixed, *mpcc.constraints))


def test_rows_without_unknowns() -> None:
    """Pyomo takes none: they hold, or the problem is infeasible."""
    good, bad = (Pyomo().prepare(constant_row(v), SETUP)(0.0, Point(hs071().mpcc.guess)) for v in (0.5, 1.5))
    assert good.claim == "solved" and good.objective == pytest.approx(17.01401729, abs=1e-7)
    assert good.point.lam_g is not None and good.point.lam_g[0] == 0.0 and good.point.lam_g[1] != 0.0
    assert bad.claim == "infeasible" and "fixed[0, 0] is 1.5" in bad.detail


def test_sigma_stays_a_parameter() -> None:
    """One .nl file for the whole homotopy: x >= 0, y >= 0, x y <= sigma with (x - 1)^2 + (y - 1)^2 / 2."""
    mpcc = relax(by_hand()[1].mpcc, Scholtes())
    solve = Pyomo().prepare(mpcc, SETUP)
    direct = Ipopt().prepare(mpcc, Setup(compile="never"))
    for sigma in (0.5, 0.1, 1e-6):
        wanted = direct(sigma, Point(mpcc.guess)).objective
        assert solve(sigma, Point(mpcc.guess)).objective == pytest.approx(wanted, abs=1e-7)


def test_inexpressible_relaxation() -> None:
    """Its if-then-else has no form that CasADi reads."""
    with pytest.raises(IncompatibleCase, match="Pyomo cannot write"):
        build(relax(by_hand()[0].mpcc, SteffensenUlbrich()))


def test_missing_library(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyomo.environ", None)
    with pytest.raises(Unavailable, match=r"pip install 'benchbench\[pyomo\]'"):
        Pyomo().prepare(hs071().mpcc, SETUP)


def test_missing_executable() -> None:
    with pytest.raises(Unavailable, match="no executable 'no-such-solver' on the PATH"):
        Pyomo(executable="no-such-solver").prepare(hs071().mpcc, SETUP)


def test_executable(monkeypatch: pytest.MonkeyPatch) -> None:
    """Any solver that reads .nl files; here that of pyomo-pounce, where it is installed."""
    monkeypatch.setenv("PATH", os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]))
    if which("pounce") is None:
        pytest.skip("no executable 'pounce' on the PATH: pip install pyomo-pounce")
    problem = hs071()
    found = Pyomo(executable="pounce").prepare(problem.mpcc, SETUP)(0.0, Point(problem.mpcc.guess))
    assert found.claim == "solved" and found.detail
    assert found.point.x == pytest.approx(problem.solution, abs=1e-5)
    rows = replace(
        problem.mpcc.constraints[0], lower=np.array([[25.0, 101.0]]), upper=np.array([[np.inf, 200.0]])
    )
    hopeless = replace(problem.mpcc, constraints=(rows,))  # four squares of at most 5 do not reach 101
    none = Pyomo(executable="pounce").prepare(hopeless, SETUP)(0.0, Point(problem.mpcc.guess))
    assert none.claim != "solved"


def test_executable_out_of_time(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A program that never answers is stopped."""
    program = tmp_path / "endless"
    program.write_text('#!/bin/sh\n[ "$1" = -v ] && echo 1.0 && exit\nexec sleep 60\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", os.pathsep.join([str(tmp_path), os.environ["PATH"]]))
    outcome = Pyomo(executable="endless").prepare(hs071().mpcc, Setup(seconds=1.0))(
        0.0, Point(hs071().mpcc.guess)
    )
    assert outcome.claim == "time_limit"
    assert outcome.point.x == pytest.approx(hs071().mpcc.guess)


def test_options_of_an_executable() -> None:
    """Only for IPOPT we know the names."""
    setup = Setup(seconds=7.0, iterations=9, accuracy="low")
    ipopt = Pyomo(executable="ipopt", options={"max_iter": 3}).native_options(setup)
    assert ipopt["tol"] == 1e-4 and ipopt["max_cpu_time"] == 7.0 and ipopt["max_iter"] == 3
    assert Pyomo(executable="knitro", options={"outlev": 0}).native_options(setup) == {"outlev": 0}
