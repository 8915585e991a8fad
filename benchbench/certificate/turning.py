"""Whether the nose can turn from one heading to that of a contact and on to another, in given times."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import final

import numpy as np

from benchbench.ground.arrays import Array, Flags


class Turning(ABC):
    """How fast a nose turns; `rate`: rad/s at most."""

    rate: float

    @abstractmethod
    def fits(self, before: Array, off: Array, after: Array, on: Array, lasts: float) -> Flags:
        """Whether it can turn by `off` (n,) rad within `before` (n,) s from rest, and come from `on` rad to rest in `after` s.

        off, on: signed, from the heading at rest; the contact in between takes `lasts` s.
        """


@final
@dataclass(frozen=True)
class ByRate(Turning):
    """Either way takes its angle over the largest rate in rad/s: a proof where the vehicle's yaw rate is limited."""

    rate: float

    def fits(self, before: Array, off: Array, after: Array, on: Array, lasts: float) -> Flags:
        """Both."""
        return np.asarray((self.rate * before >= np.abs(off)) & (self.rate * after >= np.abs(on)))


@final
@dataclass(frozen=True)
class ByTorque(Turning):
    """A double integrator with a largest rate in rad/s and |acceleration| up to so many rad/s^2.

    Out to an angle d > 0 within t, from rest, takes a rate there of at least w = a t - sqrt(2 a^2 t^2 - 4 a d), which may be below zero.
    A turn out and back needs w_out + w_back <= a lasts: what still turns out has to be turned back.
    """

    rate: float
    acceleration: float

    def fits(self, before: Array, off: Array, after: Array, on: Array, lasts: float) -> Flags:
        """Both ways, and where they are on the same side their rates."""
        possible = ByRate(self.rate).fits(before, off, after, on, lasts)
        out, back = self._least_rate(before, np.abs(off)), self._least_rate(after, np.abs(on))
        same = off * on > 0
        return np.asarray(
            possible & np.isfinite(out + back) & (~same | (out + back <= self.acceleration * lasts))
        )

    def _least_rate(self, time: Array, angle: Array) -> Array:
        """Least rate outwards at the angle, (n,) rad/s; inf where it is not reached."""
        inside = 2 * (self.acceleration * time) ** 2 - 4 * self.acceleration * angle
        reached = angle <= self.acceleration * time**2 / 2
        return np.where(reached, self.acceleration * time - np.sqrt(np.maximum(inside, 0.0)), np.inf)
