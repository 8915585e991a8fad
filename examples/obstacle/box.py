"""A box in the way: the planner keeps out of a rounded body around it, the certificate out of the box itself."""

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench import Array, Condition, Model, Node, Plant, Standing, Target
from benchbench.ocp.contact import Kept
from benchbench.ocp.scenario import Positive

POWER = 10
"""max(a, b, c) is about (a^10 + b^10 + c^10)^(1/10), and never more than 3^(1/10) times less."""


@final
@dataclass(frozen=True)
class Box(Standing):
    """The middle of the vehicle stays out of a box along the axes: at most `limit` (m) deep; add the vehicle's size to `half`."""

    noun: ClassVar[str] = "depth in the box"
    aside: ClassVar[str] = "inside the box"
    unit: ClassVar[str] = "m"
    kept: ClassVar[Kept] = "always"
    centre: tuple[float, float, float]
    half: tuple[Positive, Positive, Positive]
    limit: float = Field(0.01, gt=0)

    @property
    def reach(self) -> None:
        """It says nothing of the target."""
        return None

    def condition(self, model: Model, node: Node, target: Target) -> Condition:
        """H = 1 - |(p - centre) / (3^(1/10) half)|_10: smooth, and 0 on a rounded body that holds the box, corners and all."""
        away = (node.configuration[:3] - ca.DM(self.centre)) / (3 ** (1 / POWER) * ca.DM(self.half))
        return Condition(1 - (ca.sum1(away**POWER) + 1e-12) ** (1 / POWER), "1")

    def gap(self, plant: Plant, q: Array, v: Array, target_position: Array, target_velocity: Array) -> Array:
        """Depth below the nearest face in m, 0 outside."""
        below = np.asarray(self.half) - np.abs(q[..., :3] - self.centre)
        return np.maximum(np.min(below, axis=-1), 0.0)

    def outlines(self) -> dict[str, Array]:
        """Return two faces and the edges between them."""
        x, y = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]).T
        gap = np.full((1, 3), np.nan)
        faces = [np.vstack([np.stack([x, y, 0 * x + z], axis=1), gap]) for z in (-1, 1)]
        edges = [np.vstack([[x[i], y[i], -1], [x[i], y[i], 1], gap]) for i in range(4)]
        return {"": self.centre + np.asarray(self.half) * np.concatenate([*faces, *edges])}
