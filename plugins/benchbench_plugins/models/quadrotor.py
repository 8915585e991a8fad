"""Racing quadrotor with a unit quaternion and body rates (Foehn, Romero & Scaramuzza 2021, doi:10.1126/scirobotics.abh1221).

q = [x y z qw qx qy qz], the quaternion turns body into world coordinates; v = [vx vy vz] in the world and
[wx wy wz] in the body frame, so dq/dt is not v; u = [f_1 .. f_4]. No singularity, no drag.
"""

from __future__ import annotations

from typing import final

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from pydantic.dataclasses import dataclass
from scipy.spatial.transform import Rotation

from benchbench.errors import BadInput
from benchbench.model import Coordinates, Model, Plant, box
from benchbench.plan import Array
from benchbench.scenario import NonNegative, Positive, Range
from benchbench_plugins.models.quadrotor_plant import QuadrotorPlant

NAMES = ("x", "y", "z", "qw", "qx", "qy", "qz")
RATES = ("vx", "vy", "vz", "wx", "wy", "wz")
Triple = tuple[Positive, Positive, Positive]


@dataclass(frozen=True)
class Ramp:
    """Limits that grow linearly from their values at the start to the vehicle's own over the first metres.

    metres       of the nominal path, as `Model.velocity_limits` counts them
    motor_force  largest motor force at the start, N
    body_rate    largest body rates at the start, rad/s
    """

    metres: Positive
    motor_force: Positive
    body_rate: Triple


