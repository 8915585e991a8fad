"""Two ways to write a vehicle's attitude in symbols: Euler angles and the unit quaternion.

a are the attitude's coordinates, w its velocities; R turns body into world coordinates, omega are body rates.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Literal, final

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array
from benchbench_plugins.models.attitude_plant import Angles, AttitudePlant, Quaternions

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

AttitudeKind = Literal["euler", "quaternion"]


class Attitude(ABC):
    """Attitude coordinates and what follows from them; all vectors are CasADi SX columns."""

    names: tuple[str, ...]
    unit: str
    rates: tuple[str, str, str]
    origin: tuple[float, ...]
    flat: bool
    """Whether the coordinates add up."""
    level: tuple[bool, ...]
    """Which coordinates are fixed where the vehicle is level, its heading free."""
    independent: tuple[bool, ...]
    """Which coordinates do not follow from the others."""

    @abstractmethod
    def axis(self, a: ca.SX, i: int) -> ca.SX:
        """Return column i of R, the body axis i in the world."""

    @abstractmethod
    def omega(self, a: ca.SX, w: ca.SX) -> ca.SX:
        """Return the body rates (3,) rad/s."""

    @abstractmethod
    def kinematics(self, a: ca.SX, w: ca.SX) -> ca.SX:
        """Return da/dt."""

    @abstractmethod
    def moment(self, a: ca.SX, torque: ca.SX) -> ca.SX:
        """Return the generalised force of a body torque by virtual work: moment . w = torque . omega."""

    @abstractmethod
    def acceleration(self, a: ca.SX, w: ca.SX, spin: ca.SX) -> ca.SX:
        """Return dw/dt from the body's angular acceleration."""

    @abstractmethod
    def difference(self, a0: ca.SX, a1: ca.SX) -> ca.SX:
        """Return w that leads from a0 to a1 in unit time, see `benchbench.ocp.space.Space.difference`."""

    @abstractmethod
    def constraint(self, a: ca.SX) -> ca.SX:
        """Return what is zero for attitudes, see `benchbench.ocp.space.Space.constraint`."""

    @abstractmethod
    def normalised(self, a: ca.SX) -> ca.SX:
        """Return the attitude nearest to a."""

    @abstractmethod
    def follow(self, turns: Rotation) -> Array:
        """Coordinates (n, n_a) of consecutive attitudes, without jumps."""

    @abstractmethod
    def headed(self, heading: float) -> Array:
        """Level, nose at a heading in rad."""

    @abstractmethod
    def plant(self) -> AttitudePlant:
        """Return the same in numbers, written apart."""

    def rotation(self, a: ca.SX) -> ca.SX:
        """R (3, 3)."""
        return ca.horzcat(*(self.axis(a, i) for i in range(3)))


@final
class EulerAngles(Attitude):
    """a = [roll pitch yaw], R = Rz(yaw) Ry(pitch) Rx(roll), w = da/dt; singular at a pitch of 90 degrees."""

    names = rates = ("roll", "pitch", "yaw")
    unit = "rad"
    origin = (0.0, 0.0, 0.0)
    flat = True
    level = (True, True, False)
    independent = (True, True, True)

    def axis(self, a: ca.SX, i: int) -> ca.SX:
        """Columns of Rz Ry Rx."""
        cf, sf, ct, st, cp, sp = (fn(a[j]) for j in range(3) for fn in (ca.cos, ca.sin))
        return (
            ca.vertcat(cp * ct, sp * ct, -st),
            ca.vertcat(cp * st * sf - sp * cf, sp * st * sf + cp * cf, ct * sf),
            ca.vertcat(cp * st * cf + sp * sf, sp * st * cf - cp * sf, ct * cf),
        )[i]

    def omega(self, a: ca.SX, w: ca.SX) -> ca.SX:
        """E(a) w."""
        return rate_matrix(a) @ w

    def kinematics(self, a: ca.SX, w: ca.SX) -> ca.SX:
        """Return w."""
        return w

    def moment(self, a: ca.SX, torque: ca.SX) -> ca.SX:
        """E(a)^T torque."""
        return rate_matrix(a).T @ torque

    def acceleration(self, a: ca.SX, w: ca.SX, spin: ca.SX) -> ca.SX:
        """E^-1 (spin - dE/dt w)."""
        cf, sf, ct, st = ca.cos(a[0]), ca.sin(a[0]), ca.cos(a[1]), ca.sin(a[1])
        roll, pitch, turn = w[0], w[1], w[2]
        drift = ca.vertcat(
            -ct * pitch * turn,
            -sf * roll * pitch + (cf * ct * roll - sf * st * pitch) * turn,
            -cf * roll * pitch - (sf * ct * roll + cf * st * pitch) * turn,
        )
        x, y, z = ca.vertsplit(spin - drift)
        yaw = (sf * y + cf * z) / ct
        return ca.vertcat(x + st * yaw, cf * y - sf * z, yaw)

    def difference(self, a0: ca.SX, a1: ca.SX) -> ca.SX:
        """Of the angles."""
        return a1 - a0

    def constraint(self, a: ca.SX) -> ca.SX:
        """Nothing."""
        return ca.SX(0, 1)

    def normalised(self, a: ca.SX) -> ca.SX:
        """As it is."""
        return a

    def follow(self, turns: Rotation) -> Array:
        """Unwrapped angles."""
        return np.unwrap(turns.as_euler("ZYX")[:, ::-1], axis=0)

    def headed(self, heading: float) -> Array:
        """Return the yaw angle alone."""
        return np.array([0.0, 0.0, heading])

    def plant(self) -> AttitudePlant:
        """Angles in numbers."""
        return Angles()


