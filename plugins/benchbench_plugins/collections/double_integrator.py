"""The double integrator in least time, whose answer is bang-bang."""

from __future__ import annotations

from typing import Annotated, final

import casadi as ca
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.ready import Published, PublishedProblem
from benchbench_plugins.collections.shooting import Classic, transcribed


@final
@dataclass(frozen=True)
class DoubleIntegrator(PublishedProblem):
    """From rest to rest over `distance` (m) in least time with |u| <= 1 m/s^2: T = 2 sqrt(distance) (Bryson & Ho 1975).

    A. E. Bryson, Y.-C. Ho, "Applied Optimal Control", section 3.9. With an even number of intervals the switch in the
    middle lies on a node, and the answer is exact.
    """

    distance: Annotated[float, Field(gt=0, le=1000)]
    intervals: Annotated[int, Field(ge=2, le=1000)]

    @property
    def name(self) -> str:
        """Name of the problem."""
        return "double_integrator"

    @property
    def published(self) -> Published:
        """The published optimum, with inputs that are free at all times."""
        return Published(2 * self.distance**0.5, "Bryson & Ho 1975, section 3.9")

    def mpcc(self) -> Mpcc:
        """Return it with its inputs held."""
        slow = 3.0 * self.distance**0.5
        return transcribed(
            Classic(
                rate=lambda x, u: ca.vertcat(x[1], u[0]), running=None,
                start=(0.0, 0.0), end=(self.distance, 0.0), inputs=((-1.0, 1.0),), input_guess=(0.0,),
                time=(0.01 * slow, slow, 10.0 * slow),
            ),
            self.intervals,
        )  # fmt: skip
