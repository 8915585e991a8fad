"""The block that is moved with least effort: the textbook's first problem."""

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
class BlockMove(PublishedProblem):
    """A block of 1 kg from rest to rest, 1 m in 1 s, with the least integral of u^2; it is 12, at u = 6 - 12 t (Kelly 2017).

    M. Kelly, "An Introduction to Trajectory Optimization", SIAM Review 59(4), 2017, section 3 (doi:10.1137/16M1062569).
    With inputs held over N intervals the least is 12 N^2 / (N^2 - 1).
    """

    intervals: Annotated[int, Field(ge=2, le=1000)]

    @property
    def name(self) -> str:
        """Name of the problem."""
        return "block_move"

    @property
    def published(self) -> Published:
        """The published optimum, with inputs that are free at all times."""
        return Published(12.0, "Kelly, SIAM Review 59(4), 2017, section 3")

    def mpcc(self) -> Mpcc:
        """Return it with its inputs held."""
        return transcribed(
            Classic(
                rate=lambda x, u: ca.vertcat(x[1], u[0]), running=lambda _, u: u[0] ** 2,
                start=(0.0, 0.0), end=(1.0, 0.0), inputs=((-50.0, 50.0),), input_guess=(0.0,), time=1.0,
            ),
            self.intervals,
        )  # fmt: skip
