"""A target that runs on a lying eight."""

from __future__ import annotations

from typing import final

import casadi as ca
import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

import benchbench as bb


@final
@dataclass(frozen=True)
class FigureEight(bb.Motion):
    """Lemniscate of Gerono: x = centre + width / 2 cos(a), y = centre + width / 2 sin(a) cos(a), a = rate t + phase."""

    centre_m: tuple[float, float, float]
    width_m: float = Field(gt=0)
    rate_radps: float = 0.3
    phase_rad: float = 0.0

    @property
    def parameters(self) -> bb.Array:
        """Centre, half of the width, rate, phase."""
        return np.array([*self.centre_m, self.width_m / 2, self.rate_radps, self.phase_rad])

    def position(self, time: ca.SX, parameters: ca.SX) -> ca.SX:
        """In the horizontal plane of its centre."""
        half, angle = parameters[3], parameters[4] * time + parameters[5]
        way = ca.vertcat(ca.cos(angle), ca.sin(angle) * ca.cos(angle), 0)
        return parameters[:3] + half * way
