"""Contact condition on the relative speed of end effector and target (paper Eq. 27)."""

from __future__ import annotations

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ocp.contact import Condition, Contact, Target, tool_velocity
from benchbench.ocp.model import Model, Plant
from benchbench.ocp.node import Node


@final
@dataclass(frozen=True)
class Velocity(Contact):
    """|v_ee - v_T| <= limit (c_limit,velocity, m/s), squared and scaled."""

    noun: ClassVar[str] = "relative speed"
    aside: ClassVar[str] = "relative"
    limit: float = Field(0.01, gt=0, allow_inf_nan=False)
    unit: ClassVar[str] = "m/s"

    @property
    def reach(self) -> None:
        """Any."""
        return None

    def condition(self, model: Model, node: Node, target: Target) -> Condition:
        """H = |v_ee - v_T|^2 / limit^2 - 1 with v_ee from the nodal velocity."""
        speed = tool_velocity(model, node) - target.velocity
        return Condition(ca.sumsqr(speed) / self.limit**2 - 1, self.unit, (self.limit,))

    def gap(self, plant: Plant, q: Array, v: Array, target_position: Array, target_velocity: Array) -> Array:
        """Relative speed in m/s."""
        return np.asarray(np.linalg.norm(plant.tool(q, v)[1] - target_velocity, axis=-1))