@final
@dataclass(frozen=True)
class Quadrotor(Model):
    """Four motors in X configuration, motors 1 and 4 on the left side (+y), 1 and 2 in front.

    mass kg; inertia kg m^2 about the body axes; lever m of a motor about the x and y axis; torque_coefficient m,
    yaw torque by thrust; motor_force N; body_rate rad/s; gravity m/s^2; ramp: None for the same limits everywhere.
    """

    name: str
    mass: Positive
    inertia: Triple
    lever: Positive
    torque_coefficient: NonNegative
    motor_force: Range
    body_rate: Triple
    gravity: Positive = 9.8066
    ramp: Ramp | None = None

    def __post_init__(self) -> None:
        """Refuse a ramp that falls; raises BadInput."""
        if self.ramp and not self.motor_force[0] <= self.ramp.motor_force <= self.motor_force[1]:
            allowed = f"{self.motor_force[0]:g} to {self.motor_force[1]:g} N"
            raise BadInput("vehicle.ramp.motor_force", f"{self.ramp.motor_force:g} N was given", allowed)

    @property
    def configuration(self) -> Coordinates:
        """Position is limited by the scenario's workspace only, attitude not at all."""
        return box(NAMES, ("m",) * 3 + ("1",) * 4, [-np.inf] * 7, [np.inf] * 7)

    @property
    def velocity(self) -> Coordinates:
        """World velocity without limits, body rates with."""
        most = [np.inf] * 3 + list(self.body_rate)
        return box(RATES, ("m/s",) * 3 + ("rad/s",) * 3, [-x for x in most], most)

    @property
    def inputs(self) -> Coordinates:
        """Motor forces."""
        low, high = self.motor_force
        return box(tuple(f"motor_{i}" for i in range(1, 5)), ("N",) * 4, [low] * 4, [high] * 4)

    def velocity_limits(self, flown: Array) -> tuple[Array, Array]:
        """Limits of the body rates, along the ramp."""
        most = np.tile(self.velocity.upper, (len(flown), 1))
        if self.ramp:
            most[:, 3:] = self._along(flown, self.ramp.body_rate, self.body_rate)
        return -most, most

    def input_limits(self, flown: Array) -> tuple[Array, Array]:
        """Limits of the motor forces, along the ramp."""
        low, high = self.motor_force
        first = self.ramp.motor_force if self.ramp else high
        return np.full((len(flown), 4), low), self._along(flown, (first,) * 4, (high,) * 4)

    def fixed_at_rest(self) -> NDArray[np.bool_]:
        """Place, roll and pitch; qw and qz are the heading."""
        return np.array([name in ("x", "y", "z", "qx", "qy") for name in NAMES])

    def specific_thrust(self, flown: Array) -> Array:
        """All motors at their limits."""
        return np.asarray(self.input_limits(flown)[1].sum(axis=1) / self.mass)

    def follow(
        self, time: Array, position: Array, velocity: Array, thrust: Array
    ) -> tuple[Array, Array, Array]:
        """Thrust along the body z axis, turned from node to node the shortest way, never about it."""
        size = np.linalg.norm(thrust, axis=1)
        way = thrust / np.maximum(size, 1e-9)[:, None]
        attitude = [Rotation.identity()]
        turns = np.zeros((len(time), 3))
        for k in range(1, len(time)):
            up = attitude[-1].apply([0.0, 0.0, 1.0])
            wanted = way[min(k, len(way) - 1)]
            axis = np.cross(up, wanted)
            sine = float(np.linalg.norm(axis))
            turn = axis / max(sine, 1e-9) * np.arctan2(sine, up @ wanted)
            turns[k] = attitude[-1].inv().apply(turn)
            attitude.append(Rotation.from_rotvec(turn) * attitude[-1])
        quaternion = np.array([rotation.as_quat(scalar_first=True) for rotation in attitude])
        same = np.sum(quaternion[1:] * quaternion[:-1], axis=1) >= 0
        quaternion[1:] *= np.cumprod(np.where(same, 1.0, -1.0))[:, None]
        most = np.array(self.body_rate)
        rates = np.clip(turns / np.append(1.0, np.diff(time))[:, None], -most, most)
        force = np.repeat(size[:, None] * self.mass / 4, 4, axis=1)
        return np.hstack([position, quaternion]), np.hstack([velocity, rates]), force

    def kinematics(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Return world velocity and q * [0, omega] / 2."""
        w, i = q[3], q[4:]
        omega = v[3:]
        return ca.vertcat(v[:3], -ca.dot(i, omega) / 2, (w * omega + ca.cross(i, omega)) / 2)

    def normalised(self, q: ca.SX) -> ca.SX:
        """Unit quaternion."""
        return ca.vertcat(q[:3], q[3:] / ca.norm_2(q[3:]))

    def origin(self) -> Array:
        """Upright, nose along x."""
        return np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])

    def acceleration(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """Newton and Euler; the direction of thrust does not depend on the length of the quaternion."""
        thrust = _turned(q, (0, 0, 1)) * ca.sum1(u) / self.mass
        inertia, omega = ca.DM(self.inertia), v[3:]
        torque = ca.vertcat(
            self.lever * (u[0] - u[1] - u[2] + u[3]),
            self.lever * (-u[0] - u[1] + u[2] + u[3]),
            self.torque_coefficient * (u[0] - u[1] + u[2] - u[3]),
        )
        spin = (torque - ca.cross(omega, inertia * omega)) / inertia
        return ca.vertcat(thrust - ca.DM([0, 0, self.gravity]), spin)

    def force(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """There are no generalised forces without a Lagrangian."""
        raise NotImplementedError("the quadrotor in quaternions gives accelerations")

    def tool(self, q: ca.SX) -> ca.SX:
        """Return the centre of mass, which has to pass the gates."""
        return q[:3]

    def nose(self, q: ca.SX) -> ca.SX:
        """Body x axis."""
        return _turned(q, (1, 0, 0))

    def hover(self) -> Array:
        """Equal forces that carry the weight."""
        return np.full(4, self.mass * self.gravity / 4)

    def plant(self) -> Plant:
        """Independent Newton-Euler equations."""
        return QuadrotorPlant(self.mass, self.inertia, self.lever, self.torque_coefficient, self.gravity)

    def _along(self, flown: Array, first: tuple[float, ...], last: tuple[float, ...]) -> Array:
        share = np.clip(flown / self.ramp.metres, 0.0, 1.0) if self.ramp else np.ones(len(flown))
        return np.asarray((1 - share)[:, None] * first + share[:, None] * last)


def _turned(q: ca.SX, axis: tuple[int, int, int]) -> ca.SX:
    """Body axis in the world, for a quaternion of any length."""
    w, i, a = q[3], q[4:], ca.DM(axis)
    return ((w**2 - ca.sumsqr(i)) * a + 2 * ca.dot(i, a) * i + 2 * w * ca.cross(i, a)) / ca.sumsqr(q[3:])
