"""The only loop over sigma: relax once, build once, solve for each sigma from the last point."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace
from math import sqrt
from typing import Self

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ground.errors import IncompatibleCase
from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.residuals import residuals
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.method import Method
from benchbench.nlp.relaxation import Smooth, smooth
from benchbench.nlp.solver import Claim, Outcome, Point, Prepared, Progress, Setup, Warmth
from benchbench.nlp.warm_start import Between, carried, same_share

GOOD = ("solved", "iteration_limit")
"""Claims after which it is worth to go on from where the solver stopped."""
IN_TIME = 0.9
"""A solver hears its time limit when it is built. It is built again once less than this share of that is left."""


@dataclass(frozen=True)
class Solved:
    """The last outcome of a homotopy, its unknowns by name, and x of the original problem (n,).

    `relaxed` is what the solver solved, None where that was no single program.
    """

    outcome: Outcome
    values: dict[str, Array]
    x: Array
    sigma: float
    relaxed: Mpcc | None = None

    def claiming(self, claim: Claim, detail: str) -> Self:
        """Return the same point under another claim."""
        return replace(self, outcome=replace(self.outcome, claim=claim, detail=detail))


@dataclass(frozen=True)
class Path:
    """Values of sigma other than the relaxation's own schedule, for a start from far away.

    In the end the last point solved counts, not the last one tried.
    retries  how often in all a sigma that fails is reached for again from the last one solved, over a sigma
             between the two
    enough   the path ends where no product G H of the original problem exceeds this
    """

    schedule: tuple[float, ...]
    retries: int = 0
    enough: float = 0.0


def homotopy(
    mpcc: Mpcc,
    case: Method,
    ledger: Ledger,
    stage: str,
    near: Solved | None = None,
    path: Path | None = None,
    between: Between = same_share,
) -> Solved:
    """Solve an MPCC; without pairs it is one smooth solve.

    Each sigma starts from the last good point with fresh multipliers. A sigma that fails does not stop the
    schedule: the next one starts where the failed one did, because nothing leads back from where IPOPT found
    no feasible point or diverged. The last word is the certificate's. Spent time stops it.

    near: a solved problem in whose solution this one is guessed. It gives the multipliers of what both have (see
    `carried`), and there is nowhere to be led: only the last sigma is solved.
    between: where the rows of this problem lie on the grid of `near`.
    path: see `Path`; without one it is the relaxation's schedule, every sigma once.
    """
    ledger.relaxed |= bool(mpcc.pairs)
    solves = _Solves(mpcc, case, ledger, stage, near, between)
    far, path = path is not None, path or Path(case.relaxation.schedule)
    schedule = path.schedule if mpcc.pairs else (0.0,)
    pending = deque(schedule if near is None else schedule[-1:])
    retries, best, last = path.retries, None, None
    while pending:
        last = solves.at(pending.popleft())
        if last.outcome.claim == "solved":
            best = last
            if path.enough and residuals(mpcc, best.x).max_product <= path.enough:
                pending.clear()
        elif best is not None and retries > 0:
            retries -= 1
            solves.go_back(best)
            pending.extendleft((last.sigma, sqrt(last.sigma * best.sigma)))
        if last.outcome.claim == "time_limit" or ledger.over:
            break
    if last is None:
        raise ValueError("relaxation.schedule is empty")
    if pending and last.outcome.claim == "solved" and ledger.over:
        last = last.claiming("time_limit", f"no time was left for sigma = {pending[0]:g}")
    if best is not None and far:  # the claim is that of the whole path
        return best.claiming(last.outcome.claim, last.outcome.detail)
    return last


class _Solves:
    """One relaxed problem, solved for one sigma after the other, each from the last good point.

    Held unknowns of the relaxation move on after each solve that claims success. The solver is built again after such
    a move, and when less time is left than it was granted.
    """

    def __init__(
        self, mpcc: Mpcc, case: Method, ledger: Ledger, stage: str, near: Solved | None, between: Between
    ) -> None:
        self._mpcc, self._case, self._ledger, self._stage = mpcc, case, ledger, stage
        self._warm: Warmth = "no" if near is None else "near"
        self._granted = np.inf  # nothing is built yet
        with ledger.building():
            self._smoothed = smooth(mpcc, case.relaxation) if mpcc.pairs else Smooth(mpcc)
            self._relaxed = relaxed = self._smoothed.mpcc
            offsets = relaxed.offsets
            self._steps = (offsets["T"], relaxed.split(relaxed.guess)["T"].size) if "T" in offsets else None
            self._watch = ledger.watch.stage(stage, self._steps) if ledger.watch else None
            self._point = Point(relaxed.guess)
            if near is not None and near.relaxed is not None:
                self._point = carried(relaxed, near.relaxed, near.outcome.point, between)
                self._warm = "near" if near.relaxed.size == relaxed.size else "prolongated"

    def go_back(self, solved: Solved) -> None:
        """Start the next solve from an earlier one; what is held stays where it is held now."""
        self._point = self._within(solved.outcome.point.x)

    def at(self, sigma: float) -> Solved:
        """Solve for one sigma, whatever comes of it."""
        if self._smoothed.mpcc is not self._relaxed:
            self._relaxed, self._granted = self._smoothed.mpcc, np.inf
            self._point = self._within(self._point.x)
        if self._ledger.seconds_left < IN_TIME * self._granted:
            with self._ledger.building():
                self._solve = _prepare(self._relaxed, self._case, self._ledger, self._watch, self._warm)
            self._granted = self._ledger.seconds_left
        outcome = _finite(self._solve(sigma, self._point), self._point)
        self._ledger.count(outcome, self._stage)
        self._ledger.step(self._stage, sigma, _travel_time(outcome, self._steps))
        if outcome.claim in GOOD:
            self._point = Point(outcome.point.x)
        if outcome.claim == "solved":
            self._smoothed = self._smoothed.after(self._point.x, sigma)
        return Solved(outcome, *_original(self._mpcc, self._relaxed, outcome.point.x), sigma, self._relaxed)

    def _within(self, x: Array) -> Point:
        return Point(np.clip(x, self._relaxed.lower, self._relaxed.upper))


def _finite(outcome: Outcome, start: Point) -> Outcome:
    """The outcome; one that is no number is invalid and stays where it started."""
    if np.all(np.isfinite(outcome.point.x)):
        return outcome
    return replace(outcome, claim="invalid", point=start)


def _original(mpcc: Mpcc, relaxed: Mpcc, x: Array) -> tuple[dict[str, Array], Array]:
    """Unknowns by name, and those of the original problem stacked."""
    values = relaxed.split(x)
    return values, np.concatenate([np.zeros(0), *(values[v.name].ravel() for v in mpcc.variables)])


def _travel_time(outcome: Outcome, where: tuple[int, int] | None) -> float | None:
    if where is None or outcome.claim != "solved":
        return None
    return float(outcome.point.x[where[0] : where[0] + where[1]].sum())


def _prepare(relaxed: Mpcc, case: Method, ledger: Ledger, watch: Progress | None, warm: Warmth) -> Prepared:
    if relaxed.pairs and not case.solver.native_pairs:
        solver, relaxation = case.names["solver"], case.names["relaxation"]
        problem = f"'{relaxation}' leaves the pairs to the solver, but '{solver}' takes none"
        raise IncompatibleCase(
            "relaxation", problem, "another relaxation, or a solver for pairs, such as pyomo"
        )
    setup = Setup(ledger.seconds_left, case.iteration_limit, case.accuracy, case.compile, watch, warm)
    return case.solver.prepare(relaxed, setup)
