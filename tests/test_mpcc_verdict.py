"""What "certified" says of an MPCC that is no flight, and of points and problems that are none."""

from __future__ import annotations

import json
from collections.abc import Callable
from io import StringIO
from pathlib import Path

import casadi as ca
import pytest
from rich.console import Console

from benchbench.run.config import compose_any
from benchbench.run.pipeline import Run, run
from benchbench.run.summary import show
from benchbench.run.sweep_line import show_line

Rule = Callable[[ca.SX], ca.SX]
NOTHING: Rule = lambda w: ca.SX(0, 1)  # noqa: E731


def solved(folder: Path, cost: Rule, rows: Rule, start: list[float], limit: int = 300) -> Run:
    """Minimise cost(w) with rows(w) = 1 and 0 <= w0 complementary to w1 >= 0, from a start."""
    w, p = ca.SX.sym("w", 2), ca.SX.sym("p", 0)
    parts = {"augmented_objective_fun": cost(w), "g_fun": rows(w), "G_fun": w[0], "H_fun": w[1]}
    told = {key: ca.Function(key, [w, p], [value]).serialize() for key, value in parts.items()}
    right = [1.0] * rows(w).shape[0]
    numbers = {
        "w0": start,
        "lbw": [-1e3, -1e3],
        "ubw": [1e20, 1e20],
        "lbg": right,
        "ubg": right,
        "p0": [],
    }
    file = folder / "problem.json"
    file.write_text(json.dumps(told | numbers))
    return run(compose_any("+scenario=mpcc_file", f"scenario.path={file}", f"iteration_limit={limit}"))


def said(done: Run) -> str:
    console = Console(file=StringIO(), width=200)
    show(done.record, {}, console)
    return console.file.getvalue()  # type: ignore[attr-defined,no-any-return]


def test_a_point_without_a_cost_is_not_certified(tmp_path: Path) -> None:
    """The square root of a negative number: the untouched start keeps every row, and costs nothing that is a number."""
    done = solved(tmp_path, lambda w: ca.sqrt(w[0] - 2) + w[1], NOTHING, [0.0, 0.0])
    assert not done.certificate.certified and done.record["objective"] is None
    assert any("the cost at this point is nan" in reason for reason in done.certificate.reasons)


def test_a_point_from_which_the_cost_falls_is_not_called_certified_without_a_word(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Minimise -w0: unbounded, so that no point is stationary, however far it is."""
    done = solved(tmp_path, lambda w: -w[0], NOTHING, [1.0, 0.0], 3000)
    assert done.record["b_stationary"] == "no"
    assert "NOT stationary" in said(done)
    show_line(1, done.record, "")
    assert "not stationary" in capsys.readouterr().out


def test_a_feasibility_problem_has_a_solution(tmp_path: Path) -> None:
    """F = 0, w0 + w1 = 1, complementary: (1, 0) or (0, 1)."""
    done = solved(tmp_path, lambda w: ca.SX(0), lambda w: w[0] + w[1], [0.4, 0.2])
    assert done.certificate.certified and done.record["objective"] == 0.0
    assert "certified: feasible and complementary" in said(done) and "NOT stationary" not in said(done)


def test_a_problem_that_a_solver_refuses_to_begin_counts_no_iterations(tmp_path: Path) -> None:
    """Five times the same row for two unknowns: IPOPT's count is whatever stood in memory."""
    done = solved(tmp_path, lambda w: w[0] ** 2, lambda w: ca.vertcat(*[w[0] + w[1]] * 5), [0.4, 0.2])
    assert not done.certificate.certified
    assert done.record["iterations"] is not None and 0 <= done.record["iterations"] <= 10 * 300
