"""The rest of a solution as a start: what is left of it after some time has gone, on the same grid."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from benchbench.ground.arrays import Array, Index
from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.solver import Point
from benchbench.transcription.grid import Grid


def marks(count: int, intervals: int) -> Array:
    """Where rows that belong to nodes or to parts of intervals are, (count,), in intervals from the beginning."""
    if count == intervals + 1:
        return np.arange(intervals + 1.0)
    return np.asarray((np.arange(count) + 0.5) / (count // intervals))


@dataclass(frozen=True)
class Shift:
    """Moves rows that belong to nodes or intervals to where the new nodes and intervals lie in the old plan.

    duration  (phases,) s, durations of the old plan
    elapsed   s that have gone, less than the first phase lasts
    """

    grid: Grid
    duration: Array
    elapsed: float

    @property
    def rest(self) -> Array:
        """Durations of what is left, (phases,) s."""
        rest = self.duration.copy()
        rest[0] -= self.elapsed
        return rest

    def point(self, mpcc: Mpcc, last: Point) -> Point:
        """Unknowns and multipliers of the rest, for a problem without pairs whose durations are T."""
        x = self._unknowns(mpcc, last.x, durations=self.rest)
        if last.lam_x is None or last.lam_g is None:
            return Point(x)
        return Point(x, self._multipliers(mpcc, last.lam_g), self._unknowns(mpcc, last.lam_x))

    def rows(self, values: Array) -> Array:
        """Rows (R, n) of the nodes (R = N + 1) or of parts of intervals (R = k N), moved; others stay."""
        n = self.grid.intervals
        if len(values) != n + 1 and (len(values) < n or len(values) % n):
            return values
        if len(values) not in self._places:
            self._places[len(values)] = self._place(len(values))
        right, share = self._places[len(values)]
        return np.asarray((1 - share) * values[right - 1] + share * values[right])

    @cached_property
    def _places(self) -> dict[int, tuple[Index, Array]]:
        """What `_place` gave, by the number of rows."""
        return {}

    def _place(self, count: int) -> tuple[Index, Array]:
        """Which old row is next after each new one, (R,), and its share, (R, 1)."""
        n = self.grid.intervals
        old, new = (np.interp(marks(count, n), np.arange(n + 1.0), times) for times in self._nodes)
        right = np.clip(np.searchsorted(old, new), 1, len(old) - 1)
        share = np.clip((new - old[right - 1]) / (old[right] - old[right - 1]), 0.0, 1.0)
        return right, share[:, None]

    @cached_property
    def _nodes(self) -> tuple[Array, Array]:
        """When the old plan is at its nodes, and when the rest is at its own, (N + 1,) s of the old plan each."""
        weights = self.grid.time_weights
        return weights @ self.duration, self.elapsed + weights @ self.rest

    def _unknowns(self, mpcc: Mpcc, x: Array, durations: Array | None = None) -> Array:
        parts = {name: self.rows(values) for name, values in mpcc.split(x).items()}
        if durations is not None:
            parts["T"] = durations[:, None]
        return np.concatenate([part.ravel() for part in parts.values()])

    def _multipliers(self, mpcc: Mpcc, lam_g: Array) -> Array:
        sizes = [b.lower.size for b in mpcc.constraints]
        parts = np.split(lam_g, np.cumsum(sizes)[:-1])
        shapes = [b.lower.shape for b in mpcc.constraints]
        moved = [self.rows(p.reshape(s)).ravel() for p, s in zip(parts, shapes, strict=True)]
        return np.concatenate([np.zeros(0), *moved])
