"""Goddard's rocket, which climbs as high as its fuel takes it."""

from __future__ import annotations

from typing import Annotated, final

import casadi as ca
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.ready import Published, PublishedProblem
from benchbench_plugins.collections.shooting import Classic, transcribed

DRAG, DECAY, EXHAUST, THRUST = 310.0, 500.0, 0.5, 3.5
"""Drag at the ground, how fast it falls with height, speed of the exhaust, largest thrust; all without unit."""


@final
@dataclass(frozen=True)
class Goddard(PublishedProblem):
    """Greatest height h of a rocket that burns 0.4 of its mass: 1.01283, of which the radius of the earth is 1 (COPS 3.0, problem 10).

    E. D. Dolan, J. J. More, T. S. Munson, "Benchmarking Optimization Software with COPS 3.0", ANL/MCS-TM-273, 2004. Thrust is singular
    on the way. The cost is -h.
    """

    intervals: Annotated[int, Field(ge=2, le=1000)]

    @property
    def name(self) -> str:
        """Name of the problem."""
        return "goddard"

    @property
    def published(self) -> Published:
        """The published optimum, with inputs that are free at all times."""
        return Published(-1.01283, "COPS 3.0, problem 10")

    def mpcc(self) -> Mpcc:
        """Return it with the thrust held."""
        return transcribed(
            Classic(
                rate=_rate, running=None, start=(1.0, 0.0, 1.0), end=(float("nan"), float("nan"), 0.6), inputs=((0.0, THRUST),),
                input_guess=(THRUST / 2,), time=(0.01, 0.2, 1.0), final=lambda x: -x[0],
            ),
            self.intervals,
        )  # fmt: skip


def _rate(x: ca.SX, u: ca.SX) -> ca.SX:
    """Height, speed and mass."""
    height, speed, mass = x[0], x[1], x[2]
    drag = DRAG * speed**2 * ca.exp(-DECAY * (height - 1))
    return ca.vertcat(speed, (u[0] - drag) / mass - 1 / height**2, -u[0] / EXHAUST)
