"""A target that runs on a circle in any plane."""

from __future__ import annotations

from typing import final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.ocp.motion import Motion
from benchbench.ocp.scenario import Finite, Positive


@final
@dataclass(frozen=True)
class Circle(Motion):
    """centre_m + radius_m * (a cos(rate t + phase) + b sin(rate t + phase)).

    a is `first_axis` made unit and orthogonal to `normal`, b = normal x a, so a positive rate turns
    right-handed about `normal`. rate_radps in rad/s, phase_rad in rad.
    """

    centre_m: tuple[Finite, Finite, Finite]
    radius_m: Positive
    rate_radps: Finite
    phase_rad: Finite = 0.0
    normal: tuple[Finite, Finite, Finite] = (0.0, 0.0, 1.0)
    first_axis: tuple[Finite, Finite, Finite] = (1.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        """Raise BadInput when normal and first axis do not span a plane."""
        if np.linalg.norm(np.cross(self.normal, self.first_axis)) < 1e-9:
            raise BadInput(
                "scenario.target.normal", "is zero or parallel to first_axis", "two independent axes"
            )

    @property
    def parameters(self) -> Array:
        """Centre, radius * a, radius * b, rate, phase."""
        normal = np.array(self.normal) / np.linalg.norm(self.normal)
        a = np.array(self.first_axis) - np.dot(self.first_axis, normal) * normal
        a *= self.radius_m / np.linalg.norm(a)
        return np.array([*self.centre_m, *a, *np.cross(normal, a), self.rate_radps, self.phase_rad])

    def position(self, time: ca.SX, parameters: ca.SX) -> ca.SX:
        """Uniform circular motion."""
        angle = parameters[9] * time + parameters[10]
        return parameters[:3] + parameters[3:6] * ca.cos(angle) + parameters[6:9] * ca.sin(angle)
