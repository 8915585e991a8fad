"""The only loop over sigma: relax once, build once, solve for each sigma from the last point."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from benchbench.case import Ledger, Task
from benchbench.certificate.residuals import residuals
from benchbench.errors import IncompatibleCase
from benchbench.mpcc import Mpcc
from benchbench.plan import Array
from benchbench.relaxation import Smooth, smooth
from benchbench.solver import Outcome, Point, Prepared, Progress, Setup

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
    mpcc: Mpcc, case: Task, ledger: Ledger, stage: str, near: Solved | None = None, path: Path | None = None
) -> Solved:
    """Solve an MPCC; without pairs it is one smooth solve.

    Each sigma starts from the last good point with fresh multipliers. A sigma that fails does not stop the
    schedule: the next one starts where the failed one did, because nothing leads back from where IPOPT found
    no feasible point or diverged. The last word is the certificate's. Spent time stops it. Held unknowns of a
    relaxation move on after each solve that claims success. The solver is built again after such a move, and when less
    time is left than it was granted.

    near: a solved problem in whose solution this one is guessed. It gives the multipliers of what both have (see
    `carried`), and there is nowhere to be led: only the last sigma is solved.
    path: see `Path`; without one it is the relaxation's schedule, every sigma once.
    """
    ledger.relaxed |= bool(mpcc.pairs)
    with ledger.building():
        smoothed = smooth(mpcc, case.relaxation) if mpcc.pairs else Smooth(mpcc)
        relaxed = smoothed.mpcc
        offsets = relaxed.offsets
        where = (offsets["T"], relaxed.split(relaxed.guess)["T"].size) if "T" in offsets else None
        watch = ledger.watch.stage(stage, where) if ledger.watch else None
        point = Point(relaxed.guess) if near is None else carried(relaxed, near)
    granted = np.inf  # nothing is built yet
    far, path = path is not None, path or Path(case.relaxation.schedule)
    schedule = path.schedule if mpcc.pairs else (0.0,)
    pending = deque(schedule if near is None else schedule[-1:])
    retries, best, outcome, sigma = path.retries, None, None, 0.0
    while pending:
        sigma = pending.popleft()
        if smoothed.mpcc is not relaxed:
            relaxed, granted = smoothed.mpcc, np.inf
            point = Point(np.clip(point.x, relaxed.lower, relaxed.upper))
        if ledger.seconds_left < IN_TIME * granted:
            with ledger.building():
                solve = _prepare(relaxed, case, ledger, watch, near is not None)
            granted = ledger.seconds_left
        outcome = _finite(solve(sigma, point), point)
        ledger.count(outcome, stage)
        ledger.step(stage, sigma, _travel_time(outcome, where))
        if outcome.claim in GOOD:
            point = Point(outcome.point.x)
        if outcome.claim == "solved":
            smoothed = smoothed.after(point.x, sigma)
            best = Solved(outcome, *_original(mpcc, relaxed, point.x), sigma, relaxed)
            if path.enough and residuals(mpcc, best.x).max_product <= path.enough:
                pending.clear()
        elif best is not None and retries > 0:
            retries -= 1
            pending.extendleft((sigma, sqrt(sigma * best.sigma)))
        if outcome.claim == "time_limit" or ledger.over:
            break
    if outcome is None:
        raise ValueError("relaxation.schedule is empty")
    if pending and outcome.claim == "solved" and ledger.over:
        outcome = replace(outcome, claim="time_limit", detail=f"no time was left for sigma = {pending[0]:g}")
    if best is not None and far:  # the claim is that of the whole path
        return replace(best, outcome=replace(best.outcome, claim=outcome.claim, detail=outcome.detail))
    return Solved(outcome, *_original(mpcc, relaxed, outcome.point.x), sigma, relaxed)


def _finite(outcome: Outcome, start: Point) -> Outcome:
    """The outcome; one that is no number is invalid and stays where it started."""
    if np.all(np.isfinite(outcome.point.x)):
        return outcome
    return replace(outcome, claim="invalid", point=start)


def _original(mpcc: Mpcc, relaxed: Mpcc, x: Array) -> tuple[dict[str, Array], Array]:
    """Unknowns by name, and those of the original problem stacked."""
    values = relaxed.split(x)
    return values, np.concatenate([np.zeros(0), *(values[v.name].ravel() for v in mpcc.variables)])


def carried(mpcc: Mpcc, near: Solved) -> Point:
    """Return the guess with the multipliers of another solution.

    Variables and blocks that agree in name and width take them, row by row; where the other grid is coarser or finer,
    from the row at the same share of the way. All others are 0.
    """
    last = near.outcome.point
    if near.relaxed is None or last.lam_x is None or last.lam_g is None:
        return Point(mpcc.guess)
    blocks = near.relaxed.constraints
    cuts = np.split(last.lam_g, np.cumsum([block.lower.size for block in blocks])[:-1])
    of_rows = {block.name: cut.reshape(block.lower.shape) for block, cut in zip(blocks, cuts, strict=True)}
    of_bounds = near.relaxed.split(last.lam_x)
    lam_x = [_spread(of_bounds.get(v.name), v.guess.shape) for v in mpcc.variables]
    lam_g = [_spread(of_rows.get(block.name), block.lower.shape) for block in mpcc.constraints]
    return Point(mpcc.guess, np.concatenate([np.zeros(0), *lam_g]), np.concatenate([np.zeros(0), *lam_x]))


def _spread(values: Array | None, shape: tuple[int, ...]) -> Array:
    """Rows (R, n) on another number of rows, flat; zeros where there are none or of another width."""
    if values is None or values.shape[1:] != shape[1:] or not len(values):
        return np.zeros(shape).ravel()
    same_share = ((np.arange(shape[0]) + 0.5) * len(values) / shape[0]).astype(int)
    return np.asarray(values[same_share]).ravel()


def _travel_time(outcome: Outcome, where: tuple[int, int] | None) -> float | None:
    if where is None or outcome.claim != "solved":
        return None
    return float(outcome.point.x[where[0] : where[0] + where[1]].sum())


def _prepare(relaxed: Mpcc, case: Task, ledger: Ledger, watch: Progress | None, warm: bool) -> Prepared:
    if relaxed.pairs and not case.solver.native_pairs:
        solver, relaxation = case.names["solver"], case.names["relaxation"]
        problem = f"'{relaxation}' leaves the pairs to the solver, but '{solver}' takes none"
        raise IncompatibleCase(
            "relaxation", problem, "another relaxation, or a solver for pairs, such as pyomo"
        )
    setup = Setup(ledger.seconds_left, case.iteration_limit, case.accuracy, case.compile, watch, warm)
    return case.solver.prepare(relaxed, setup)
