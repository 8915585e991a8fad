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

from benchbench.arrays import Array, Flags


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
    with quasi-velocities (body rates beside a quaternion) says by `kinematics` what dq/dt is, linear in v, and by
    `difference` and `constraint` where its configurations live; L and Q are then functions of, and dual to, v.
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

    def difference(self, q0: ca.SX, q1: ca.SX) -> ca.SX:
        """Return the constant v (n_v,) that leads from q0 to q1 in unit time: q1 - q0, unless overridden.

        Odd, difference(q0, q1) = -difference(q1, q0), and exact to second order are enough.
        """
        return q1 - q0

    def constraint(self, q: ca.SX) -> ca.SX:
        """Return what is zero (m,) where configurations live (|quaternion|^2 - 1): nothing, unless overridden."""
        return ca.SX(0, 1)

    @property
    def outputs(self) -> Coordinates:
        """Further quantities y(q, v) with limits (body rates beside Euler angles): none, unless overridden."""
        return box((), (), [], [])

    def output(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Return y(q, v), in the order of `outputs`."""
        return ca.SX(0, 1)

    def output_limits(self, flown: Array) -> tuple[Array, Array]:
        """Lower and upper limits of y, each (n, n_y), as `velocity_limits`."""
        return np.tile(self.outputs.lower, (len(flown), 1)), np.tile(self.outputs.upper, (len(flown), 1))

    def origin(self) -> Array:
        """Return the configuration (n_q,) in which a scenario's unnamed coordinates are: 0, unless overridden."""
        return np.zeros(len(self.configuration.names))

    def headed(self, q: Array, heading: float) -> Array:
        """Return q (n_q,) turned to a heading in rad, to guess handovers: sets yaw where there is one."""
        turned = q.copy()
        if "yaw" in self.configuration.names:
            turned[self.configuration.index("yaw")] = heading
        return turned

    def fixed_at_rest(self) -> Flags:
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
        momentum = ca.gradient(self.lagrangian(q, v), v)
        drift = ca.jtimes(momentum, q, self.kinematics(q, v))
        return ca.solve(ca.jacobian(momentum, v), self.momentum_rate(q, v, u) - drift)

    def momentum_rate(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """Return d/dt dL/dv, shape (n_v,): dL/dq + Q, and where v is not dq/dt the Boltzmann-Hamel terms.

        With dq/dt = K(q) v and v = P(q) dq/dt: K^T dL/dq + Q + K^T (A^T - A) dq/dt, A = d(P^T dL/dv)/dq
        (for body rates that is the momentum crossed with omega).
        """
        lagrangian, rate = self.lagrangian(q, v), self.kinematics(q, v)
        slope = ca.gradient(lagrangian, q)
        if not self.has_quasi_velocities:
            return slope + self.force(q, v, u)
        other, fixed = ca.SX.sym("other", q.shape[0]), ca.SX.sym("momentum", v.shape[0])
        inverse = ca.substitute(ca.jacobian(self.difference(q, other), other), other, q)
        curl = ca.jacobian(inverse.T @ fixed, q)
        twist = ca.substitute((curl.T - curl) @ rate, fixed, ca.gradient(lagrangian, v))
        return ca.jacobian(rate, v).T @ (slope + twist) + self.force(q, v, u)

    @property
    def has_lagrangian(self) -> bool:
        """Whether `lagrangian` is given."""
        return type(self).lagrangian is not Model.lagrangian

    @property
    def has_acceleration(self) -> bool:
        """Whether the model gives `acceleration` itself, without a mass matrix to be inverted."""
        return type(self).acceleration is not Model.acceleration

    @property
    def has_quasi_velocities(self) -> bool:
        """Whether v is something else than dq/dt."""
        return self.velocity.names != self.configuration.names

    @abstractmethod
    def force(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """Return the generalised force Q(q, v, u), shape (n_v,), by virtual work: Q . v is its power."""

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

    def output(self, q: Array, v: Array) -> Array:
        """Return the model's further limited quantities, shape (..., n_y): none, unless overridden."""
        return np.zeros((*q.shape[:-1], 0))

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
    """Return M(q) = d2L/dv2, shape (n_v, n_v)."""
    return ca.hessian(model.lagrangian(q, v), v)[0]


def box(
    names: tuple[str, ...], units: tuple[str, ...], lower: Sequence[float], upper: Sequence[float]
) -> Coordinates:
    """Build `Coordinates` from plain sequences."""
    return Coordinates(names, units, np.asarray(lower, float), np.asarray(upper, float))
