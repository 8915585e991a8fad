"""Racing quadrotor (Foehn, Romero & Scaramuzza 2021, doi:10.1126/scirobotics.abh1221), in two attitude coordinates.

q = [x y z, attitude], v = [vx vy vz, attitude rates] with world velocities, u = [f_1 .. f_4]; no drag.
attitude "quaternion": [qw qx qy qz] turns body into world coordinates, the rates are body rates, no singularity.
attitude "euler": [roll pitch yaw] and their derivatives (the paper); body rates are limited as outputs.
"""

from __future__ import annotations

from typing import final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.ocp.model import (
    Bounds,
    Coordinates,
    ExplicitModel,
    LagrangianModel,
    ManifoldModel,
    OutputModel,
    Plant,
    RacingModel,
    RampModel,
    box,
)
from benchbench.ocp.scenario import NonNegative, Positive, Range
from benchbench.ocp.space import Space
from benchbench_plugins.models.attitude import ATTITUDES, Attitude, AttitudeKind
from benchbench_plugins.models.attitude_space import AttitudeSpace
from benchbench_plugins.models.quadrotor_plant import QuadrotorPlant

POSITION, VELOCITY, RATES = ("x", "y", "z"), ("vx", "vy", "vz"), ("wx", "wy", "wz")
ANGLES = np.array([np.pi, 1.5, np.pi])
"""Limits of roll, pitch, yaw in rad, where they are the coordinates: off the singularity."""
OFF_LIMITS = 0.9
"""Share of the point mass's thrust in a guess."""
Triple = tuple[Positive, Positive, Positive]


@dataclass(frozen=True)
class Ramp:
    """Limits that grow linearly from their values at the start to the vehicle's own over the first metres.

    metres       of the nominal path, as `RampModel` counts them
    motor_force  largest motor force at the start, N
    body_rate    largest body rates at the start, rad/s
    """

    metres: Positive
    motor_force: Positive
    body_rate: Triple


