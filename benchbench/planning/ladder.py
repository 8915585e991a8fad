"""The grid ladder: solve phases on a coarse grid, prolongate plan and multipliers to the next one.

A cold solve on a fine grid spends most of its iterations on finding the flight; on a coarse grid each of them costs less. With stages (collocation, Runge-Kutta) a cold solve at N = 100 may not end at all.
"""

from __future__ import annotations

from dataclasses import replace

from benchbench.nlp.ledger import Ledger
from benchbench.nlp.solver import Accuracy
from benchbench.ocp.plan import Plan
from benchbench.planning import posing
from benchbench.planning.case import Case
from benchbench.planning.onward import started, without_error
from benchbench.planning.result import Result
from benchbench.planning.strategy import pose
from benchbench.transcription.correction import correctable

COARSE = 0.25
"""Share of the intervals that the first grid has."""
WARM = 150
"""Iterations that a solve with multipliers may use: a good start needs 10 to 60, and a cold solve is rarely better than a bad one."""
FEWEST = 16
"""Intervals that the first grid has at least."""
ENOUGH: dict[Accuracy, Accuracy] = {"high": "medium"}
"""How exactly the first grid is solved, since its plan is only a start: eight random handovers took 1205 iterations in place of 1252, with
"low" 1275.
"""
COLD = 75
"""Iterations that a cold solve may use where a coarser grid is the other way: Verlet needs 20 to 60 at N = 100."""


def coarse(case: Case) -> Case:
    """Return the case on the first grid of its ladder, to be solved less exactly; the case itself where its own is coarse already."""
    intervals = case.scenario.grid_intervals
    if intervals <= FEWEST or (first := on_grid(case, max(FEWEST, round(COARSE * intervals)))) is case:
        return case
    return replace(first, accuracy=ENOUGH.get(case.accuracy, case.accuracy))


def staged(case: Case) -> bool:
    """Tell whether the transcription has stages, with which a cold solve at N = 100 may not end at all."""
    return not correctable(posing.free(case, posing.line(case)).trajectory)


def on_grid(case: Case, intervals: int) -> Case:
    """Return the case on a grid of so many intervals; the case itself where its scenario has only one grid."""
    scenario = case.scenario.on_grid(intervals)
    return case if scenario is None else replace(case, scenario=scenario)


def rung(
    case: Case,
    ledger: Ledger,
    start: Plan,
    below: Result | None = None,
    correct: bool = False,
    stage: str = "",
) -> Result:
    """Solve phases from a plan, with the multipliers of a solved grid below; once more without them if that fails.

    correct: with the error of the transcription taken off its equations, as it is at the start.
    """
    with ledger.building():
        problem = posing.phases(case, start)
        plant = case.model.plant()
        problem = problem if below is None else started(problem, below, plant)
        problem = without_error(problem, plant) if correct else problem
    name = stage or f"N = {problem.trajectory.grid.intervals}"
    if below is None:
        return pose(problem, case, ledger, name)
    found = pose(problem, replace(case, iteration_limit=min(WARM, case.iteration_limit)), ledger, name, below)
    return found if found.claimed or ledger.over else pose(problem, case, ledger, f"{name}, again")


def climb(case: Case, ledger: Ledger, start: Plan) -> Result:
    """Solve on the coarse grid, then on the case's own; directly on its own where the coarse one fails."""
    first = coarse(case)
    below = None if first is case else rung(first, ledger, start)
    if below is None or (not below.claimed and not ledger.over):
        return rung(case, ledger, start)
    return rung(case, ledger, below.plan, below) if below.claimed else below


def from_phases(case: Case, ledger: Ledger, start: Plan) -> Result:
    """Make a start: solve phases, then one step size with contacts, or gates, held at the nearest nodes; both smooth.

    The second solve matters: the interpolated plan breaks the dynamics of the new grid, and IPOPT leaves the
    window on its way back. It starts from the multipliers of the first, with which it takes half as many iterations. Phases that
    are not solved soon are solved by way of a coarse grid.
    """
    with ledger.guessing():
        patient = replace(case, iteration_limit=min(COLD, case.iteration_limit))
        found = rung(patient, ledger, start, stage="guess: phases")
        if not found.claimed and not ledger.over and case.iteration_limit > COLD:
            found = climb(case, ledger, start)
    with ledger.building():
        problem = posing.held(case, found.plan)
    with ledger.guessing():
        return pose(problem, case, ledger, "guess: window", found)
