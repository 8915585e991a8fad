"""Lower bound on the travel time of a flight with one contact: the vehicle comes from the start, stays, goes to the end.

For a travel time T and a contact from t on that lasts d(T), on every axis the vehicle must be

    within the way from rest of the start at t, and within reach of the target there,
    within the way to rest of the end at t + d, and within reach of the target there,
    and the two places no farther apart than its speed allows in d;

the nose must turn from the start's heading to within the error allowed of the target's at t, and from there at t + d to the end's.
Relaxed: each axis chooses its own places, nothing is asked during the contact, angles are taken the short way round. So what does not
fit is impossible, and the least T that fits is a bound. T and t are searched in cells that are granted all that happens in them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchbench.arrays import Array, Flags, Index
from benchbench.certificate.leg import Leg
from benchbench.certificate.turning import Turning
from benchbench.ocp.contact import SLOW
from benchbench.ocp.motion import sample
from benchbench.ocp.stop import Stop

CELLS = (0.04, 0.005)
"""Widths in s of the cells, the coarse ones first: what they exclude the fine ones need not look at."""
LOOKS = 400
"""Cells of T that are looked at, at most: 16 s of coarse ones, 2 s of fine ones; what is not excluded is not proved."""
SHARP = 0.5
"""rad of turn of the target within a cell from which its direction is taken as any."""


@dataclass(frozen=True, eq=False)
class Visit:
    """One contact on the way from `first` to `last`.

    reach  m of the vehicle's position from the target in contact; inf: anywhere
    error  rad of the nose from the target's direction
    turning  how fast the nose turns; None: any heading
    speed  (3,) m/s, largest on each axis
    """

    first: Leg
    last: Leg
    stop: Stop
    reach: float
    error: float
    turning: Turning | None
    speed: Array

    def least(self, start: float, latest: float) -> float:
        """Return a travel time in s from `start` on that no such flight beats; inf where none up to `latest` fits."""
        for width in CELLS:
            start = self._scan(start, latest, width)
        return start

    def _scan(self, start: float, latest: float, width: float) -> float:
        if start > latest:
            return start
        count = int((latest - start) / width) + 1
        cells = _Cells.of(self, start + min(count, LOOKS) * width, width)
        for i in range(min(count, LOOKS)):
            if cells.fits(start + i * width):
                return start + i * width
        return np.inf if count <= LOOKS else start + LOOKS * width


@dataclass(frozen=True, eq=False)
class _Cells:
    """What the vehicle and the target can do in each cell of time [k w, (k + 1) w], granted what happens within it."""

    visit: Visit
    width: float
    back: tuple[Array, Array]
    ahead: tuple[Array, Array]
    target: Array
    blur: Array
    off: tuple[Array, Array]

    @classmethod
    def of(cls, visit: Visit, latest: float, width: float) -> _Cells:
        time = np.arange(0.0, latest + 4 * width, width)
        target, moving = sample(visit.stop.target, time)
        (back_0, ahead_0), (back_1, ahead_1) = (leg.way(time + width) for leg in (visit.first, visit.last))
        off = _off_heading(visit, moving)
        blur = 3 * width * np.max(np.abs(moving), axis=0)
        return cls(visit, width, (back_0, back_1), (ahead_0, ahead_1), target, blur, off)

    def fits(self, total: float) -> bool:
        """Whether a flight that takes `total` s, or up to a cell longer, may exist."""
        visit, w = self.visit, self.width
        lasts = visit.stop.lasts(total)
        begin = np.arange(max(int(np.ceil((total - lasts) / w)) + 1, 1))
        end = np.minimum(((begin * w + lasts) / w).astype(int), len(self.target) - 1)
        left = np.clip(np.ceil((total - end * w) / w).astype(int), 0, len(self.target) - 1)
        at_most = visit.stop.lasts(total + w)
        if visit.turning is not None:
            before, after = np.asarray((begin + 1) * w, float), np.asarray((left + 1) * w, float)
            off, on = self.off[0][begin], self.off[1][end]
            good = visit.turning.fits(before, off, after, on, at_most + 3 * w)
            begin, end, left = begin[good], end[good], left[good]
        return bool(np.any(self._places(begin, end, left, at_most)))

    def _places(self, begin: Index, end: Index, left: Index, lasts: float) -> Flags:
        """Whether there are places for the vehicle when the contact begins and when it ends."""
        visit, near = self.visit, self.visit.reach + self.blur
        start, goal = visit.first.place, visit.last.place
        low_0 = np.maximum(start - self.back[0][begin], self.target[begin] - near)
        high_0 = np.minimum(start + self.ahead[0][begin], self.target[begin] + near)
        low_1 = np.maximum(goal - self.back[1][left], self.target[end] - near)
        high_1 = np.minimum(goal + self.ahead[1][left], self.target[end] + near)
        apart = np.maximum(low_1 - high_0, low_0 - high_1)
        fits = (low_0 <= high_0) & (low_1 <= high_1) & (apart <= visit.speed * lasts)
        return np.asarray(np.all(fits, axis=1))


def _off_heading(visit: Visit, moving: Array) -> tuple[Array, Array]:
    """How far the nose has to turn from the start and to the end to be right in each cell, at least, signed, (n,) rad each."""
    speed, way = np.linalg.norm(moving[:, :2], axis=1), np.arctan2(moving[:, 1], moving[:, 0])
    jump = np.abs(_short(np.diff(way, append=way[-1])))
    free = _around((speed <= 2 * SLOW) | (jump > SHARP)) > 0
    spare = visit.error + 3 * _around(jump)
    found = []
    for leg in (visit.first, visit.last):
        off = np.zeros(len(way)) if leg.heading is None else _short(way - leg.heading)
        found.append(np.where(free, 0.0, np.sign(off) * np.maximum(np.abs(off) - spare, 0.0)))
    return found[0], found[1]


def _around(values: Array) -> Array:
    """The largest of three cells to either side."""
    padded = np.pad(values, 3, mode="edge")
    return np.max(np.lib.stride_tricks.sliding_window_view(padded, 7), axis=1)


def _short(angle: Array) -> Array:
    """The same angle from -pi to pi."""
    return np.asarray((angle + np.pi) % (2 * np.pi) - np.pi)