@final
class UnitQuaternion(Attitude):
    """a = [qw qx qy qz] of length one, w = omega; no singularity, a and -a are the same attitude."""

    names = ("qw", "qx", "qy", "qz")
    rates = ("wx", "wy", "wz")
    unit = "1"
    origin = (1.0, 0.0, 0.0, 0.0)
    flat = False
    level = (False, True, True, False)
    independent = (False, True, True, True)

    def axis(self, a: ca.SX, i: int) -> ca.SX:
        """Body axis in the world, for a quaternion of any length."""
        w, e, x = a[0], a[1:], ca.DM([j == i for j in range(3)])
        turned = (w**2 - ca.sumsqr(e)) * x + 2 * ca.dot(e, x) * e + 2 * w * ca.cross(e, x)
        return turned / ca.sumsqr(a)

    def omega(self, a: ca.SX, w: ca.SX) -> ca.SX:
        """Return w."""
        return w

    def kinematics(self, a: ca.SX, w: ca.SX) -> ca.SX:
        """Return a * [0, omega] / 2."""
        return ca.vertcat(-ca.dot(a[1:], w) / 2, (a[0] * w + ca.cross(a[1:], w)) / 2)

    def moment(self, a: ca.SX, torque: ca.SX) -> ca.SX:
        """Return the torque."""
        return torque

    def acceleration(self, a: ca.SX, w: ca.SX, spin: ca.SX) -> ca.SX:
        """Return the spin."""
        return spin

    def difference(self, a0: ca.SX, a1: ca.SX) -> ca.SX:
        """Rotation vector of conj(a0) * a1, to 2e-6 below 0.9 rad.

        Twice its vector part is 2 sin(angle / 2) about the axis; the series in 1 - cos(angle / 2) makes an angle of it.
        Without it a step that turns by `angle` errs by angle^2 / 6 of itself: races needed three times the nodes.
        """
        twice = 2 * (a0[0] * a1[1:] - a1[0] * a0[1:] - ca.cross(a0[1:], a1[1:]))
        x = 1 - ca.dot(a0, a1)
        return twice * (1 + x / 3 + 2 * x**2 / 15 + 2 * x**3 / 35)

    def constraint(self, a: ca.SX) -> ca.SX:
        """Return |a|^2 - 1."""
        return ca.sumsqr(a) - 1

    def normalised(self, a: ca.SX) -> ca.SX:
        """Return a / |a|."""
        return a / ca.norm_2(a)

    def follow(self, turns: Rotation) -> Array:
        """Quaternions, each of the sign that is nearer to the one before."""
        quaternion = turns.as_quat(scalar_first=True)
        same = np.sum(quaternion[1:] * quaternion[:-1], axis=1) >= 0
        quaternion[1:] *= np.cumprod(np.where(same, 1.0, -1.0))[:, None]
        return np.asarray(quaternion)

    def headed(self, heading: float) -> Array:
        """Return a turn about z."""
        return np.array([np.cos(heading / 2), 0.0, 0.0, np.sin(heading / 2)])

    def plant(self) -> AttitudePlant:
        """Quaternions in numbers."""
        return Quaternions()


ATTITUDES: dict[AttitudeKind, Attitude] = {"euler": EulerAngles(), "quaternion": UnitQuaternion()}


def rate_matrix(a: ca.SX) -> ca.SX:
    """E(a) with omega = E da/dt for Euler angles, the inverse of the paper's T(xi), (3, 3)."""
    cf, sf, ct, st = ca.cos(a[0]), ca.sin(a[0]), ca.cos(a[1]), ca.sin(a[1])
    return ca.vertcat(ca.horzcat(1, 0, -st), ca.horzcat(0, cf, sf * ct), ca.horzcat(0, -sf, cf * ct))
