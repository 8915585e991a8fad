"""A target that stands still."""

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
class Fixed(Motion):
    """Stands at `position` (m)."""

    position_m: tuple[Finite, Finite, Finite]

    @property
    def parameters(self) -> Array:
        """The position."""
        return np.array(self.position_m)

    def position(self, time: ca.SX, parameters: ca.SX) -> ca.SX:
        """Constant."""
        return parameters
