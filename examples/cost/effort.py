"""A cost of your own: control effort, the square of what motors and servo give."""

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench import Array, Cost, Model, Plant
from benchbench.ocp.scenario import Positive


@final
@dataclass(frozen=True)
class Effort(Cost):
    """A second costs `weight` |u|^2 seconds, u in N and N m."""

    noun: ClassVar[str] = "control effort"
    weight: Positive

    def rate(self, model: Model, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """Return weight |u|^2 in symbols."""
        return self.weight * ca.sumsqr(u)

    def spent(self, plant: Plant, q: Array, v: Array, u: Array) -> Array:
        """Return it in numbers, (n,)."""
        return np.asarray(self.weight * np.sum(u**2, axis=-1))
