"""A car that drives around a disc: tangent, arc, tangent."""

from __future__ import annotations

from math import acos, atan2, hypot, pi, sqrt
from typing import Annotated, final

import casadi as ca
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.ready import Published, PublishedProblem
from benchbench_plugins.collections.shooting import Classic, transcribed

WAY, ASIDE, TURN = 2.0, 0.5, 2.0
"""The car goes from (-WAY, 0) to (WAY, 0); the middle of the disc, of radius 1, is at (0, -ASIDE); largest rate of turn."""
FAR = hypot(WAY, ASIDE)
LEAST = 2 * sqrt(FAR**2 - 1) + pi - 2 * atan2(ASIDE, WAY) - 2 * acos(1 / FAR)
"""Two tangents and the arc between them, over the disc."""


@final
@dataclass(frozen=True)
class ObstacleCar(PublishedProblem):
    """Least time around a disc of radius 1 with speed 1 and a turning radius of 1/2, headings free: 4.12848, in closed form (Dubins 1957).

    L. E. Dubins, "On curves of minimal length with a constraint on average curvature", American Journal of Mathematics 79(3), 1957
    (doi:10.2307/2372560): straight lines and arcs; the arc is the disc's own, which is wider than the car's. The disc is kept at nodes.
    """

    intervals: Annotated[int, Field(ge=2, le=1000)]

    @property
    def name(self) -> str:
        """Name of the problem."""
        return "obstacle_car"

    @property
    def published(self) -> Published:
        """The published optimum, with inputs that are free at all times."""
        return Published(LEAST, "Dubins 1957, in closed form")

    def mpcc(self) -> Mpcc:
        """Return it with the steering held."""
        free = float("nan")
        return transcribed(
            Classic(
                rate=lambda x, u: ca.vertcat(ca.cos(x[2]), ca.sin(x[2]), u[0]), running=None, start=(-WAY, 0.0, free),
                end=(WAY, 0.0, free), inputs=((-TURN, TURN),), input_guess=(0.0,), time=(1.0, 2 * WAY, 50.0),
                path=lambda x: x[0] ** 2 + (x[1] + ASIDE) ** 2 - 1,
            ),
            self.intervals,
        )  # fmt: skip
