"""A pole on a cart beside a wall, as planners see it: Lagrange, and the wall as complementarity."""

from typing import final

import casadi as ca
import numpy as np
from cart_pole_plant import CartPolePlant
from pydantic.dataclasses import dataclass

from benchbench import Array, Coordinates, LagrangianModel, Plant, TouchingModel
from benchbench.ocp.model import box
from benchbench.ocp.scenario import NonNegative, Positive, Range


@final
@dataclass(frozen=True)
class CartPole(LagrangianModel, TouchingModel):
    """q = [cart, pole] (m, and rad from upright towards +x), u = [motor, wall] in N; a mass at the tip of a rod, in the x-z plane.

    cart_mass, tip_mass kg; length m; damping of the cart N s/m; gravity m/s^2; limits of the cart m, of the pole rad, of both rates and
    of the motor N. The wall stands at `wall` m, where the tip presses it in by `stiffness` N/m (soft wall, as in Aydinoglu & Posa 2022).
    """

    name: str
    cart_mass: Positive
    tip_mass: Positive
    length: Positive
    damping: NonNegative
    gravity: Positive
    cart: Range
    pole: Range
    rate: tuple[Positive, Positive]
    motor: Positive
    wall: float
    stiffness: Positive
    wall_force: Positive

    @property
    def configuration(self) -> Coordinates:
        """Cart and pole."""
        (a, b), (c, d) = self.cart, self.pole
        return box(("cart", "pole"), ("m", "rad"), [a, c], [b, d])

    @property
    def velocity(self) -> Coordinates:
        """Their rates."""
        return box(("cart", "pole"), ("m/s", "rad/s"), [-x for x in self.rate], self.rate)

    @property
    def inputs(self) -> Coordinates:
        """Force of the motor on the cart, and of the wall on the tip, which only pushes."""
        return box(("motor", "wall"), ("N", "N"), [-self.motor, 0.0], [self.motor, self.wall_force])

    @property
    def touches(self) -> tuple[str, ...]:
        """The wall."""
        return ("wall",)

    def contact(self, q: ca.SX, v: ca.SX, u: ca.SX) -> tuple[ca.SX, ca.SX]:
        """0 <= force, perpendicular to, 0 <= distance + force / stiffness; in units of the weight of the tip."""
        unit = self.tip_mass * self.gravity
        return u[1] / unit, (u[1] + self.stiffness * (self.wall - self.tool(q)[0])) / unit

    @property
    def surroundings(self) -> dict[str, Array]:
        """The wall."""
        return {"wall": np.array([[self.wall, 0.0, 0.0], [self.wall, 0.0, 1.3 * self.length]])}

    def lagrangian(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Kinetic energy of both masses, less the weight of the tip."""
        tip = ca.jtimes(self.tool(q), q, v)
        kinetic = (self.cart_mass * v[0] ** 2 + self.tip_mass * ca.sumsqr(tip)) / 2
        return kinetic - self.tip_mass * self.gravity * self.tool(q)[2]

    def force(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """The motor, damping, and the wall by virtual work."""
        return ca.vertcat(u[0] - self.damping * v[0] - u[1], -u[1] * self.length * ca.cos(q[1]))

    def tool(self, q: ca.SX) -> ca.SX:
        """The tip."""
        return ca.vertcat(q[0] + self.length * ca.sin(q[1]), 0, self.length * ca.cos(q[1]))

    def nose(self, q: ca.SX) -> ca.SX:
        """Along the way of the cart."""
        return ca.SX([1, 0, 0])

    def hover(self) -> Array:
        """Nothing: upright it rests."""
        return np.zeros(2)

    def plant(self) -> Plant:
        """Newton's laws for two bodies and a rod."""
        return CartPolePlant(self)
