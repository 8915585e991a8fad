"""The hopper once more, in numbers: Newton's law for each mass; the ground is a spring."""

from __future__ import annotations

from typing import TYPE_CHECKING, final

import numpy as np

from benchbench import Array, Plant

if TYPE_CHECKING:
    from hopper import Hopper


@final
class HopperPlant(Plant):
    """It finds the ground's force from the foot's height, whatever the plan says it is."""

    def __init__(self, numbers: Hopper) -> None:
        """Take the numbers of the machine, not its equations."""
        self._of = numbers

    def acceleration(self, q: Array, v: Array, u: Array) -> Array:
        """Return the foot's acceleration, and the body's less the foot's."""
        of, along = self._of, u[..., 0] - self._of.damping * v[..., 1]
        foot = (self.ground_force(q) - along) / of.foot_mass - of.gravity
        body = along / of.body_mass - of.gravity
        return np.stack([foot, body - foot], axis=-1)

    def ground_force(self, q: Array) -> Array:
        """Return what the ground pushes the foot up with, (...,) N: a spring where the foot is below it."""
        return np.asarray(self._of.stiffness * np.maximum(self._of.sunk - q[..., 0], 0.0))

    def tool(self, q: Array, v: Array) -> tuple[Array, Array]:
        """The body and its velocity."""
        still = np.zeros(q.shape[:-1])
        return tuple(np.stack([still, still, np.sum(x, axis=-1)], axis=-1) for x in (q, v))  # type: ignore[return-value]

    def nose(self, q: Array) -> Array:
        """It does not turn."""
        return np.broadcast_to([1.0, 0.0, 0.0], (*q.shape[:-1], 3))

    def skeleton(self, q: Array) -> dict[str, Array]:
        """Body, foot, and the leg as its arm."""
        wide, up = np.array([0.08, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
        foot, body = q[0] * up, (q[0] + q[1]) * up
        lines = {
            "body": [body - wide, body + wide],
            "foot": [foot - wide / 2, foot + wide / 2],
            "leg_arm": [foot, body],
        }
        return {name: np.stack(points) for name, points in lines.items()}
