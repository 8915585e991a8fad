"""The pole on a cart that swings up with least effort."""

from __future__ import annotations

from math import pi
from typing import Annotated, final

import casadi as ca
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.ready import Published, PublishedProblem
from benchbench_plugins.collections.shooting import Classic, transcribed

CART, POLE, LENGTH, GRAVITY, FORCE = 1.0, 0.3, 0.5, 9.81, 20.0
"""Masses in kg, length in m, m/s^2, largest force in N (Kelly 2017, table 3)."""


@final
@dataclass(frozen=True)
class CartPole(PublishedProblem):
    """A pole on a cart swings up in 2 s, 1 m ahead, with the least integral of u^2 (Kelly 2017, section 6).

    M. Kelly, "An Introduction to Trajectory Optimization", SIAM Review 59(4), 2017 (doi:10.1137/16M1062569).
    """

    intervals: Annotated[int, Field(ge=2, le=1000)]

    @property
    def name(self) -> str:
        """Name of the problem."""
        return "cart_pole"

    @property
    def published(self) -> Published:
        """The published optimum, with inputs that are free at all times."""
        return Published(58.83924863, "OpenMDAO/dymos, test_cartpole_opt.py, to 0.1 %")

    def mpcc(self) -> Mpcc:
        """Return it with the force held."""
        return transcribed(
            Classic(
                rate=_rate, running=lambda _, u: u[0] ** 2, start=(0.0, 0.0, 0.0, 0.0), end=(1.0, pi, 0.0, 0.0),
                inputs=((-FORCE, FORCE),), input_guess=(0.0,), time=2.0,
            ),
            self.intervals,
        )  # fmt: skip


def _rate(x: ca.SX, u: ca.SX) -> ca.SX:
    """Cart and pole, hanging at 0, and their rates (Kelly's equations 6.1 and 6.2)."""
    s, c, turning = ca.sin(x[1]), ca.cos(x[1]), x[3] ** 2
    share = CART + POLE * s**2
    cart = (LENGTH * POLE * s * turning + u[0] + POLE * GRAVITY * c * s) / share
    pole = -(LENGTH * POLE * c * s * turning + u[0] * c + (CART + POLE) * GRAVITY * s) / (LENGTH * share)
    return ca.vertcat(x[2:], cart, pole)
