"""Multipliers of one problem's solution, as the start of another problem that shares variables or constraints."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from benchbench.ground.arrays import Array, Index
from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.solver import Point

Between = Callable[[int, int], "tuple[Index, Array] | None"]
"""Where the rows of a finer grid lie in a coarser one, of which each has so many: which row each has its multiplier from, and
by what share of it; None where that is not known."""


def same_share(before: int, now: int) -> tuple[Index, Array]:
    """Rows at the same share of the way, all rows equal."""
    share = before / now
    return ((np.arange(now) + 0.5) * share).astype(np.int64), np.full(now, share)


def carried(mpcc: Mpcc, solved: Mpcc, solution: Point, between: Between = same_share) -> Point:
    """Return the guess of `mpcc` with the multipliers that `solution` of the problem `solved` has.

    Variables and blocks that agree in name and width take them, row by row; where the other grid is coarser or finer,
    from where `between` says, else from the row at the same share of the way. There those of inequalities and bounds, which are spent along the way, are
    divided among more rows; those of equations, adjoints of the state, stay as they are. All others are 0.
    """
    if solution.lam_x is None or solution.lam_g is None:
        return Point(mpcc.guess)
    blocks = solved.constraints
    cuts = np.split(solution.lam_g, np.cumsum([block.lower.size for block in blocks])[:-1])
    of_rows = {block.name: cut.reshape(block.lower.shape) for block, cut in zip(blocks, cuts, strict=True)}
    of_bounds = solved.split(solution.lam_x)
    lam_x = [_spread(of_bounds.get(v.name), v.guess.shape, True, between) for v in mpcc.variables]
    lam_g = [
        _spread(of_rows.get(b.name), b.lower.shape, bool(np.any(b.lower < b.upper)), between)
        for b in mpcc.constraints
    ]
    return Point(mpcc.guess, np.concatenate([np.zeros(0), *lam_g]), np.concatenate([np.zeros(0), *lam_x]))


def _spread(values: Array | None, shape: tuple[int, ...], divided: bool, between: Between) -> Array:
    """Rows (R, n) on another number of rows, flat; zeros where there are none or of another width."""
    if values is None or values.shape[1:] != shape[1:] or not len(values):
        return np.zeros(shape).ravel()
    if len(values) == shape[0] and between is same_share:
        return values.ravel()
    which, share = between(len(values), shape[0]) or same_share(len(values), shape[0])
    return np.asarray(values[which] * (share[:, None] if divided else 1.0)).ravel()
