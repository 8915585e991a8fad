"""Interfaces for a vehicle: the symbolic `Model` that planners use, the numeric `Plant` that judges.

The two are written apart on purpose. A dynamics plugin only sees the `Model`; the certificate only sees
the `Plant`, so that an error in one is found by the other.

What only some vehicles have is a class of its own beside `Model`. A plugin lists those that it is:

    LagrangianModel   a Lagrangian and generalised forces; needed by variational dynamics
    ExplicitModel     dv/dt in closed form (one of these two, or both, says how the vehicle moves)
    ManifoldModel     configurations on a manifold, such as unit quaternions
    OutputModel       limits on more than q, v and u
    RampModel         limits that change along the way
    RacingModel       what races, and point-mass guesses, ask for
    TouchingModel     forces of contact with what it must not pass (`ocp/touching.py`)
    FlownModel        an airframe that a world can be made of (`ocp/airframe.py`)
    AgileModel        how far it comes from a standstill, from which travel times are bounded
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ocp.space import Flat, Space

AXES = ("x", "y", "z")
"""Coordinates of the place of a vehicle that moves about; a robot that stands somewhere has none of this name."""
Bounds = tuple[Array, Array]
"""Lower and upper limits, each (n, numbers), at n places of the nominal path."""


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
    """A vehicle as a planner sees it.

    Symbols are CasADi SX columns: q (n_q), v (n_v), u (n_u). SI units, angles in rad. v = dq/dt, unless a
    `ManifoldModel` says otherwise.
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


class LagrangianModel(Model):
    """A Lagrangian system with generalised forces; both are functions of, and dual to, v."""

    @abstractmethod
    def lagrangian(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Return the scalar L(q, v) = K - V in joules."""

    @abstractmethod
    def force(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """Return the generalised force Q(q, v, u), shape (n_v,), by virtual work: Q . v is its power."""


class ExplicitModel(Model):
    """A model that gives its acceleration itself, without a mass matrix to be inverted."""

    @abstractmethod
    def acceleration(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """Return dv/dt, shape (n_v,)."""


class ManifoldModel(Model):
    """A model whose configurations are no vector space, or that has a pose of its own for what is left open."""

    @property
    @abstractmethod
    def space(self) -> Space:
        """Where configurations live; v may be quasi-velocities (body rates beside a quaternion)."""


class OutputModel(Model):
    """A model that limits further quantities y(q, v), such as body rates beside Euler angles."""

    @property
    @abstractmethod
    def outputs(self) -> Coordinates:
        """Names, units and limits of y; there may be none."""

    @abstractmethod
    def output(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Return y(q, v), in the order of `outputs`."""


class RampModel(Model):
    """A model whose limits change along the way: `flown` (n,) m of the nominal path lie behind."""

    @abstractmethod
    def velocity_bounds(self, flown: Array) -> Bounds:
        """Limits of v, each (n, n_v)."""

    @abstractmethod
    def input_bounds(self, flown: Array) -> Bounds:
        """Limits of u, each (n, n_u)."""

    @abstractmethod
    def output_bounds(self, flown: Array) -> Bounds:
        """Limits of y, each (n, n_y)."""


class RacingModel(Model):
    """A model that says what its thrust can do, from which races are guessed and bounded."""

    @abstractmethod
    def specific_thrust(self, flown: Array) -> Array:
        """Largest thrust over mass (n,) in m/s^2 where `flown` (n,) m lie behind."""

    @abstractmethod
    def follow(
        self, time: Array, position: Array, velocity: Array, thrust: Array
    ) -> tuple[Array, Array, Array]:
        """Guess how to follow a point mass: q (N + 1, n_q), v (N + 1, n_v), u (N, n_u).

        time (N + 1,) s, position and velocity (N + 1, 3), thrust over mass (N, 3) in m/s^2, held per interval.
        """


class AgileModel(Model):
    """A model that says how far it comes from a standstill, from which flights are bounded from below."""

    @abstractmethod
    def way_from_rest(self, q: Array, time: Array) -> Bounds:
        """Return metres back and ahead along x, y, z, each (n, 3), that no flight from rest in q (n_q,) passes in `time` (n,) s.

        A proof, for reversed time as well: no flight that comes to rest in q is farther away so long before.
        """

    @property
    @abstractmethod
    def level_yaw_acceleration(self) -> float:
        """Largest angular acceleration in rad/s^2 by which yaw torque alone turns the level vehicle's nose.

        No proof for a flight: rolling and pitching in turn turn the nose as well, by the solid angle that the thrust axis goes round.
        """


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


def box(
    names: tuple[str, ...], units: tuple[str, ...], lower: Sequence[float], upper: Sequence[float]
) -> Coordinates:
    """Build `Coordinates` from plain sequences."""
    return Coordinates(names, units, np.asarray(lower, float), np.asarray(upper, float))


def travels(model: Model) -> bool:
    """Whether the place of the vehicle is among its coordinates, x, y and z."""
    return set(AXES) <= set(model.configuration.names)


def space(model: Model) -> Space:
    """Where the configurations of a model live: in a vector space, unless it says otherwise."""
    return model.space if isinstance(model, ManifoldModel) else Flat(model.configuration.names)


def output_box(model: Model) -> Coordinates:
    """Names, units and limits of a model's further quantities; none, unless it gives some."""
    return model.outputs if isinstance(model, OutputModel) else box((), (), [], [])


def output(model: Model, q: ca.SX, v: ca.SX) -> ca.SX:
    """Return y(q, v), in the order of `output_box`."""
    return model.output(q, v) if isinstance(model, OutputModel) else ca.SX(0, 1)


def velocity_bounds(model: Model, flown: Array) -> Bounds:
    """Limits of v, each (n, n_v), where `flown` (n,) m of the nominal path lie behind."""
    return (
        model.velocity_bounds(flown) if isinstance(model, RampModel) else _everywhere(model.velocity, flown)
    )


def input_bounds(model: Model, flown: Array) -> Bounds:
    """Limits of u, each (n, n_u), in the same way."""
    return model.input_bounds(flown) if isinstance(model, RampModel) else _everywhere(model.inputs, flown)


def output_bounds(model: Model, flown: Array) -> Bounds:
    """Limits of y, each (n, n_y), in the same way."""
    return (
        model.output_bounds(flown) if isinstance(model, RampModel) else _everywhere(output_box(model), flown)
    )


def _everywhere(of: Coordinates, flown: Array) -> Bounds:
    return np.tile(of.lower, (len(flown), 1)), np.tile(of.upper, (len(flown), 1))


def racing(model: Model) -> RacingModel:
    """Return the model; raises TypeError where it says nothing of its thrust, which `validate` told before."""
    if not isinstance(model, RacingModel):
        raise TypeError(f"{type(model).__name__} is no RacingModel")
    return model
