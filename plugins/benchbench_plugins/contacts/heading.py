"""Contact condition on the heading relative to the target's direction of motion (paper Eq. 28)."""

from __future__ import annotations

from typing import ClassVar, Literal, final

import casadi as ca
import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ocp.contact import SLOW, Condition, NoseContact, Target
from benchbench.ocp.model import Model, Plant
from benchbench.ocp.node import Node

SMALL = 1e-3
"""Limit in rad below which one minus its cosine has lost digits."""
STILL = 1e-9
"""Ground speed in m/s at which the planner's cosine goes over to that of a target that stands: so far below `SLOW` that its
limit is the certified one, to rounding, wherever that asks anything.
"""


@final
@dataclass(frozen=True)
class Heading(NoseContact):
    """Angle between the vehicle's nose and the target's ground velocity, at most `limit` rad.

    form "angle": e <= limit, written with cos e, so flying backwards (e = pi) is far outside; a target
    that stands still has no direction and the condition holds by definition.
    form "cross": the paper's |v_T^xy x x_B^xy| <= limit as printed. It has units of m/s, vanishes for a
    static target and accepts flying backwards; `gap` still measures the true angle.
    """

    noun: ClassVar[str] = "heading error"
    aside: ClassVar[str] = "off heading"
    limit: float = Field(0.1, gt=0, lt=np.pi / 2)
    unit: ClassVar[str] = "rad"
    form: Literal["angle", "cross"] = "angle"

    @property
    def reach(self) -> None:
        """Any."""
        return None

    @property
    def heading_error(self) -> float:
        """The limit, in either form: the certificate measures the angle."""
        return self.limit

    def condition(self, model: Model, node: Node, target: Target) -> Condition:
        """H = (1 - cos e) / (1 - cos limit) - 1, or h = cross^2 / limit^2 - 1."""
        nose, way = model.nose(node.configuration)[:2], target.velocity[:2]
        if self.form == "cross":
            cross = way[0] * nose[1] - way[1] * nose[0]
            return Condition(cross**2 / self.limit**2 - 1, "m/s", (self.limit,))
        squared = ca.sumsqr(way) * ca.sumsqr(nose) + STILL**2
        still = STILL**2 / squared  # 1 when the target stands still, and then the cosine is, too
        cosine = (
            ca.dot(way, nose) / ca.sqrt(squared) * (1 + still / 2) + still**2
        )  # else right but for still^2
        width = 1 - np.cos(self.limit) if self.limit > SMALL else 2 * np.sin(self.limit / 2) ** 2
        return Condition((1 - cosine) / width - 1, self.unit, (self.limit,))

    def gap(self, plant: Plant, q: Array, v: Array, target_position: Array, target_velocity: Array) -> Array:
        """Heading error in rad in [0, pi]; 0 where the target stands still."""
        nose, way = plant.nose(q)[..., :2], target_velocity[..., :2]
        cross = way[..., 0] * nose[..., 1] - way[..., 1] * nose[..., 0]
        error = np.abs(np.arctan2(cross, np.sum(way * nose, axis=-1)))
        return np.where(np.linalg.norm(way, axis=-1) > SLOW, error, 0.0)
