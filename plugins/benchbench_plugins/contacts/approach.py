"""Path condition: slow wherever the ball is near, so that a permanent magnet, which nobody switches on, takes it gently."""

from __future__ import annotations

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ocp.contact import Condition, Contact, Kept, Target, tool_velocity
from benchbench.ocp.model import Model, Plant
from benchbench.ocp.node import Node


@final
@dataclass(frozen=True)
class Approach(Contact):
    """|v_ee - v_T| <= sqrt(limit^2 + (slope d)^2) until the contact is over, d >= 0 the clearance to the ball's surface.

    The target is the uppermost point of a ball of `radius` (m); `slope` in 1/s. Not in the paper. Written as
    |v_ee - v_T| / sqrt(1 + (slope d / limit)^2) <= limit, which says the same and stays of order one far away.
    """

    noun: ClassVar[str] = "speed of approach"
    aside: ClassVar[str] = "of approach"
    limit: float = Field(0.05, gt=0, allow_inf_nan=False)
    slope: float = Field(4.0, gt=0, allow_inf_nan=False)
    radius: float = Field(0.03, gt=0, allow_inf_nan=False)
    unit: ClassVar[str] = "m/s"
    kept: ClassVar[Kept] = "until contact"

    @property
    def reach(self) -> None:
        """Any: fast where it is far."""
        return None

    def condition(self, model: Model, node: Node, target: Target) -> Condition:
        """H = |v|^2 / (limit^2 + (slope d)^2) - 1, d = max(|p_ee - p_ball| - radius, 0)."""
        way = tool_velocity(model, node)
        offset = model.tool(node.configuration) - target.position + ca.DM([0, 0, self.radius])
        # within the ball d is 0: the root is kept away from the centre, where it has no derivative
        apart = ca.sqrt(ca.fmax(ca.sumsqr(offset), (self.radius / 2) ** 2))
        slow = self.limit**2 + (self.slope * ca.fmax(apart - self.radius, 0)) ** 2
        return Condition(ca.sumsqr(way - target.velocity) / slow - 1, self.unit, (self.limit,))

    def gap(self, plant: Plant, q: Array, v: Array, target_position: Array, target_velocity: Array) -> Array:
        """Relative speed in m/s, the less the farther the ball is."""
        tip, way = plant.tool(q, v)
        centre = target_position - np.array([0.0, 0.0, self.radius])
        clearance = np.maximum(np.linalg.norm(tip - centre, axis=-1) - self.radius, 0.0)
        speed = np.linalg.norm(way - target_velocity, axis=-1)
        return np.asarray(speed / np.hypot(1.0, self.slope * clearance / self.limit))
