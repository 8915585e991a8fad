"""How a target moves: the interface, shared by planner (symbols) and certificate (numbers)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import singledispatch
from typing import final

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array

BATCH = 1000
"""Times of a target that are evaluated together: CasADi's time to make a map grows with its length."""


class Motion(ABC):
    """Position of a target over time.

    The numbers of a motion (centre, speed, ...) enter through `parameters`, not as constants of the
    expression, so that one compiled block serves every target of the same kind.
    """

    @property
    @abstractmethod
    def parameters(self) -> Array:
        """All numbers of this motion, shape (n_p,), SI units."""

    @abstractmethod
    def position(self, time: ca.SX, parameters: ca.SX) -> ca.SX:
        """Return the position at `time` (scalar, s) for `parameters` (n_p,), shape (3,) m, world frame."""


@final
class Nowhere(Motion):
    """The target of a condition that asks for none: the origin."""

    @property
    def parameters(self) -> Array:
        """None."""
        return np.zeros(0)

    def position(self, time: ca.SX, parameters: ca.SX) -> ca.SX:
        """Return the origin."""
        return ca.SX.zeros(3)


def motion_state(motion: Motion, time: ca.SX, parameters: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return symbolic position (3,) m and velocity (3,) m/s of a target at a symbolic time."""
    position, velocity = _state_function(motion)(time, parameters)
    return position, velocity


@singledispatch
def sample(motion: Motion, times: Array) -> tuple[Array, Array]:
    """Return positions (n, 3) m and velocities (n, 3) m/s at the given times (n,) s.

    A motion that is data registers an evaluation of its own, so that what judges a plan does not read the planner's table.
    """
    return planned(motion, times)


def planned(motion: Motion, times: Array) -> tuple[Array, Array]:
    """Return the same from the expression that the planner uses."""
    size = max(1, min(len(times), BATCH))
    batch = _state_function(motion).map("target", "serial", size, [1], [])
    padded = np.resize(times, (-(-len(times) // size), size))
    found = [batch(row[None, :], motion.parameters) for row in padded]
    position, velocity = (np.hstack([part.full() for part in parts]).T for parts in zip(*found, strict=True))
    return position[: len(times)], velocity[: len(times)]


def same_kind(one: Motion, other: Motion) -> bool:
    """Whether two motions differ in their parameters only."""
    return Kind(one).has(other)


@final
class Kind:
    """Motions that differ in their parameters only: one function for all, since to make it takes longer than to evaluate it."""

    def __init__(self, motion: Motion) -> None:
        """Of one of them."""
        self._place = _place_function(motion)
        self._told = self._place.serialize()

    def has(self, motion: Motion) -> bool:
        """Whether another motion is one of them."""
        return _place_function(motion).serialize() == self._told

    def places(self, motion: Motion, times: Array) -> Array:
        """Return positions (n, 3) m of one of them at times (n,) s."""
        return np.asarray(self._place(times[None, :], motion.parameters).full().T)


def _place_function(motion: Motion) -> ca.Function:
    """The position; its derivative says nothing more, and takes most of the time to make."""
    t, p = ca.SX.sym("t"), ca.SX.sym("p", len(motion.parameters))
    return ca.Function("target", [t, p], [motion.position(t, p)])


def _state_function(motion: Motion) -> ca.Function:
    t, p = ca.SX.sym("t"), ca.SX.sym("p", len(motion.parameters))
    position = motion.position(t, p)
    return ca.Function("target", [t, p], [position, ca.jacobian(position, t)])
