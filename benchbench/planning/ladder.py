"""The grid ladder: solve phases on a coarse grid, prolongate plan and multipliers to the next one.

A cold solve on a fine grid spends most of its iterations on finding the flight; on a coarse grid each of them costs less. With stages
(collocation, Runge-Kutta) a cold solve at N = 100 may not end at all.
"""

from __future__ import annotations

from dataclasses import replace

from benchbench.formulation.problem import Problem
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.solver import Accuracy
from benchbench.ocp.plan import Plan
from benchbench.planning import posing
from benchbench.planning.case import Case
from benchbench.planning.onward import started, without_error
from benchbench.planning.proximal import PRICE, kept_near, price_of
from benchbench.planning.result import Result
from benchbench.planning.strategy import pose
from benchbench.transcription.runge_kutta import StageTrajectory

COARSE = 0.25
"""Share of the intervals that the first grid has."""
WARM = 100
"""Iterations that a solve with multipliers may use: a good start needs 10 to 60, and there are other ways than to wait for a bad one."""
NEARER = 10.0
"""Factor of the price on leaving the plan before where the first did not end: it makes a problem convex that has many motions as good as others."""
APART = 3
"""Grids that are so many times finer have one between them: coarse plans of long flights, with steps of 0.2 s, are far from the fine ones."""
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
    """Tell whether the transcription has stages as unknowns of their own, three to eight times as many in all."""
    return isinstance(posing.free(case, posing.line(case)).trajectory, StageTrajectory)


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
    """Solve phases from a plan, with the multipliers of a solved grid below; once more if that fails.

    correct: with the error of the transcription taken off its equations, as it is at the start, and kept near it; where that fails,
    kept nearer. What fails otherwise is solved without multipliers.
    """
    with ledger.building():
        problem = posing.phases(case, start)
    name = stage or f"N = {problem.trajectory.grid.intervals}"
    if below is None:
        return pose(problem, case, ledger, name)
    for price in _prices(case, below) if correct else (0.0,):
        found = _warm(problem, case, ledger, below, price, name)
        if found.claimed or ledger.over:
            return found
    return pose(found.problem, case, ledger, f"{name}, again")


def _prices(case: Case, below: Result) -> tuple[float, ...]:
    """Prices of leaving the plan before, in the order in which they are tried: what it took the last time comes first."""
    nearer = price_of(below.problem, case.model.velocity) > PRICE * NEARER**0.5
    return (NEARER * PRICE, PRICE) if nearer else (PRICE, NEARER * PRICE)


def _warm(problem: Problem, case: Case, ledger: Ledger, below: Result, price: float, name: str) -> Result:
    """Solve with the multipliers of a solved grid; at a price of leaving it with the error of the transcription taken off."""
    with ledger.building():
        problem = beside(problem, case, below, price)
    patient = replace(case, iteration_limit=min(WARM, case.iteration_limit))
    return pose(problem, patient, ledger, name, below)


def beside(problem: Problem, case: Case, below: Result, price: float) -> Problem:
    """Start a problem where a solved one ended; at a price of leaving it also with the error of the transcription taken off."""
    plant = case.model.plant()
    problem = started(problem, below, plant)
    return kept_near(without_error(problem, plant), case.model.velocity, price) if price else problem


def higher(case: Case, ledger: Ledger, below: Result) -> Result:
    """Solve from the result of a coarser grid; where that fails by way of a grid in between, else without multipliers."""
    low, high = below.plan.intervals, case.scenario.grid_intervals
    if high < APART * low:
        return rung(case, ledger, below.plan, below)
    with ledger.building():
        problem = posing.phases(case, below.plan)
    found = _warm(problem, case, ledger, below, 0.0, f"N = {high}")
    if found.claimed or ledger.over:
        return found
    middle = rung(on_grid(case, 2 * low), ledger, below.plan, below)
    if middle.claimed and not ledger.over:
        return rung(case, ledger, middle.plan, middle)
    return found if ledger.over else rung(case, ledger, below.plan)


def climb(case: Case, ledger: Ledger, start: Plan) -> Result:
    """Solve on the coarse grid, then on the case's own; directly on its own where the coarse one fails."""
    first = coarse(case)
    below = None if first is case else rung(first, ledger, start)
    if below is None or (not below.claimed and not ledger.over):
        return rung(case, ledger, start)
    return higher(case, ledger, below) if below.claimed else below


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
