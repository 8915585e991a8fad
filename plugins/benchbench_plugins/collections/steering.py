"""A particle whose thrust is steered, by the law of the linear tangent."""

from __future__ import annotations

from math import pi
from typing import Annotated, final

import casadi as ca
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.ready import Published, PublishedProblem
from benchbench_plugins.collections.shooting import Classic, transcribed

THRUST = 100.0
"""Acceleration, always the same."""


@final
@dataclass(frozen=True)
class Steering(PublishedProblem):
    """Least time to height 5 and speed (45, 0) from rest, thrust 100 at any angle: 0.554571 (COPS 3.0, problem 9; Bryson & Ho 1975).

    E. D. Dolan, J. J. More, T. S. Munson, "Benchmarking Optimization Software with COPS 3.0", ANL/MCS-TM-273, 2004.
    """

    intervals: Annotated[int, Field(ge=2, le=1000)]

    @property
    def name(self) -> str:
        """Name of the problem."""
        return "steering"

    @property
    def published(self) -> Published:
        """The published optimum, with inputs that are free at all times."""
        return Published(0.554571, "COPS 3.0, problem 9")

    def mpcc(self) -> Mpcc:
        """Return it with the angle held."""
        return transcribed(
            Classic(
                rate=lambda x, u: ca.vertcat(x[2], x[3], THRUST * ca.cos(u[0]), THRUST * ca.sin(u[0])), running=None,
                start=(0.0, 0.0, 0.0, 0.0), end=(float("nan"), 5.0, 45.0, 0.0), inputs=((-pi / 2, pi / 2),), input_guess=(0.1,),
                time=(0.01, 1.0, 10.0),
            ),
            self.intervals,
        )  # fmt: skip
