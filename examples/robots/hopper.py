"""A hopper, as planners see it: Lagrange, and the ground as complementarity."""

from typing import final

import casadi as ca
import numpy as np
from hopper_plant import HopperPlant
from pydantic.dataclasses import dataclass

from benchbench import Array, Coordinates, LagrangianModel, Plant, TouchingModel
from benchbench.ocp.model import box
from benchbench.ocp.scenario import NonNegative, Positive, Range


@final
@dataclass(frozen=True)
class Hopper(LagrangianModel, TouchingModel):
    """q = [foot, leg] in m: height of the foot above where it rests, length of the leg; u = [push, ground] in N; moves along z.

    body_mass, foot_mass kg; damping of the leg N s/m; gravity m/s^2; limits of the leg m, of both rates m/s, of the push along the leg
    and of the ground N. The ground gives by `stiffness` N/m, and only pushes.
    """

    name: str
    body_mass: Positive
    foot_mass: Positive
    damping: NonNegative
    gravity: Positive
    leg: Range
    rate: Positive
    push: Positive
    ground: Positive
    stiffness: Positive

    @property
    def configuration(self) -> Coordinates:
        """Foot and leg; the foot may go as deep as the ground gives."""
        return box(
            ("foot", "leg"), ("m", "m"), [-self.ground / self.stiffness, self.leg[0]], [np.inf, self.leg[1]]
        )

    @property
    def velocity(self) -> Coordinates:
        """Their rates."""
        return box(("foot", "leg"), ("m/s", "m/s"), [-self.rate] * 2, [self.rate] * 2)

    @property
    def inputs(self) -> Coordinates:
        """Force of the leg between body and foot, and of the ground."""
        return box(("push", "ground"), ("N", "N"), [-self.push, 0.0], [self.push, self.ground])

    @property
    def touches(self) -> tuple[str, ...]:
        """The ground."""
        return ("ground",)

    @property
    def surroundings(self) -> dict[str, Array]:
        """The ground, where nothing stands on it."""
        return {"ground": np.array([[-0.2, 0.0, self.sunk], [0.2, 0.0, self.sunk]])}

    @property
    def weight(self) -> float:
        """Of both masses, N."""
        return (self.body_mass + self.foot_mass) * self.gravity

    @property
    def sunk(self) -> float:
        """How far the ground gives where the hopper rests, m."""
        return self.weight / self.stiffness

    def contact(self, q: ca.SX, v: ca.SX, u: ca.SX) -> tuple[ca.SX, ca.SX]:
        """0 <= force, perpendicular to, 0 <= height above ground + force / stiffness; in units of the weight."""
        return u[1] / self.weight, (u[1] + self.stiffness * (q[0] - self.sunk)) / self.weight

    def lagrangian(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Kinetic energy of both masses, less their weight times height."""
        kinetic = (self.foot_mass * v[0] ** 2 + self.body_mass * (v[0] + v[1]) ** 2) / 2
        return kinetic - self.gravity * (self.foot_mass * q[0] + self.body_mass * (q[0] + q[1]))

    def force(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """Ground on the foot; push, less damping, along the leg."""
        return ca.vertcat(u[1], u[0] - self.damping * v[1])

    def tool(self, q: ca.SX) -> ca.SX:
        """The body."""
        return ca.vertcat(0, 0, q[0] + q[1])

    def nose(self, q: ca.SX) -> ca.SX:
        """It does not turn."""
        return ca.SX([1, 0, 0])

    def hover(self) -> Array:
        """The leg carries the body, the ground both."""
        return np.array([self.body_mass * self.gravity, self.weight])

    def plant(self) -> Plant:
        """Newton's law for each mass."""
        return HopperPlant(self)
