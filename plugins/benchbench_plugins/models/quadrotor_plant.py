"""The racing quadrotor in numbers, written apart from the symbols: rotor by rotor, with rotation matrices."""

from __future__ import annotations

from typing import final

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ocp.model import Plant
from benchbench_plugins.models.attitude_plant import AttitudePlant, Quaternions

SIDES = np.array([[1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]])
"""Signs of the rotors' y and -x coordinates; thrust at y turns about x, thrust at -x about y."""
SPIN = np.array([1.0, -1.0, 1.0, -1.0])
"""Sign of each rotor's reaction torque about the body z axis."""

NEXT, AFTER = [1, 2, 0], [2, 0, 1]
QUATERNIONS = Quaternions()


@final
class QuadrotorPlant(Plant):
    """Newton and Euler for a rigid body with four rotors; q = [p, attitude], v = [world velocity, attitude rates].

    The outputs of a vehicle in Euler angles are its body rates.
    """

    def __init__(
        self,
        mass: float,
        inertia: tuple[float, float, float],
        lever: float,
        torque_coefficient: float,
        gravity: float,
        attitude: AttitudePlant = QUATERNIONS,
    ) -> None:
        """SI units, see `Quadrotor`."""
        self._attitude = attitude
        self._mass, self._gravity = mass, gravity
        self._inertia = np.diag(inertia)
        self._inverse = np.linalg.inv(self._inertia)
        self._rotors = np.column_stack([-lever * SIDES[:, 1], lever * SIDES[:, 0], np.zeros(4)])
        lift = np.cross(self._rotors, [0.0, 0.0, 1.0])
        self._torques = lift + torque_coefficient * SPIN[:, None] * np.array([0.0, 0.0, 1.0])

    def acceleration(self, q: Array, v: Array, u: Array) -> Array:
        """Return world accelerations and body angular accelerations (..., 6)."""
        omega = self._attitude.body_rates(q[..., 3:], v[..., 3:])
        out = np.empty((*np.broadcast_shapes(q.shape[:-1], v.shape[:-1], u.shape[:-1]), 6))
        out[..., :3] = (
            self._attitude.rotation(q[..., 3:])[..., 2] * np.sum(u, axis=-1)[..., None] / self._mass
        )
        out[..., 2] -= self._gravity
        momentum = omega @ self._inertia
        spin = (u @ self._torques - _cross(omega, momentum)) @ self._inverse
        out[..., 3:] = self._attitude.accelerations(q[..., 3:], v[..., 3:], spin)
        return out

    def kinematics(self, q: Array, v: Array) -> Array:
        """World velocity, and the attitude's derivative."""
        turning = self._attitude.kinematics(q[..., 3:], v[..., 3:])
        out = np.empty((*turning.shape[:-1], turning.shape[-1] + 3))
        out[..., :3], out[..., 3:] = v[..., :3], turning
        return out

    def output(self, q: Array, v: Array) -> Array:
        """Body rates (..., 3), where they are no velocities."""
        if self._attitude.size == QUATERNIONS.size:
            return np.zeros((*q.shape[:-1], 0))
        return self._attitude.body_rates(q[..., 3:], v[..., 3:])

    def tool(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Centre of mass and its velocity."""
        return q[..., :3], v[..., :3]

    def nose(self, q: Array) -> Array:
        """Body x axis (..., 3)."""
        return self._attitude.rotation(q[..., 3:])[..., 0]

    def skeleton(self, q: Array) -> dict[str, Array]:
        """Return the lines between opposite rotors."""
        lines = {"frame_a": self._rotors[[0, 2]], "frame_b": self._rotors[[1, 3]]}
        turn = self._attitude.rotation(q[3:])
        return {name: q[:3] + line @ turn.T for name, line in lines.items()}


def _cross(a: Array, b: Array) -> Array:
    """Cross product, in a third of the time of numpy's for one vector."""
    return a[..., NEXT] * b[..., AFTER] - a[..., AFTER] * b[..., NEXT]
