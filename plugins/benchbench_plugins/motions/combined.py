"""A target whose motion is the sum of others, for example a circle on a moving platform."""

from __future__ import annotations

from typing import final

import casadi as ca
import numpy as np
from pydantic import InstanceOf
from pydantic.dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ocp.motion import Motion, sample


@final
@dataclass(frozen=True)
class Combined(Motion):
    """Sum of the positions of all `parts`."""

    parts: tuple[InstanceOf[Motion], ...]

    @property
    def parameters(self) -> Array:
        """Those of the parts, one after the other."""
        return np.concatenate([np.zeros(0), *(part.parameters for part in self.parts)])

    def position(self, time: ca.SX, parameters: ca.SX) -> ca.SX:
        """Sum."""
        total, first = ca.SX.zeros(3), 0
        for part in self.parts:
            count = len(part.parameters)
            total += part.position(time, parameters[first : first + count])
            first += count
        return total


@sample.register
def _(motion: Combined, times: Array) -> tuple[Array, Array]:
    """Sum of what the parts say of themselves."""
    none = np.zeros((len(times), 3))
    position, velocity = none, none
    for part in motion.parts:
        place, rate = sample(part, times)
        position, velocity = position + place, velocity + rate
    return position, velocity