@final
@dataclass(frozen=True)
class Quadrotor(ExplicitModel, LagrangianModel, ManifoldModel, OutputModel, RampModel, RacingModel):
    """Four motors in X configuration, motors 1 and 4 on the left side (+y), 1 and 2 in front.

    mass kg; inertia kg m^2 about the body axes; lever m of a motor about the x and y axis; torque_coefficient m,
    yaw torque by thrust; motor_force N; body_rate rad/s; gravity m/s^2; ramp: None for the same limits everywhere;
    attitude: "quaternion" or "euler".
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
    attitude: AttitudeKind = "quaternion"

    def __post_init__(self) -> None:
        """Refuse a ramp that falls; raises BadInput."""
        if self.ramp and not self.motor_force[0] <= self.ramp.motor_force <= self.motor_force[1]:
            allowed = f"{self.motor_force[0]:g} to {self.motor_force[1]:g} N"
            raise BadInput("vehicle.ramp.motor_force", f"{self.ramp.motor_force:g} N was given", allowed)

    @property
    def configuration(self) -> Coordinates:
        """Position is limited by the scenario's workspace only, attitude not at all or off the singularity."""
        of = self._attitude
        most = np.concatenate([np.full(3, np.inf), ANGLES if self._in_angles else np.full(4, np.inf)])
        names, units = POSITION + of.names, ("m",) * 3 + (of.unit,) * len(of.names)
        return Coordinates(names, units, -most, most)

    @property
    def velocity(self) -> Coordinates:
        """World velocity without limits; rates with, where they are body rates."""
        most = np.concatenate([np.full(3, np.inf), np.full(3, np.inf) if self._in_angles else self.body_rate])
        of = self._attitude
        names = (POSITION if self._in_angles else VELOCITY) + of.rates
        return Coordinates(names, ("m/s",) * 3 + ("rad/s",) * 3, -most, most)

    @property
    def space(self) -> Space:
        """A place to rest at leaves the heading open."""
        return AttitudeSpace(self._attitude, joints=0, heading_free=True)

    @property
    def outputs(self) -> Coordinates:
        """Body rates, where they are no velocities."""
        if not self._in_angles:
            return box((), (), [], [])
        return box(RATES, ("rad/s",) * 3, [-x for x in self.body_rate], self.body_rate)

    @property
    def inputs(self) -> Coordinates:
        """Motor forces."""
        low, high = self.motor_force
        return box(tuple(f"motor_{i}" for i in range(1, 5)), ("N",) * 4, [low] * 4, [high] * 4)

    def velocity_bounds(self, flown: Array) -> Bounds:
        """Limits of the body rates, along the ramp, where they are velocities."""
        most = np.tile(self.velocity.upper, (len(flown), 1))
        if not self._in_angles:
            most[:, 3:] = self._rate_limits(flown)
        return -most, most

    def output_bounds(self, flown: Array) -> Bounds:
        """The same, where they are outputs."""
        most = self._rate_limits(flown)[:, : len(self.outputs.names)]
        return -most, most

    def input_bounds(self, flown: Array) -> Bounds:
        """Limits of the motor forces, along the ramp."""
        low, high = self.motor_force
        first = self.ramp.motor_force if self.ramp else high
        return np.full((len(flown), 4), low), self._along(flown, (first,) * 4, (high,) * 4)

    def specific_thrust(self, flown: Array) -> Array:
        """All motors at their limits."""
        return np.asarray(self.input_bounds(flown)[1].sum(axis=1) / self.mass)

    def follow(
        self, time: Array, position: Array, velocity: Array, thrust: Array
    ) -> tuple[Array, Array, Array]:
        """Thrust along the body z axis, turned from node to node the shortest way, never about it.

        Forces keep a tenth off their limits: there, interior-point methods took up to twice the iterations.
        """
        from scipy.spatial.transform import Rotation  # a quarter of a second, which only this guess needs

        size = np.linalg.norm(thrust, axis=1)
        at_nodes = np.vstack([thrust[:1], (thrust[1:] + thrust[:-1]) / 2])
        way = at_nodes / np.maximum(np.linalg.norm(at_nodes, axis=1), 1e-9)[:, None]
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
        place, step = self._attitude.follow(Rotation.concatenate(attitude)), np.append(1.0, np.diff(time))
        most = np.array(self.body_rate)
        rates = np.clip(turns / step[:, None], -most, most)
        rates[:-1] = (rates[:-1] + rates[1:]) / 2
        if self._in_angles:
            rates = np.diff(place, axis=0, prepend=place[:1]) / step[:, None]
        force = np.repeat(OFF_LIMITS * size[:, None] * self.mass / 4, 4, axis=1)
        return np.hstack([position, place]), np.hstack([velocity, rates]), force

    def output(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Body rates beside Euler angles."""
        return self._attitude.omega(q[3:], v[3:])[: len(self.outputs.names)]

    def lagrangian(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """L = (m |dp/dt|^2 + omega^T J omega) / 2 - m g z."""
        omega = self._attitude.omega(q[3:], v[3:])
        kinetic = (self.mass * ca.sumsqr(v[:3]) + ca.dot(omega, ca.DM(self.inertia) * omega)) / 2
        return kinetic - self.mass * self.gravity * q[2]

    def force(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """R e_3 sum f, and the moment of the motors by virtual work."""
        thrust = self._attitude.axis(q[3:], 2) * ca.sum1(u)
        return ca.vertcat(thrust, self._attitude.moment(q[3:], self._torque(u)))

    def acceleration(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """Newton and Euler; the direction of thrust does not depend on the length of the quaternion."""
        thrust = self._attitude.axis(q[3:], 2) * ca.sum1(u) / self.mass
        inertia, omega = ca.DM(self.inertia), self._attitude.omega(q[3:], v[3:])
        spin = (self._torque(u) - ca.cross(omega, inertia * omega)) / inertia
        turning = self._attitude.acceleration(q[3:], v[3:], spin)
        return ca.vertcat(thrust - ca.DM([0, 0, self.gravity]), turning)

    def tool(self, q: ca.SX) -> ca.SX:
        """Return the centre of mass, which has to pass the gates."""
        return q[:3]

    def nose(self, q: ca.SX) -> ca.SX:
        """Body x axis."""
        return self._attitude.axis(q[3:], 0)

    def hover(self) -> Array:
        """Equal forces that carry the weight."""
        return np.full(4, self.mass * self.gravity / 4)

    def plant(self) -> Plant:
        """Independent Newton-Euler equations."""
        numbers = (self.mass, self.inertia, self.lever, self.torque_coefficient, self.gravity)
        return QuadrotorPlant(*numbers, self._attitude.plant())

    @property
    def _attitude(self) -> Attitude:
        return ATTITUDES[self.attitude]

    @property
    def _in_angles(self) -> bool:
        return self.attitude == "euler"

    def _torque(self, u: ca.SX) -> ca.SX:
        return ca.vertcat(
            self.lever * (u[0] - u[1] - u[2] + u[3]),
            self.lever * (-u[0] - u[1] + u[2] + u[3]),
            self.torque_coefficient * (u[0] - u[1] + u[2] - u[3]),
        )

    def _rate_limits(self, flown: Array) -> Array:
        return self._along(flown, self.ramp.body_rate if self.ramp else self.body_rate, self.body_rate)

    def _along(self, flown: Array, first: tuple[float, ...], last: tuple[float, ...]) -> Array:
        share = np.clip(flown / self.ramp.metres, 0.0, 1.0) if self.ramp else np.ones(len(flown))
        return np.asarray((1 - share)[:, None] * first + share[:, None] * last)
