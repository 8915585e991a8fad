"""How a target moves: the interface, shared by planner (symbols) and certificate (numbers)."""

from __future__ import annotations

from abc import ABC, abstractmethod

import casadi as ca
import numpy as np

from benchbench.plan import Array


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


def motion_state(motion: Motion, time: ca.SX, parameters: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return symbolic position (3,) m and velocity (3,) m/s of a target at a symbolic time."""
    position, velocity = _state_function(motion)(time, parameters)
    return position, velocity


def sample(motion: Motion, times: Array) -> tuple[Array, Array]:
    """Return positions (n, 3) m and velocities (n, 3) m/s at the given times (n,) s."""
    numbers = np.tile(motion.parameters[:, None], len(times))
    position, velocity = _state_function(motion).map(len(times))(np.asarray(times)[None, :], numbers)
    return np.asarray(position).T, np.asarray(velocity).T


def _state_function(motion: Motion) -> ca.Function:
    t, p = ca.SX.sym("t"), ca.SX.sym("p", len(motion.parameters))
    position = motion.position(t, p)
    return ca.Function("target", [t, p], [position, ca.jacobian(position, t)])
