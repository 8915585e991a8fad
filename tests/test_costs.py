"""Where the CPU time of a run goes: the parts in its record against each other, on real solves."""

from __future__ import annotations

import composing
import pytest

from benchbench.mpcc.spending import collecting, cpu_s, spending
from benchbench.nlp.ledger import Ledger, Spent
from benchbench.nlp.solver import Outcome, Point
from benchbench.run import pipeline
from benchbench.storage.schema import Record

QUICK = ("+scenario=static", "scenario.intervals=12", "compile=never")


def record(*overrides: str) -> Record:
    return pipeline.run(composing.case_of(*QUICK, *overrides)).record


def test_parts_of_a_homotopy() -> None:
    r = record("relaxation=scholtes", "strategy=relax", "strategy.margin=0")
    assert r["functions_cpu_s"] + r["linear_algebra_cpu_s"] == pytest.approx(r["solve_cpu_s"])
    assert 0 < r["functions_cpu_s"] < r["solve_cpu_s"] and 0 < r["derivatives_cpu_s"] < r["build_cpu_s"]
    assert r["guess_cpu_s"] > 0 and r["homotopy_cpu_s"] > 0
    assert r["guess_cpu_s"] + r["homotopy_cpu_s"] < r["solve_cpu_s"]


def test_one_smooth_solve_has_neither_guess_nor_homotopy() -> None:
    r = record("strategy=phases")
    assert r["guess_cpu_s"] == r["homotopy_cpu_s"] == 0


def test_a_solver_that_does_not_tell_leaves_the_split_empty() -> None:
    ledger = Ledger(1.0)
    for times in ({"nlp_f": 1.0, "nlp_g": 0.5}, {}):
        ledger.count(Outcome("solved", Point(None), 0.0, 1, 1, 2.0, times=times))  # type: ignore[arg-type]
    costs = ledger.costs()
    assert ledger.solves == [Spent("", 2.0, 1.5), Spent("", 2.0, None)]
    assert costs["functions_cpu_s"] is costs["linear_algebra_cpu_s"] is None
    assert (costs["solve_cpu_s"], costs["homotopy_cpu_s"]) == (4.0, 2.0)


def test_spending_is_noted_only_where_somebody_collects() -> None:
    def burn() -> None:
        until = cpu_s() + 0.02
        while cpu_s() < until:
            pass

    with spending("idle"):
        pass
    with collecting() as outer:
        with spending("a"):
            burn()
        with collecting() as inner, spending("b"):
            burn()
        with spending("a"):
            burn()
    assert set(outer) == {"a"} and set(inner) == {"b"}
    assert outer["a"] >= 0.04 and inner["b"] >= 0.02
