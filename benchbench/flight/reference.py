"""What is to be flown: the certified replay of a plan on a fine grid, with a time to hover before it and one after it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchbench.ground.arrays import Array


@dataclass(frozen=True)
class Reference:
    """Sampled every `step` s; the plan's own time runs from 0 to `travel_time`, it hovers at its ends before and after.

    time          (n,) s, from -lead to travel_time + tail
    state         (n, 15) as `Truth.state`
    inputs        (n, 5) motor forces N and servo torque N m
    acceleration  (n, 3) m/s^2 of the body's origin, world
    target        (n, 6) position m and velocity m/s of the target, the top of the ball
    ball_radius   m, of the ball; reach: m of clearance within which the magnet pulls it
    window        s, start and end of the planned contact
    """

    step: float
    time: Array
    state: Array
    inputs: Array
    acceleration: Array
    target: Array
    ball_radius: float
    reach: float
    window: tuple[float, float]
    travel_time: float

    @property
    def lead(self) -> float:
        """Time of hovering before the plan, s."""
        return -float(self.time[0])

    def row(self, time: float) -> int:
        """Return the sample nearest to a time; the first or last for one outside."""
        return min(max(round((time - self.time[0]) / self.step), 0), len(self.time) - 1)


def tip(state: Array, arm_offset: float, arm_length: float) -> tuple[Array, Array]:
    """Position (n, 3) m and velocity (n, 3) m/s of the end effector for states (n, 15)."""
    arm, rate, omega = state[:, 7], state[:, 14], state[:, 11:14]
    zero = np.zeros(len(state))
    reach = np.stack([arm_length * np.cos(arm), zero, -arm_offset - arm_length * np.sin(arm)], axis=-1)
    swing = arm_length * rate[:, None] * np.stack([-np.sin(arm), zero, -np.cos(arm)], axis=-1)
    turn = matrices(state[:, 3:7])
    position = state[:, :3] + np.einsum("nij,nj->ni", turn, reach)
    velocity = state[:, 8:11] + np.einsum("nij,nj->ni", turn, np.cross(omega, reach) + swing)
    return position, velocity


def entry(reference: Reference, arm_offset: float, arm_length: float) -> float:
    """When the planned end effector first comes within the magnet's reach, s of the plan's time; inf where it never does."""
    place, _ = tip(reference.state, arm_offset, arm_length)
    centre = reference.target[:, :3] - [0, 0, reference.ball_radius]
    clear = np.linalg.norm(place - centre, axis=1) - reference.ball_radius
    near = (clear <= reference.reach) & (reference.time >= 0)
    return float(reference.time[np.argmax(near)]) if near.any() else np.inf


def matrices(quaternion: Array) -> Array:
    """Rotations (n, 3, 3), body to world, of quaternions (n, 4) w, x, y, z."""
    w, x, y, z = quaternion.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)
