"""A zone that nobody flies over: a disc on the map, forbidden at every height."""

from typing import ClassVar, final

import casadi as ca
import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from benchbench import Array, Condition, Model, Node, Plant, Standing, Target
from benchbench.ocp.contact import Kept
from benchbench.ocp.scenario import Range


@final
@dataclass(frozen=True)
class NoFlyZone(Standing):
    """The middle of the vehicle stays out of a disc, at most `limit` (m) within; drawn between two `heights` (m)."""

    noun: ClassVar[str] = "way into the no-fly zone"
    aside: ClassVar[str] = "inside the no-fly zone"
    unit: ClassVar[str] = "m"
    kept: ClassVar[Kept] = "always"
    centre: tuple[float, float]
    radius: float = Field(gt=0)
    heights: Range = (0.0, 2.0)
    limit: float = Field(0.01, gt=0)

    @property
    def reach(self) -> None:
        """It says nothing of the target."""
        return None

    def condition(self, model: Model, node: Node, target: Target) -> Condition:
        """H = 1 - |p_xy - centre|^2 / radius^2, always."""
        away = node.configuration[:2] - ca.DM(self.centre)
        return Condition(1 - ca.sumsqr(away) / self.radius**2, self.unit)

    def gap(self, plant: Plant, q: Array, v: Array, target_position: Array, target_velocity: Array) -> Array:
        """Distance to the rim in m, 0 outside."""
        return np.maximum(self.radius - np.hypot(*np.moveaxis(q[..., :2] - self.centre, -1, 0)), 0.0)

    def outlines(self) -> dict[str, Array]:
        """Return the rim at both heights, and lines between them."""
        angle, gap = np.linspace(0.0, 2 * np.pi, 49), np.full((1, 3), np.nan)
        x, y = self.centre[0] + self.radius * np.cos(angle), self.centre[1] + self.radius * np.sin(angle)
        rims = [np.vstack([np.stack([x, y, 0 * x + z], axis=1), gap]) for z in self.heights]
        posts = [np.vstack([[x[i], y[i], z] for z in self.heights] + [gap]) for i in range(0, 48, 12)]
        return {"": np.concatenate([*rims, *posts])}
