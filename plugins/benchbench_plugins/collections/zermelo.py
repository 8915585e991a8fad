"""Zermelo's boat in a current that grows with the distance from the shore."""

from __future__ import annotations

from math import cos, log, radians, tan
from typing import Annotated, final

import casadi as ca
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.ready import Published, PublishedProblem
from benchbench_plugins.collections.shooting import Classic, transcribed

FIRST, LAST = radians(105.0), radians(240.0)
"""Heading at the start and at the end of the published path."""
TIME = tan(LAST) - tan(FIRST)
"""Least time in h / V: along an optimal path tan(heading) changes by one in that time."""


@final
@dataclass(frozen=True)
class Zermelo(PublishedProblem):
    """Least time to the origin with speed 1 in the current u = -y, from (3.66, -1.86): T = tan 240 - tan 105 degrees = 5.464.

    A. E. Bryson, Y.-C. Ho, "Applied Optimal Control", 1975, section 2.7, example 2, with h = V = 1. The start is the closed
    form of that section for headings from 105 to 240 degrees, of which the book prints two decimals.
    """

    intervals: Annotated[int, Field(ge=2, le=1000)]

    @property
    def name(self) -> str:
        """Name of the problem."""
        return "zermelo"

    @property
    def published(self) -> Published:
        """The published optimum, with inputs that are free at all times."""
        return Published(TIME, "Bryson & Ho 1975, section 2.7")

    def mpcc(self) -> Mpcc:
        """Return it with the heading held."""
        return transcribed(
            Classic(
                rate=lambda x, u: ca.vertcat(ca.cos(u[0]) - x[1], ca.sin(u[0])), running=None,
                start=start(), end=(0.0, 0.0), inputs=((-10.0, 10.0),), input_guess=(2.0,), time=(0.1, 5.0, 50.0),
            ),
            self.intervals,
        )  # fmt: skip


def start() -> tuple[float, float]:
    """Return where the boat starts, (x, y): d heading/dt = cos(heading)^2 integrated from there to the origin."""
    (sec_0, tan_0), (sec_1, tan_1) = ((1 / cos(angle), tan(angle)) for angle in (FIRST, LAST))
    logs = log(abs(sec_1 + tan_1)) - log(abs(sec_0 + tan_0))
    x = (sec_1 * tan_1 - sec_0 * tan_0 - logs) / 2 - sec_1 * (tan_1 - tan_0)
    return x, sec_0 - sec_1
