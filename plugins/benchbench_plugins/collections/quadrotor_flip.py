"""A planar quadrotor that climbs and flips over on the way, in least time."""

from __future__ import annotations

from math import pi
from typing import Annotated, final

import casadi as ca
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.ready import ReadyMade
from benchbench_plugins.collections.shooting import Classic, transcribed

GRAVITY, THRUST, RATE, CLIMB = 9.81, (1.0, 20.0), 10.0, 2.7
"""m/s^2; least and largest thrust per mass in m/s^2; largest rate of turn in rad/s; way up in m."""


@final
@dataclass(frozen=True)
class QuadrotorFlip(ReadyMade):
    """Least time from hover to hover, 2.7 m higher and once turned over, by thrust and rate of turn; no published optimum was found.

    The model is that of M. Hehn, R. Ritz, R. D'Andrea, "Performance benchmarking of quadrotor systems using time-optimal control",
    Autonomous Robots 33, 2012 (doi:10.1007/s10514-012-9282-3), whose optimal thrust switches between its limits and whose rate is at its limit or
    singular; task and limits are those of JAParedes/Trajectory_Optimization_for_Multicopter_UAV_Lateral_Flight, which prints no time.
    """

    intervals: Annotated[int, Field(ge=2, le=1000)]

    @property
    def name(self) -> str:
        """Name of the problem."""
        return "quadrotor_flip"

    def mpcc(self) -> Mpcc:
        """Return it with thrust and rate held."""
        return transcribed(
            Classic(
                rate=_rate, running=None, start=(0.0,) * 5, end=(0.0, CLIMB, 0.0, 0.0, 2 * pi), inputs=(THRUST, (-RATE, RATE)),
                input_guess=(GRAVITY, 0.0), time=(2 * pi / RATE, 2.0, 20.0),
            ),
            self.intervals,
        )  # fmt: skip


def _rate(x: ca.SX, u: ca.SX) -> ca.SX:
    """Way along and up, their speeds, and pitch."""
    return ca.vertcat(x[2:4], u[0] * ca.sin(x[4]), u[0] * ca.cos(x[4]) - GRAVITY, u[1])
