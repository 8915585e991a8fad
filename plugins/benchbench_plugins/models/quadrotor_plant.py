"""The racing quadrotor in numbers, written apart from the symbols: rotor by rotor, with rotation matrices."""

from __future__ import annotations

from typing import final

import numpy as np

from benchbench.model import Plant
from benchbench.plan import Array

SIDES = np.array([[1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]])
"""Signs of the rotors' y and -x coordinates; thrust at y turns about x, thrust at -x about y."""
SPIN = np.array([1.0, -1.0, 1.0, -1.0])
"""Sign of each rotor's reaction torque about the body z axis."""


@final
class QuadrotorPlant(Plant):
    """Newton and Euler for a rigid body with four rotors; q = [p, quaternion], v = [world velocity, body rates]."""

    def __init__(
        self,
        mass: float,
        inertia: tuple[float, float, float],
        lever: float,
        torque_coefficient: float,
        gravity: float,
    ) -> None:
        """SI units, see `Quadrotor`."""
        self._mass, self._gravity = mass, gravity
        self._inertia = np.diag(inertia)
        self._rotors = np.column_stack([-lever * SIDES[:, 1], lever * SIDES[:, 0], np.zeros(4)])
        lift = np.cross(self._rotors, [0.0, 0.0, 1.0])
        self._torques = lift + torque_coefficient * SPIN[:, None] * np.array([0.0, 0.0, 1.0])

    def acceleration(self, q: Array, v: Array, u: Array) -> Array:
        """Return world accelerations and body angular accelerations (..., 6)."""
        omega = v[..., 3:]
        out = np.empty((*np.broadcast_shapes(q.shape[:-1], v.shape[:-1], u.shape[:-1]), 6))
        out[..., :3] = rotation(q)[..., 2] * np.sum(u, axis=-1)[..., None] / self._mass
        out[..., 2] -= self._gravity
        momentum = omega @ self._inertia
        out[..., 3:] = (u @ self._torques - np.cross(omega, momentum)) @ np.linalg.inv(self._inertia)
        return out

    def kinematics(self, q: Array, v: Array) -> Array:
        """World velocity, and half the quaternion times the body rates, (..., 7)."""
        w, x, y, z = (q[..., 3 + i] for i in range(4))
        a, b, c = (v[..., 3 + i] / 2 for i in range(3))
        turn = [-x * a - y * b - z * c, w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a]
        return np.concatenate([v[..., :3], np.stack(turn, axis=-1)], axis=-1)

    def tool(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Centre of mass and its velocity."""
        return q[..., :3], v[..., :3]

    def nose(self, q: Array) -> Array:
        """Body x axis (..., 3)."""
        return rotation(q)[..., 0]

    def skeleton(self, q: Array) -> dict[str, Array]:
        """Return the lines between opposite rotors."""
        lines = {"frame_a": self._rotors[[0, 2]], "frame_b": self._rotors[[1, 3]]}
        return {name: q[:3] + line @ rotation(q).T for name, line in lines.items()}


def rotation(q: Array) -> Array:
    """Body to world (..., 3, 3), from the normalised quaternion q[..., 3:]."""
    w, x, y, z = np.moveaxis(q[..., 3:] / np.linalg.norm(q[..., 3:], axis=-1, keepdims=True), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
