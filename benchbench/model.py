"""Interfaces for a vehicle: the symbolic `Model` that planners use, the numeric `Plant` that judges.

The two are written apart on purpose. A dynamics plugin only sees the `Model`; the certificate only sees
the `Plant`, so that an error in one is found by the other.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from benchbench.plan import Array


@dataclass(frozen=True)
class Coordinates:
    """Names, units and limits of generalised coordinates or inputs; all arrays have shape (n,)."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    lower: Array
    upper: Array

    def index(self, name: str) -> int:
        """Position of a coordinate by name."""
        return self.names.index(name)


class Model(ABC):
    """A vehicle as a planner sees it: a Lagrangian system with generalised forces.

    A model that has no Lagrangian gives `acceleration` instead; variational dynamics then refuse it.
    Symbols are CasADi SX columns: q (n_q), v (n_v), u (n_u). SI units, angles in rad. Usually v = dq/dt; a model
    with quasi-velocities (body rates beside a quaternion) says by `kinematics` what dq/dt is, and has no Lagrangian here.
    """

    name: str

    @property
    @abstractmethod
    def configuration(self) -> Coordinates:
        """Generalised coordinates q and their limits."""

    @property
    @abstractmethod
    def velocity(self) -> Coordinates:
        """Nodal velocities v and their limits."""

    @property
    @abstractmethod
    def inputs(self) -> Coordinates:
        """Inputs u and their limits."""

    def lagrangian(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Return the scalar L(q, v) = K - V in joules."""
        raise NotImplementedError(f"{type(self).__name__} has no Lagrangian")

    def kinematics(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Return dq/dt, shape (n_q,): v itself, unless overridden."""
        return v

    def normalised(self, q: ca.SX) -> ca.SX:
        """Return q moved back to where configurations live (unit quaternions): q itself, unless overridden."""
        return q

    def origin(self) -> Array:
        """Return the configuration (n_q,) in which a scenario's unnamed coordinates are: 0, unless overridden."""
        return np.zeros(len(self.configuration.names))

    def fixed_at_rest(self) -> NDArray[np.bool_]:
        """Which coordinates (n_q,) a place to rest at fixes: all, unless overridden (heading left free)."""
        return np.ones(len(self.configuration.names), bool)

    def specific_thrust(self, flown: Array) -> Array:
        """Largest thrust over mass (n,) in m/s^2 where `flown` (n,) m lie behind; needed to guess races."""
        raise NotImplementedError(f"{type(self).__name__} says nothing about its thrust")

    def follow(
        self, time: Array, position: Array, velocity: Array, thrust: Array
    ) -> tuple[Array, Array, Array]:
        """Guess how to follow a point mass: q (N + 1, n_q), v (N + 1, n_v), u (N, n_u), needed for races.

        time (N + 1,) s, position and velocity (N + 1, 3), thrust over mass (N, 3) in m/s^2, held per interval.
        """
        raise NotImplementedError(f"{type(self).__name__} cannot follow a point mass")

    def velocity_limits(self, flown: Array) -> tuple[Array, Array]:
        """Lower and upper limits of v, each (n, n_v), where `flown` (n,) m of the nominal path lie behind.

        The same everywhere, unless overridden (limits that ramp up).
        """
        shape = (len(flown), 1)
        return np.tile(self.velocity.lower, shape), np.tile(self.velocity.upper, shape)

    def input_limits(self, flown: Array) -> tuple[Array, Array]:
        """Lower and upper limits of u, each (n, n_u), in the same way."""
        return np.tile(self.inputs.lower, (len(flown), 1)), np.tile(self.inputs.upper, (len(flown), 1))

    def acceleration(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """Return dv/dt, shape (n_v,): by the Euler-Lagrange equations (paper Eq. 13-14), unless overridden."""
        lagrangian = self.lagrangian(q, v)
        momentum = ca.gradient(lagrangian, v)
        bias = ca.jtimes(momentum, q, v) - ca.gradient(lagrangian, q)
        return ca.solve(ca.jacobian(momentum, v), self.force(q, v, u) - bias)

    @property
    def has_lagrangian(self) -> bool:
        """Whether `lagrangian` is given."""
        return type(self).lagrangian is not Model.lagrangian

    @abstractmethod
    def force(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """Return the generalised force Q(q, v, u), shape (n_q,), by virtual work."""

    @abstractmethod
    def tool(self, q: ca.SX) -> ca.SX:
        """Return the position of the point that makes contact (end effector), world frame, (3,) m."""

    @abstractmethod
    def nose(self, q: ca.SX) -> ca.SX:
        """Return the body x axis in the world frame, (3,), the direction whose heading counts."""

    @abstractmethod
    def hover(self) -> Array:
        """Return the input u_ref that keeps the vehicle at rest, shape (n_u,)."""

    @abstractmethod
    def plant(self) -> Plant:
        """Return the independent numeric model that the certificate replays plans on."""


class Plant(ABC):
    """A vehicle as a judge sees it: numbers only, no CasADi, batched over leading axes."""

    @abstractmethod
    def acceleration(self, q: Array, v: Array, u: Array) -> Array:
        """Return dv/dt for q (..., n_q), v (..., n_v), u (..., n_u); shape (..., n_v)."""

    def kinematics(self, q: Array, v: Array) -> Array:
        """Return dq/dt, shape (..., n_q): v itself, unless overridden."""
        return v

    @abstractmethod
    def tool(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Return position (..., 3) m and velocity (..., 3) m/s of the end effector."""

    @abstractmethod
    def nose(self, q: Array) -> Array:
        """Return the body x axis in the world frame, shape (..., 3)."""

    @abstractmethod
    def skeleton(self, q: Array) -> dict[str, Array]:
        """Return named polylines to draw, each (points, 3) m, for one configuration q (n_q,)."""


def mass_matrix(model: Model, q: ca.SX, v: ca.SX) -> ca.SX:
    """Return M(q) = d2L/dv2, shape (n_q, n_q)."""
    return ca.hessian(model.lagrangian(q, v), v)[0]


def box(
    names: tuple[str, ...], units: tuple[str, ...], lower: Sequence[float], upper: Sequence[float]
) -> Coordinates:
    """Build `Coordinates` from plain sequences."""
    return Coordinates(names, units, np.asarray(lower, float), np.asarray(upper, float))
