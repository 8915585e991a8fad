"""Lower bound on the travel time of a flight with one contact: the vehicle comes from the start, stays, goes to the end.

For a travel time T and a contact from t on that lasts d(T), on every axis the vehicle must be

    within the way from rest of the start at t, and within reach of the target there,
    within the way to rest of the end at t + d, and within reach of the target there,
    and the two places no farther apart than its speed allows in d;

the nose must turn from the start's heading to within the error allowed of the target's at t, and from there at t + d to the end's, and
follow the target's turn in between. Relaxed: each axis chooses its own places, angles are taken the short way round. So what does not
fit is impossible, and the least T that fits is a bound. T and t are searched in cells that are granted all that happens in them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from benchbench.certificate.course import Course
from benchbench.certificate.leg import Leg
from benchbench.certificate.turning import Turning
from benchbench.ground.arrays import Array, Flags, Index
from benchbench.ocp.motion import sample
from benchbench.ocp.stop import Stop

COARSE = (0.04, 800)
"""Width in s of the cells that are looked at first, and how many of them at most; what is not excluded is not proved."""
FINE = (0.005, 400)
"""The same of those that begin where the coarse ones cannot exclude."""
SOON = 4.0
"""s after the start of the search in which a contact is looked for first."""
Ask = Literal["come", "stay", "go", "turn", "follow"]
ALL: frozenset[Ask] = frozenset(("come", "stay", "go", "turn", "follow"))
DURING: frozenset[Ask] = frozenset(("stay", "follow"))
"""What a flight may be asked for: to come from the start, to stay near the target, to go to the end, to turn the nose there and back, to
keep it turned to the target. DURING: what is asked of the contact alone."""


@dataclass(frozen=True, eq=False)
class Visit:
    """One contact on the way from `first` to `last`.

    reach  m of the vehicle's position from the target in contact; inf: anywhere
    error  rad of the nose from the target's direction
    turning  how fast the nose turns; None: any heading
    speed  (3,) m/s, largest on each axis
    asks   what is asked; the rest is forgiven
    """

    first: Leg
    last: Leg
    stop: Stop
    reach: float
    error: float
    turning: Turning | None
    speed: Array
    asks: frozenset[Ask] = ALL

    def least(self, start: float, latest: float) -> float:
        """Return a travel time in s from `start` on that no such flight beats; inf where none up to `latest` fits."""
        if not self.contact_fits(start, latest):
            return np.inf
        for width, looks in (COARSE, FINE):
            start = self._scan(start, latest, width, looks)
        return start

    def possible(self, start: float, latest: float) -> bool:
        """Whether a flight that takes from `start` to `latest` s is not excluded, by the coarse cells where all of it is asked."""
        if not self.contact_fits(start, latest):
            return False
        return self.asks <= DURING or bool(np.isfinite(self._scan(start, latest, *COARSE)))

    def contact_fits(self, start: float, latest: float) -> bool:
        """Whether what is asked during a contact can be kept at any time, for as long as one of a flight of `start` s lasts.

        A longer contact contains one of that length, so this excludes all longer flights, too.
        """
        lasts, during = self.stop.lasts(start), replace(self, asks=self.asks & DURING)
        if latest < lasts:
            return False
        soon = min(latest, start + SOON)  # where it usually fits, so that the rest need not be looked at
        return not during.asks or any(_Cells.of(during, t, FINE[0]).holds(lasts, t) for t in (soon, latest))

    def _scan(self, start: float, latest: float, width: float, looks: int) -> float:
        if start > latest:
            return start
        count = int((latest - start) / width) + 1
        cells = _Cells.of(self, start + min(count, looks) * width, width)
        for i in range(min(count, looks)):
            if cells.fits(start + i * width):
                return start + i * width
        return np.inf if count <= looks else start + looks * width


@dataclass(frozen=True, eq=False)
class _Cells:
    """What the vehicle and the target can do in each cell of time [k w, (k + 1) w], granted what happens within it."""

    visit: Visit
    width: float
    back: tuple[Array, Array]
    ahead: tuple[Array, Array]
    target: Array
    blur: Array
    course: Course

    @classmethod
    def of(cls, visit: Visit, latest: float, width: float) -> _Cells:
        time = np.arange(0.0, latest + 4 * width, width)
        target, moving = sample(visit.stop.target, time)
        (back_0, ahead_0), (back_1, ahead_1) = (leg.way(time + width) for leg in (visit.first, visit.last))
        blur = 3 * width * np.max(np.abs(moving), axis=0)
        return cls(
            visit, width, (back_0, back_1), (ahead_0, ahead_1), target, blur, Course.of(moving, visit.error)
        )

    def fits(self, total: float) -> bool:
        """Whether a flight that takes `total` s, or up to a cell longer, may exist."""
        lasts = self.visit.stop.lasts
        return self.holds(lasts(total), total, lasts(total + self.width))

    def holds(self, lasts: float, total: float, at_most: float | None = None) -> bool:
        """Whether a contact of `lasts` to `at_most` s may be part of it; `lasts` exactly where nothing else is said."""
        w, at_most = self.width, lasts if at_most is None else at_most
        begin = np.arange(max(int(np.ceil((total - lasts) / w)) + 1, 1))
        end = np.minimum(((begin * w + lasts) / w).astype(int), len(self.target) - 1)
        left = np.clip(np.ceil((total - end * w) / w).astype(int), 0, len(self.target) - 1)
        good = self._turns(begin, end, left, at_most) & self._places(begin, end, left, at_most)
        return bool(np.any(good))

    def _turns(self, begin: Index, end: Index, left: Index, lasts: float) -> Flags:
        """Whether the nose can be right when the contact begins, when it ends, and in between."""
        visit, w, good = self.visit, self.width, np.ones(len(begin), bool)
        if visit.turning is None:
            return good
        if "turn" in visit.asks:
            before, after = np.asarray((begin + 1) * w, float), np.asarray((left + 1) * w, float)
            off = self.course.off(visit.first.heading)[begin]
            on = self.course.off(visit.last.heading)[end]
            good &= visit.turning.fits(before, off, after, on, lasts + 3 * w)
        if "follow" in visit.asks:
            good &= self.course.followed(begin, end, visit.turning.rate * lasts)
        return good

    def _places(self, begin: Index, end: Index, left: Index, lasts: float) -> Flags:
        """Whether there are places for the vehicle when the contact begins and when it ends."""
        visit, near = self.visit, self.visit.reach + self.blur
        start, goal = visit.first.place, visit.last.place
        low_0, high_0 = self.target[begin] - near, self.target[begin] + near
        low_1, high_1 = self.target[end] - near, self.target[end] + near
        if "come" in visit.asks:
            low_0 = np.maximum(start - self.back[0][begin], low_0)
            high_0 = np.minimum(start + self.ahead[0][begin], high_0)
        if "go" in visit.asks:
            low_1 = np.maximum(goal - self.back[1][left], low_1)
            high_1 = np.minimum(goal + self.ahead[1][left], high_1)
        fits = (low_0 <= high_0) & (low_1 <= high_1)
        if "stay" in visit.asks:
            fits &= np.maximum(low_1 - high_0, low_0 - high_1) <= visit.speed * lasts
        return np.asarray(np.all(fits, axis=1))
