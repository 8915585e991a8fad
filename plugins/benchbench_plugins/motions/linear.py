"""A target that moves with constant velocity in any direction."""

from __future__ import annotations

from typing import final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ocp.motion import Motion
from benchbench.ocp.scenario import Finite


@final
@dataclass(frozen=True)
class Linear(Motion):
    """start_m + velocity_mps * t."""

    start_m: tuple[Finite, Finite, Finite]
    velocity_mps: tuple[Finite, Finite, Finite]

    @property
    def parameters(self) -> Array:
        """Start and velocity."""
        return np.array([*self.start_m, *self.velocity_mps])

    def position(self, time: ca.SX, parameters: ca.SX) -> ca.SX:
        """Straight line."""
        return parameters[:3] + time * parameters[3:]
