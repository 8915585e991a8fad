"""A contact condition of a gripper whose jaws stand above each other."""

from __future__ import annotations

from typing import ClassVar, final

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

import benchbench as bb


@final
@dataclass(frozen=True)
class Height(bb.Contact):
    """|z_ee - z_T| <= limit (m): the target is between the jaws, however far away."""

    noun: ClassVar[str] = "height difference"
    aside: ClassVar[str] = "above or below"
    unit: ClassVar[str] = "m"
    reach: ClassVar[None] = None

    limit: float = Field(0.005, gt=0)

    def condition(self, model: bb.Model, node: bb.Node, target: bb.Target) -> bb.Condition:
        """H = (z_ee - z_T)^2 / limit^2 - 1."""
        off = model.tool(node.configuration)[2] - target.position[2]
        return bb.Condition((off / self.limit) ** 2 - 1, self.unit, (self.limit,))

    def gap(
        self, plant: bb.Plant, q: bb.Array, v: bb.Array, target_position: bb.Array, target_velocity: bb.Array
    ) -> bb.Array:
        """Height difference in m."""
        return np.abs(plant.tool(q, v)[0][..., 2] - target_position[..., 2])
