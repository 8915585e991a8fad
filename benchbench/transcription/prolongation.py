"""Where the nodes and intervals of one grid lie on another one of the same phases."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from benchbench.ground.arrays import Array, Index
from benchbench.transcription.grid import Grid

Rows = Callable[[int, int], tuple[Index, Array] | None]


def prolongation(old: Grid, new: Grid) -> Rows:
    """Return a function of the numbers of rows on both grids that tells, of each new row, its old row and its share of it.

    Rows belong to nodes (N + 1 of them) or to parts of intervals (k N); of others, and of grids with other phases, the
    function returns None. The share is how much shorter the step is there: between grids of equal steps, N old over N new.
    """
    same = [p.name for p in old.phases] == [p.name for p in new.phases]
    (nodes, steps), (new_nodes, new_steps) = _marks(old), _marks(new)

    def rows(before: int, now: int) -> tuple[Index, Array] | None:
        if not same:
            return None
        if before == old.intervals + 1 and now == new.intervals + 1:
            which = np.argmin(np.abs(new_nodes[:, None] - nodes), axis=1)
            return which, _widths(new_steps) / _widths(steps)[which]
        parts, rest = divmod(before, old.intervals)
        if rest or now != parts * new.intervals:
            return None
        middles = (new_nodes[:-1] + new_nodes[1:]) / 2
        own = np.clip(np.searchsorted(nodes, middles, side="right") - 1, 0, old.intervals - 1)
        which = (own[:, None] * parts + np.arange(parts)).ravel()
        return which, np.repeat(new_steps / steps[own], parts)

    return rows


def _marks(grid: Grid) -> tuple[Array, Array]:
    """Nodes (N + 1,) and steps (N,) when every phase lasts 1."""
    steps = np.concatenate([phase.steps for phase in grid.phases])
    return np.concatenate([[0.0], np.cumsum(steps)]), steps


def _widths(steps: Array) -> Array:
    """What a node stands for: half of the steps beside it, (N + 1,)."""
    return (np.append(steps, 0.0) + np.append(0.0, steps)) / 2
