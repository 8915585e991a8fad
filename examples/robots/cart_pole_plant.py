"""The pole on a cart once more, in numbers: Newton's law for each mass, with the force in the rod as an unknown; the wall is a spring."""

from __future__ import annotations

from typing import TYPE_CHECKING, final

import numpy as np

from benchbench import Array, Plant

if TYPE_CHECKING:
    from cart_pole import CartPole


@final
class CartPolePlant(Plant):
    """It finds the wall's force from the tip's place, whatever the plan says it is."""

    def __init__(self, numbers: CartPole) -> None:
        """Take the numbers of the machine, not its equations."""
        self._of = numbers

    def acceleration(self, q: Array, v: Array, u: Array) -> Array:
        """Three balances, cart along x, tip along x and z, for three unknowns: both accelerations and the force in the rod."""
        of, s, c = self._of, np.sin(q[..., 1]), np.cos(q[..., 1])
        wall, spin = self.wall_force(q), of.length * v[..., 1] ** 2
        m, nothing = of.tip_mass, np.zeros_like(s)
        rows = [
            [of.cart_mass + nothing, nothing, -s],
            [m + nothing, m * of.length * c, s],
            [nothing, -m * of.length * s, c],
        ]
        right = [u[..., 0] - of.damping * v[..., 0], m * spin * s - wall, m * spin * c - m * of.gravity]
        matrix = np.moveaxis(np.array(np.broadcast_arrays(*(x for row in rows for x in row))), 0, -1)
        given = np.stack(np.broadcast_arrays(*right), axis=-1)[..., None]
        return np.asarray(np.linalg.solve(matrix.reshape(*s.shape, 3, 3), given)[..., :2, 0])

    def wall_force(self, q: Array) -> Array:
        """Return what the wall pushes the tip back with, (...,) N: a spring where the tip is beyond it."""
        beyond = q[..., 0] + self._of.length * np.sin(q[..., 1]) - self._of.wall
        return np.asarray(self._of.stiffness * np.maximum(beyond, 0.0))

    def tool(self, q: Array, v: Array) -> tuple[Array, Array]:
        """The tip and its velocity."""
        s, c, length = np.sin(q[..., 1]), np.cos(q[..., 1]), self._of.length
        place = np.stack([q[..., 0] + length * s, 0 * s, length * c], axis=-1)
        moving = [v[..., 0] + length * c * v[..., 1], 0 * s, -length * s * v[..., 1]]
        return place, np.stack(moving, axis=-1)

    def nose(self, q: Array) -> Array:
        """Along the way of the cart."""
        return np.broadcast_to([1.0, 0.0, 0.0], (*q.shape[:-1], 3))

    def skeleton(self, q: Array) -> dict[str, Array]:
        """Cart, and the pole as its arm."""
        tip, _ = self.tool(q, np.zeros(2))
        side, low = np.array([0.1, 0.0, 0.0]), np.array([q[0], 0.0, 0.0])
        return {"cart": np.stack([low - side, low + side]), "pole_arm": np.stack([low, tip])}
