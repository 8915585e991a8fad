"""A ball in the way: a path condition as a plugin, said once for planners and once for the certificate."""

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ocp.contact import Condition, Kept, Standing, Target
from benchbench.ocp.model import Model, Plant
from benchbench.ocp.node import Node

Triple = tuple[float, float, float]


@final
@dataclass(frozen=True)
class Sphere(Standing):
    """The middle of the vehicle stays out of a ball: at most `limit` (m) beyond its surface; add the vehicle's size to `radius`."""

    noun: ClassVar[str] = "depth in the sphere"
    aside: ClassVar[str] = "inside the sphere"
    unit: ClassVar[str] = "m"
    kept: ClassVar[Kept] = "always"
    centre: Triple
    radius: float = Field(gt=0)
    limit: float = Field(0.01, gt=0)

    @property
    def reach(self) -> None:
        """It says nothing of the target."""
        return None

    def condition(self, model: Model, node: Node, target: Target) -> Condition:
        """H = 1 - |p - centre|^2 / radius^2, always."""
        away = node.configuration[:3] - ca.DM(self.centre)
        return Condition(1 - ca.sumsqr(away) / self.radius**2, self.unit)

    def gap(self, plant: Plant, q: Array, v: Array, target_position: Array, target_velocity: Array) -> Array:
        """Depth of the vehicle's middle in m, 0 outside."""
        return np.maximum(self.radius - np.linalg.norm(q[..., :3] - self.centre, axis=-1), 0.0)

    def outlines(self) -> dict[str, Array]:
        """Return three great circles."""
        angle = np.linspace(0.0, 2 * np.pi, 49)
        circle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
        gaps = [np.vstack([np.roll(circle, turn, axis=1), np.full(3, np.nan)]) for turn in range(3)]
        return {"": np.array(self.centre) + self.radius * np.concatenate(gaps)}
