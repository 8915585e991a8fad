"""Contact condition on the distance between end effector and target (paper Eq. 23 and 29)."""

from __future__ import annotations

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ocp.contact import Condition, Contact, Target
from benchbench.ocp.model import Model, Plant
from benchbench.ocp.node import Node


@final
@dataclass(frozen=True)
class Position(Contact):
    """|p_ee - p_T| <= limit (nu_max, m), squared and scaled: the norm has no derivative at zero."""

    noun: ClassVar[str] = "distance"
    aside: ClassVar[str] = "apart"
    limit: float = Field(0.02, gt=0, allow_inf_nan=False)
    unit: ClassVar[str] = "m"

    @property
    def reach(self) -> float:
        """The limit."""
        return self.limit

    def condition(self, model: Model, node: Node, target: Target) -> Condition:
        """H = |p_ee - p_T|^2 / limit^2 - 1."""
        offset = model.tool(node.configuration) - target.position
        return Condition(ca.sumsqr(offset) / self.limit**2 - 1, self.unit, (self.limit,))

    def gap(self, plant: Plant, q: Array, v: Array, target_position: Array, target_velocity: Array) -> Array:
        """Distance in m."""
        return np.asarray(np.linalg.norm(plant.tool(q, v)[0] - target_position, axis=-1))
