"""The only loop over sigma: relax once, build once, solve for each sigma from the last point."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from benchbench.case import Case, Ledger
from benchbench.mpcc import Mpcc
from benchbench.plan import Array
from benchbench.relaxation import relax
from benchbench.solver import Outcome, Point, Setup


@dataclass(frozen=True)
class Solved:
    """The last outcome of a homotopy, its unknowns by name, and x of the original problem (n,)."""

    outcome: Outcome
    values: dict[str, Array]
    x: Array
    sigma: float


def homotopy(mpcc: Mpcc, case: Case, ledger: Ledger, stage: str) -> Solved:
    """Solve an MPCC; without pairs it is one smooth solve.

    Each sigma starts from the last finite point with fresh multipliers. A sigma that fails does not stop
    the schedule: the next one may recover, and the last word is the certificate's. Spent time does.
    """
    with ledger.building():
        relaxed = relax(mpcc, case.relaxation) if mpcc.pairs else mpcc
        offsets = relaxed.offsets
        where = (offsets["T"], relaxed.split(relaxed.guess)["T"].size) if "T" in offsets else None
        watch = ledger.watch.stage(stage, where) if ledger.watch else None
        setup = Setup(ledger.seconds_left, case.iteration_limit, case.accuracy, case.compile, watch)
        solve = case.solver.prepare(relaxed, setup)
    point, outcome, sigma = Point(relaxed.guess), None, 0.0
    for sigma in case.relaxation.schedule if mpcc.pairs else (0.0,):
        outcome = solve(sigma, point)
        ledger.count(outcome)
        if not np.all(np.isfinite(outcome.point.x)):
            outcome = replace(outcome, claim="invalid", point=point)
        point = Point(outcome.point.x)
        if outcome.claim == "time_limit" or ledger.seconds_left <= 0.1:
            break
    if outcome is None:
        raise ValueError("relaxation.schedule is empty")
    values = relaxed.split(outcome.point.x)
    x = np.concatenate([np.zeros(0), *(values[v.name].ravel() for v in mpcc.variables)])
    return Solved(outcome, values, x, sigma)
