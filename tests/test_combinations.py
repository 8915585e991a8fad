"""Dynamics, relaxations and solvers combine freely: small runs off the default, each ends with an honest record."""

from __future__ import annotations

import math

import composing
import pytest

from benchbench.run import pipeline
from benchbench.storage.status import Status

COMBINATIONS = [
    pytest.param("midpoint", "scholtes", "sleqp", marks=pytest.mark.slow),  # its timers: docs/solvers.md
    ("midpoint", "kadrani", "ipopt"), ("midpoint", "elastic", "uno"),
    ("rk4", "direct", "ipopt"), ("rk4", "scholtes", "fatrop"), ("rk4", "l1_penalty", "ipopt"),
    ("trapezoidal", "kanzow_schwartz", "ipopt"), ("trapezoidal", "scholtes", "uno"),
    ("trapezoidal", "fischer_burmeister", "sqpmethod"), ("trapezoidal", "augmented_lagrangian", "ipopt"),
    ("hermite_simpson", "lin_fukushima", "ipopt"), ("hermite_simpson", "scholtes", "pyomo"),
    ("hermite_simpson", "natural_residual", "ipopt"), ("collocation", "steffensen_ulbrich", "ipopt"),
    ("collocation", "chen_chen_kanzow", "ipopt"), ("collocation", "paper", "ipopt"),
    ("collocation", "elastic", "pyomo"), ("verlet", "none", "pyomo"), ("verlet", "kadrani", "cvxpy_nlp"),
    ("verlet", "l1_penalty", "uno"), ("verlet", "direct", "bonmin"), ("verlet", "scholtes", "cvxpy"),
    ("midpoint", "fischer_burmeister", "ipopt"), ("rk4", "natural_residual", "sqpmethod"),
]  # fmt: skip
UNFINISHED = {
    "sqpmethod", "cvxpy", "cvxpy_nlp", "sleqp", "fatrop", ("verlet", "l1_penalty", "uno"),
}  # fmt: skip
"""Solvers and combinations that do not end well in 60 iterations either: fewer say the same of their records."""


@pytest.mark.usefixtures("brief_replays")
@pytest.mark.parametrize(("dynamics", "relaxation", "solver"), COMBINATIONS)
def test_combination(dynamics: str, relaxation: str, solver: str) -> None:
    few = bool(UNFINISHED & {solver, (dynamics, relaxation, solver)})
    case = composing.case_of(
        "+scenario=static", f"dynamics={dynamics}", f"relaxation={relaxation}", f"solver={solver}",
        "strategy=relax", "strategy.margin=0", "guess=line", "scenario.intervals=8",
        f"iteration_limit={4 if few else 60}", "time_limit=10",
    )  # fmt: skip
    done = pipeline.run(case)
    record = done.record
    assert record["status"] in set(Status)
    assert (record["dynamics"], record["relaxation"], record["solver"]) == (dynamics, relaxation, solver)
    assert record["certified"] == done.certificate.certified == (record["status"] == Status.CERTIFIED)
    assert record["n_pairs"] > 0 and record["iterations"] >= 1
    assert not any(isinstance(value, float) and not math.isfinite(value) for value in record.values())
    if not record["certified"]:
        assert record["reasons"] and record["advice"]
    if record["claimed_success"]:
        assert record["max_violation"] < 1e-2
