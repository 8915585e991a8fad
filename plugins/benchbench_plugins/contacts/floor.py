"""Path condition: the end effector never dips below the target (authors' public demo code)."""

from __future__ import annotations

from typing import ClassVar, final

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ocp.contact import Condition, Contact, Kept, Target
from benchbench.ocp.model import Model, Plant
from benchbench.ocp.node import Node


@final
@dataclass(frozen=True)
class Floor(Contact):
    """z_T - z_ee <= limit (m) at every node; not in the paper, off by default."""

    noun: ClassVar[str] = "depth below the floor"
    aside: ClassVar[str] = "below the floor"
    limit: float = Field(0.01, gt=0, allow_inf_nan=False)
    unit: ClassVar[str] = "m"
    kept: ClassVar[Kept] = "always"

    @property
    def reach(self) -> None:
        """Any: it may be far above."""
        return None

    def condition(self, model: Model, node: Node, target: Target) -> Condition:
        """H = (z_T - z_ee) / limit - 1, always."""
        below = target.position[2] - model.tool(node.configuration)[2]
        return Condition(below / self.limit - 1, self.unit)

    def gap(self, plant: Plant, q: Array, v: Array, target_position: Array, target_velocity: Array) -> Array:
        """Depth of the end effector below the target in m, 0 when above."""
        return np.maximum(target_position[..., 2] - plant.tool(q, v)[0][..., 2], 0.0)
