"""Attitude in numbers, written apart from the symbols; batched over leading axes.

a (..., 3 or 4) are the attitude's coordinates, w (..., 3) its velocities; body rates in rad/s.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import final

import numpy as np

from benchbench.ground.arrays import Array


class AttitudePlant(ABC):
    """What a plant needs to know about its attitude coordinates."""

    size: int

    @abstractmethod
    def rotation(self, a: Array) -> Array:
        """Body to world (..., 3, 3)."""

    @abstractmethod
    def body_rates(self, a: Array, w: Array) -> Array:
        """Body rates (..., 3)."""

    @abstractmethod
    def kinematics(self, a: Array, w: Array) -> Array:
        """da/dt."""

    @abstractmethod
    def accelerations(self, a: Array, w: Array, spin: Array) -> Array:
        """dw/dt (..., 3) from the body's angular acceleration (..., 3)."""


@final
class Angles(AttitudePlant):
    """a = [roll pitch yaw], w = da/dt."""

    size = 3

    def rotation(self, a: Array) -> Array:
        """R = Rz(yaw) Ry(pitch) Rx(roll)."""
        cr, cp, cy = _parts(np.cos(a))
        sr, sp, sy = _parts(np.sin(a))
        turn = np.empty((*a.shape[:-1], 3, 3))
        turn[..., 0, 0], turn[..., 1, 0], turn[..., 2, 0] = cy * cp, sy * cp, -sp
        turn[..., 0, 1], turn[..., 0, 2] = cy * sp * sr - sy * cr, cy * sp * cr + sy * sr
        turn[..., 1, 1], turn[..., 1, 2] = sy * sp * sr + cy * cr, sy * sp * cr - cy * sr
        turn[..., 2, 1], turn[..., 2, 2] = cp * sr, cp * cr
        return turn

    def body_rates(self, a: Array, w: Array) -> Array:
        """E(a) w."""
        (cr, cp, _), (sr, sp, _) = _parts(np.cos(a)), _parts(np.sin(a))
        roll, pitch, yaw = _parts(w)
        out = np.empty(np.broadcast_shapes(a.shape, w.shape))
        out[..., 0], out[..., 1] = roll - sp * yaw, cr * pitch + sr * cp * yaw
        out[..., 2] = cr * cp * yaw - sr * pitch
        return out

    def kinematics(self, a: Array, w: Array) -> Array:
        """Return w."""
        return w

    def accelerations(self, a: Array, w: Array, spin: Array) -> Array:
        """E^-1 (spin - dE/dt w)."""
        (cr, cp, _), (sr, sp, _) = _parts(np.cos(a)), _parts(np.sin(a))
        roll, pitch, yaw = _parts(w)
        x = spin[..., 0] + cp * pitch * yaw
        y = spin[..., 1] + sr * roll * pitch - (cr * cp * roll - sr * sp * pitch) * yaw
        z = spin[..., 2] + cr * roll * pitch + (sr * cp * roll + cr * sp * pitch) * yaw
        out = np.empty_like(spin)
        out[..., 2] = (sr * y + cr * z) / cp
        out[..., 0], out[..., 1] = x + sp * out[..., 2], cr * y - sr * z
        return out


@final
class Quaternions(AttitudePlant):
    """a = [qw qx qy qz], w = body rates."""

    size = 4

    def rotation(self, a: Array) -> Array:
        """From the normalised quaternion."""
        w, x, y, z = (a[..., i] for i in range(4))
        twice = 2 / (w * w + x * x + y * y + z * z)
        turn = np.empty((*a.shape[:-1], 3, 3))
        turn[..., 0, 0], turn[..., 1, 1] = 1 - twice * (y * y + z * z), 1 - twice * (x * x + z * z)
        turn[..., 2, 2] = 1 - twice * (x * x + y * y)
        turn[..., 0, 1], turn[..., 1, 0] = twice * (x * y - w * z), twice * (x * y + w * z)
        turn[..., 0, 2], turn[..., 2, 0] = twice * (x * z + w * y), twice * (x * z - w * y)
        turn[..., 1, 2], turn[..., 2, 1] = twice * (y * z - w * x), twice * (y * z + w * x)
        return turn

    def body_rates(self, a: Array, w: Array) -> Array:
        """Return w."""
        return w

    def kinematics(self, a: Array, w: Array) -> Array:
        """Half the quaternion times the body rates."""
        s, x, y, z = (a[..., i] for i in range(4))
        p, q, r = (w[..., i] / 2 for i in range(3))
        out = np.empty((*np.broadcast_shapes(a.shape[:-1], w.shape[:-1]), 4))
        out[..., 0], out[..., 1] = -x * p - y * q - z * r, s * p + y * r - z * q
        out[..., 2], out[..., 3] = s * q + z * p - x * r, s * r + x * q - y * p
        return out

    def accelerations(self, a: Array, w: Array, spin: Array) -> Array:
        """Return the spin."""
        return spin


def _parts(a: Array) -> tuple[Array, Array, Array]:
    return a[..., 0], a[..., 1], a[..., 2]
