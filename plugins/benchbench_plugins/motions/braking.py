"""A target that brakes smoothly on a straight line and stays where it stopped."""

from __future__ import annotations

from typing import final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ocp.motion import Motion
from benchbench.ocp.scenario import Finite, Positive


@final
@dataclass(frozen=True)
class Braking(Motion):
    """start_m + velocity_mps * stop_s * (s - s^3 + s^4 / 2) with s = t / stop_s, at rest from stop_s on.

    The velocity falls from velocity_mps as 1 - 3 s^2 + 2 s^3, with no jump of velocity or acceleration; the way is half of
    velocity_mps * stop_s. Before t = 0 the target moves with velocity_mps.
    """

    start_m: tuple[Finite, Finite, Finite]
    velocity_mps: tuple[Finite, Finite, Finite]
    stop_s: Positive

    @property
    def parameters(self) -> Array:
        """Start, velocity and the time at which it stands."""
        return np.array([*self.start_m, *self.velocity_mps, self.stop_s])

    def position(self, time: ca.SX, parameters: ca.SX) -> ca.SX:
        """Straight line, then a point."""
        share = ca.fmin(time / parameters[6], 1)
        braked = ca.fmax(share, 0)
        way = share - braked**3 + braked**4 / 2
        return parameters[:3] + way * parameters[6] * parameters[3:6]
