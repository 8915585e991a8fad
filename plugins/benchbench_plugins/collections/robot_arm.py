"""A robot arm that lengthens, turns and tilts, in least time."""

from __future__ import annotations

from math import pi
from typing import Annotated, final

import casadi as ca
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.ready import Published, PublishedProblem
from benchbench_plugins.collections.shooting import Classic, transcribed

LENGTH = 5.0
"""Of the arm; what is not on one side of the pivot is on the other."""


@final
@dataclass(frozen=True)
class RobotArm(PublishedProblem):
    """Least time to turn by 120 degrees with an arm that may draw itself in: 9.14093 at 800 intervals (COPS 3.0, problem 8).

    E. D. Dolan, J. J. More, T. S. Munson, "Benchmarking Optimization Software with COPS 3.0", ANL/MCS-TM-273, 2004. All three motors
    switch between their limits.
    """

    intervals: Annotated[int, Field(ge=2, le=1000)]

    @property
    def name(self) -> str:
        """Name of the problem."""
        return "robot_arm"

    @property
    def published(self) -> Published:
        """The published optimum, with inputs that are free at all times."""
        return Published(9.14093, "COPS 3.0, problem 8")

    def mpcc(self) -> Mpcc:
        """Return it with the motors held."""
        return transcribed(
            Classic(
                rate=_rate, running=None, start=(4.5, 0.0, pi / 4, 0.0, 0.0, 0.0), end=(4.5, 2 * pi / 3, pi / 4, 0.0, 0.0, 0.0),
                inputs=((-1.0, 1.0),) * 3, input_guess=(0.0,) * 3, time=(0.1, 10.0, 100.0),
            ),
            self.intervals,
        )  # fmt: skip


def _rate(x: ca.SX, u: ca.SX) -> ca.SX:
    """Reach, turn, tilt, and their rates."""
    reach, tilt = x[0], x[2]
    inertia = ((LENGTH - reach) ** 3 + reach**3) / 3
    return ca.vertcat(x[3:], u[0] / LENGTH, u[1] / (inertia * ca.sin(tilt) ** 2), u[2] / inertia)
