"""The arm of two links once more, in numbers: Newton's and Euler's laws from the hand to the shoulder (Luh, Walker & Paul 1980)."""

from typing import final

import numpy as np

from benchbench import Array, Plant

Two = tuple[float, float]


@final
class TwoLinkPlant(Plant):
    """Torques follow from accelerations, link by link; accelerations from three such walks (Walker & Orin 1982)."""

    def __init__(self, length: Two, mass: Two, damping: Two, height: float) -> None:
        """m, kg, N m s/rad, m; see `two_link.TwoLink`."""
        self._length, self._mass, self._damping = length, mass, np.asarray(damping)
        self._height = height

    def acceleration(self, q: Array, v: Array, u: Array) -> Array:
        """Return angular accelerations (..., 2)."""
        free = self._torques(q, v, np.zeros_like(v))
        still = np.zeros_like(v)
        columns = [self._torques(q, still, np.broadcast_to(unit, v.shape)) for unit in np.eye(2)]
        motors = u - self._damping * v - free
        return np.asarray(np.linalg.solve(np.stack(columns, axis=-1), motors[..., None])[..., 0])

    def _torques(self, q: Array, v: Array, a: Array) -> Array:
        """Torques (..., 2) at the joints for these angles, rates and accelerations, all of them relative."""
        turned, rate, spin = (np.cumsum(x, axis=-1) for x in (q, v, a))
        joint, moving = np.zeros((*q.shape[:-1], 2)), []
        for i in range(2):
            along = np.stack([np.cos(turned[..., i]), np.sin(turned[..., i])], axis=-1)
            across = np.stack([-along[..., 1], along[..., 0]], axis=-1)
            link = spin[..., i, None] * across - rate[..., i, None] ** 2 * along
            moving.append((along, joint + self._length[i] / 2 * link))
            joint = joint + self._length[i] * link
        force, moment, found = np.zeros_like(joint), np.zeros(q.shape[:-1]), []
        for i in (1, 0):
            (along, centre), half = moving[i], self._length[i] / 2
            inner = self._mass[i] * centre + force
            inertia = self._mass[i] * self._length[i] ** 2 / 12
            moment = moment + inertia * spin[..., i] + half * (_cross(along, force) + _cross(along, inner))
            force = inner
            found.append(moment)
        return np.stack(found[::-1], axis=-1)

    def tool(self, q: Array, v: Array) -> tuple[Array, Array]:
        """The hand and its velocity."""
        turned, rate = np.cumsum(q, axis=-1), np.cumsum(v, axis=-1)
        x = np.stack([np.cos(turned), np.sin(turned), 0 * turned], axis=-1)
        y = np.stack([-np.sin(turned), np.cos(turned), 0 * turned], axis=-1)
        reach = np.asarray(self._length)[:, None]
        place = np.sum(reach * x, axis=-2) + np.array([0.0, 0.0, self._height])
        return place, np.sum(reach * rate[..., None] * y, axis=-2)

    def nose(self, q: Array) -> Array:
        """Where the forearm points."""
        turned = q[..., 0] + q[..., 1]
        return np.stack([np.cos(turned), np.sin(turned), 0 * turned], axis=-1)

    def skeleton(self, q: Array) -> dict[str, Array]:
        """Upper arm and forearm."""
        elbow = self._length[0] * np.array([np.cos(q[0]), np.sin(q[0]), 0.0]) + [0.0, 0.0, self._height]
        hand, _ = self.tool(q, np.zeros(2))
        return {"upper": np.stack([[0.0, 0.0, self._height], elbow]), "forearm": np.stack([elbow, hand])}


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
