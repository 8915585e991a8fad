"""Forced, damped pendulum: the smallest model on which an error of order one in the forces shows."""

from __future__ import annotations

from typing import final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ocp.model import Coordinates, LagrangianModel, Plant, box
from benchbench.ocp.scenario import NonNegative, Positive, Range


@final
@dataclass(frozen=True)
class Pendulum(LagrangianModel):
    """q = [angle] from hanging straight down, u = [torque] at the pivot; swings in the x-z plane.

    L = m l^2 v^2 / 2 + m g l cos q, Q = u - c v. mass m kg, length l m, damping c N m s/rad, gravity m/s^2;
    limits of angle rad, rate rad/s and torque N m. The tool is the bob, the nose its direction of motion.
    """

    name: str = "pendulum"
    mass: Positive = 0.5
    length: Positive = 0.8
    damping: NonNegative = 0.4
    gravity: Positive = 9.8066
    angle: Range = (-np.pi, np.pi)
    rate: Positive = 8.0
    torque: Range = (-5.0, 5.0)

    @property
    def configuration(self) -> Coordinates:
        """The angle."""
        return box(("angle",), ("rad",), self.angle[:1], self.angle[1:])

    @property
    def velocity(self) -> Coordinates:
        """Its rate."""
        return box(("angle",), ("rad/s",), [-self.rate], [self.rate])

    @property
    def inputs(self) -> Coordinates:
        """The torque."""
        return box(("torque",), ("N m",), self.torque[:1], self.torque[1:])

    def lagrangian(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """L = m l^2 v^2 / 2 + m g l cos q."""
        kinetic = self.mass * self.length**2 * v[0] ** 2 / 2
        return kinetic + self.mass * self.gravity * self.length * ca.cos(q[0])

    def force(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """Q = u - c v."""
        return u - self.damping * v

    def tool(self, q: ca.SX) -> ca.SX:
        """Bob, the pivot is the origin."""
        return self.length * ca.vertcat(ca.sin(q[0]), 0, -ca.cos(q[0]))

    def nose(self, q: ca.SX) -> ca.SX:
        """Unit vector along the bob's path for a positive rate."""
        return ca.vertcat(ca.cos(q[0]), 0, ca.sin(q[0]))

    def hover(self) -> Array:
        """No torque, hanging straight down."""
        return np.zeros(1)

    def plant(self) -> Plant:
        """Balance of moments in numbers."""
        return PendulumPlant(self.mass, self.length, self.damping, self.gravity)


@final
class PendulumPlant(Plant):
    """Newton's law for a point mass on a rod, along the tangent of its path; NumPy only."""

    def __init__(self, mass: float, length: float, damping: float, gravity: float) -> None:
        """SI units, see `Pendulum`."""
        self._mass, self._length, self._damping, self._gravity = mass, length, damping, gravity

    def acceleration(self, q: Array, v: Array, u: Array) -> Array:
        """Tangential force (..., 1) over mass and length."""
        weight = self._mass * self._gravity * np.array([0.0, 0.0, -1.0])
        tangential = self.nose(q) @ weight + (u[..., 0] - self._damping * v[..., 0]) / self._length
        return np.asarray(tangential / (self._mass * self._length))[..., None]

    def tool(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Bob and its velocity, (..., 3)."""
        radial = np.stack([np.sin(q[..., 0]), np.zeros(q.shape[:-1]), -np.cos(q[..., 0])], axis=-1)
        return self._length * radial, self._length * v * self.nose(q)

    def nose(self, q: Array) -> Array:
        """Tangent of the path (..., 3)."""
        return np.stack([np.cos(q[..., 0]), np.zeros(q.shape[:-1]), np.sin(q[..., 0])], axis=-1)

    def skeleton(self, q: Array) -> dict[str, Array]:
        """The rod."""
        return {"rod": np.stack([np.zeros(3), self.tool(q, np.zeros_like(q))[0]])}
