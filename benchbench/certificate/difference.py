"""How far states are apart: as a length, an angle, a speed and a rate."""

from __future__ import annotations

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ocp.plan import Plan


def distance(plan: Plan, difference: Array) -> Array:
    """Return the Euclidean length of the coordinates in m, (n,), from differences (n, n_q)."""
    return np.asarray(np.linalg.norm(difference[:, [u == "m" for u in plan.coordinate_units]], axis=1))


def speed(plan: Plan, difference: Array) -> Array:
    """Return the Euclidean length of the velocities in m/s, (n,), from differences (n, n_v)."""
    return np.asarray(np.linalg.norm(difference[:, [u == "m/s" for u in plan.velocity_units]], axis=1))


def rate(plan: Plan, difference: Array) -> Array:
    """Return the largest of the rates in rad/s, (n,), from differences (n, n_v)."""
    turning = np.abs(difference[:, [u == "rad/s" for u in plan.velocity_units]])
    return np.asarray(np.max(turning, axis=1, initial=0.0))


def angle(plan: Plan, difference: Array) -> Array:
    """Return the largest of the coordinates in rad, (n,), from differences (n, n_q).

    Four coordinates without a unit are a quaternion, whose small differences are half an angle.
    """
    turned = np.abs(difference[:, [u == "rad" for u in plan.coordinate_units]])
    quaternion = difference[:, [u == "1" for u in plan.coordinate_units]]
    half = np.linalg.norm(quaternion, axis=1)
    return np.asarray(np.maximum(np.max(turned, axis=1, initial=0.0), 2 * half))
