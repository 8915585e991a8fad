"""A cost of your own: height costs, as where lifting takes energy or somebody looks up."""

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench import Array, Cost, Model, Plant
from benchbench.ocp.scenario import Positive


@final
@dataclass(frozen=True)
class Height(Cost):
    """A second at height z costs `weight` z^2 seconds; z in m from the floor, of the end effector; `weight` in 1/m^2."""

    noun: ClassVar[str] = "height"
    weight: Positive

    def rate(self, model: Model, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """Return weight z^2 in symbols."""
        return self.weight * model.tool(q)[2] ** 2

    def spent(self, plant: Plant, q: Array, v: Array, u: Array) -> Array:
        """Return it in numbers, (n,)."""
        return np.asarray(self.weight * plant.tool(q, v)[0][..., 2] ** 2)
