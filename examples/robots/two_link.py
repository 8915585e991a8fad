"""A planar arm of two links on a table, as planners see it: Lagrange. Its plant is `two_link_plant`: Newton and Euler."""

from typing import final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass
from two_link_plant import TwoLinkPlant

from benchbench import Array, Coordinates, LagrangianModel, Plant
from benchbench.ocp.model import box
from benchbench.ocp.scenario import NonNegative, Positive, Range

Two = tuple[Positive, Positive]


@final
@dataclass(frozen=True)
class TwoLink(LagrangianModel):
    """q = [shoulder, elbow] (elbow relative to the upper arm), u = [torque_shoulder, torque_elbow]; moves at `height` above the floor.

    Uniform rods: length m, mass kg, damping N m s/rad of each joint; limits of angles rad, rates rad/s and torques N m.
    """

    name: str
    length: Two
    mass: Two
    damping: tuple[NonNegative, NonNegative]
    shoulder: Range
    elbow: Range
    rate: Two
    torque: Two
    height: float = 0.0

    @property
    def configuration(self) -> Coordinates:
        """Both angles."""
        (a, b), (c, d) = self.shoulder, self.elbow
        return box(("shoulder", "elbow"), ("rad", "rad"), [a, c], [b, d])

    @property
    def velocity(self) -> Coordinates:
        """Their rates."""
        return box(("shoulder", "elbow"), ("rad/s", "rad/s"), [-x for x in self.rate], self.rate)

    @property
    def inputs(self) -> Coordinates:
        """Both motors."""
        names = ("torque_shoulder", "torque_elbow")
        return box(names, ("N m", "N m"), [-x for x in self.torque], self.torque)

    def lagrangian(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Kinetic energy of two rods; there is no height to fall from."""
        energy, turning = ca.SX(0), ca.cumsum(v)
        for i, (mass, length) in enumerate(zip(self.mass, self.length, strict=True)):
            speed = ca.jtimes(self._along(q, i, 0.5), q, v)
            energy += mass * (ca.sumsqr(speed) + length**2 / 12 * turning[i] ** 2) / 2
        return energy

    def force(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """Motors, less damping."""
        return u - ca.DM(self.damping) * v

    def tool(self, q: ca.SX) -> ca.SX:
        """The hand."""
        return self._along(q, 1, 1.0)

    def nose(self, q: ca.SX) -> ca.SX:
        """Where the forearm points."""
        return ca.vertcat(ca.cos(q[0] + q[1]), ca.sin(q[0] + q[1]), 0)

    def hover(self) -> Array:
        """No torque: it rests anywhere."""
        return np.zeros(2)

    def plant(self) -> Plant:
        """Balances of forces and moments, link by link."""
        return TwoLinkPlant(self.length, self.mass, self.damping, self.height)

    def _along(self, q: ca.SX, link: int, share: float) -> ca.SX:
        """A point of a link, by the share of its length."""
        turned, place = ca.cumsum(q), ca.vertcat(0, 0, self.height)
        for i in range(link + 1):
            reach = self.length[i] * (share if i == link else 1.0)
            place += reach * ca.vertcat(ca.cos(turned[i]), ca.sin(turned[i]), 0)
        return place
