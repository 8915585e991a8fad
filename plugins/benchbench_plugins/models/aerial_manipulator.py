"""Quadrotor with a one-joint arm (paper Sec. II), as a Lagrangian system in two attitude coordinates.

attitude "euler": q = [x y z roll pitch yaw arm], written [p, xi, alpha] in the paper, v = dq/dt;
attitude "quaternion": q = [x y z qw qx qy qz arm], v = [world velocity, body rates, arm rate], no singularity;
roll, pitch and Euler rates are then outputs, with the same limits. u = [f_1 .. f_4, tau_servo].
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, Literal, final

import casadi as ca
import numpy as np
from pydantic import ValidationError

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput, invalid
from benchbench.ocp.airframe import Airframe, FlownModel
from benchbench.ocp.model import (
    AgileModel,
    Bounds,
    Coordinates,
    LagrangianModel,
    ManifoldModel,
    OutputModel,
    Plant,
    RacingModel,
    box,
)
from benchbench.ocp.space import Space
from benchbench_plugins.models import aerial_manipulator_agility as agility
from benchbench_plugins.models.aerial_manipulator_parameters import Parameters
from benchbench_plugins.models.aerial_manipulator_plant import AerialManipulatorPlant
from benchbench_plugins.models.attitude import ATTITUDES, AttitudeKind
from benchbench_plugins.models.attitude_space import AttitudeSpace

POSITION, VELOCITY, ANGLES = ("x", "y", "z"), ("vx", "vy", "vz"), ("roll", "pitch", "yaw")
INPUTS = ("motor_1", "motor_2", "motor_3", "motor_4", "servo")


@final
class AerialManipulator(LagrangianModel, ManifoldModel, OutputModel, RacingModel, FlownModel, AgileModel):
    """Aerial manipulator of the paper.

    force_model "virtual_work": Q_p = R e_3 sum f, Q_xi = E(xi)^T tau_B, Q_alpha = tau_servo. The arm angle
    is relative, so the internal servo torque does no work on the attitude.
    force_model "paper": motor torques act on the Euler angles directly, a named ablation; plans made with
    it are replayed on the correct plant and judged by that.
    """

    def __init__(
        self,
        name: str,
        force_model: Literal["virtual_work", "paper"] = "virtual_work",
        attitude: AttitudeKind = "euler",
        **parameters: Any,
    ) -> None:
        """Take the fields of `Parameters` as keywords; raises BadInput that names a wrong field."""
        if force_model not in ("virtual_work", "paper"):
            raise BadInput("vehicle.force_model", f"'{force_model}' does not exist", "virtual_work, paper")
        if attitude not in ATTITUDES:
            raise BadInput("vehicle.attitude", f"'{attitude}' does not exist", ", ".join(ATTITUDES))
        if force_model == "paper" and attitude != "euler":
            raise BadInput("vehicle.force_model", "'paper' puts torques on Euler angles", "attitude=euler")
        try:
            self.parameters = Parameters(**parameters)
        except ValidationError as error:
            raise invalid("vehicle", error, Parameters.model_fields) from None
        self.name, self.force_model, self._attitude = name, force_model, ATTITUDES[attitude]
        self._in_angles = attitude == "euler"

    @property
    def configuration(self) -> Coordinates:
        """Position is limited by the scenario's workspace only, yaw and quaternions not at all."""
        p, of = self.parameters, self._attitude
        most = [p.tilt, p.tilt, np.inf] if self._in_angles else [np.inf] * 4
        high = np.array([np.inf] * 3 + most + [p.arm_angle[1]])
        low = np.append(-high[:-1], p.arm_angle[0])
        units = ("m",) * 3 + (of.unit,) * len(of.names) + ("rad",)
        return Coordinates((*POSITION, *of.names, "arm"), units, low, high)

    @property
    def velocity(self) -> Coordinates:
        """Limits on world velocity, arm rate and, where they are velocities, Euler angle rates."""
        p = self.parameters
        names = POSITION + ANGLES if self._in_angles else VELOCITY + self._attitude.rates
        turning = p.angular_rate if self._in_angles else [np.inf] * 3
        most = np.array([*p.speed, *turning, p.arm_rate])
        return Coordinates((*names, "arm"), ("m/s",) * 3 + ("rad/s",) * 4, -most, most)

    @property
    def space(self) -> Space:
        """The attitude's, with one joint."""
        return AttitudeSpace(self._attitude, joints=1, heading_free=False)

    @property
    def outputs(self) -> Coordinates:
        """Roll, pitch and Euler angle rates, where they are neither coordinates nor velocities."""
        if self._in_angles:
            return box((), (), [], [])
        p = self.parameters
        most = np.array([p.tilt, p.tilt, *p.angular_rate])
        names = (*ANGLES[:2], *(f"{angle}_rate" for angle in ANGLES))
        return Coordinates(names, ("rad",) * 2 + ("rad/s",) * 3, -most, most)

    @property
    def inputs(self) -> Coordinates:
        """Motor forces and servo torque."""
        (f_low, f_high), (t_low, t_high) = self.parameters.motor_force, self.parameters.servo_torque
        return box(INPUTS, ("N",) * 4 + ("N m",), [f_low] * 4 + [t_low], [f_high] * 4 + [t_high])

    def lagrangian(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """L = K - V of quadrotor and arm (paper Eq. 10-12)."""
        p = self.parameters
        omega = self._attitude.omega(q[3:-1], v[3:6])
        arm_centre = self._along_arm(q, p.arm_length / 2)
        arm_velocity = ca.jtimes(arm_centre, q, self.space.kinematics(q, v))
        to_arm = arm_rotation(q[-1]).T
        arm_omega = to_arm @ (omega + ca.vertcat(0, v[6], 0))
        kinetic = (
            p.quadrotor_mass * ca.sumsqr(v[:3])
            + ca.dot(omega, ca.DM(p.quadrotor_inertia) * omega)
            + p.arm_mass * ca.sumsqr(arm_velocity)
            + ca.dot(arm_omega, ca.DM(p.arm_inertia) * arm_omega)
        ) / 2
        return kinetic - p.gravity * (p.quadrotor_mass * q[2] + p.arm_mass * arm_centre[2])

    def force(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """Generalised forces; motor torques by paper Eq. 2."""
        f = u[:4]
        lever = np.sqrt(2) / 4 * self.parameters.frame
        torque = ca.vertcat(
            lever * (f[1] + f[2] - f[0] - f[3]),
            lever * (f[1] + f[3] - f[0] - f[2]),
            self.parameters.torque_coefficient * (f[2] + f[3] - f[0] - f[1]),
        )
        if self.force_model == "virtual_work":
            torque = self._attitude.moment(q[3:-1], torque)
        return ca.vertcat(self._attitude.axis(q[3:-1], 2) * ca.sum1(f), torque, u[4])

    def output(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Roll, pitch and Euler angle rates beside quaternions, from the last row of R."""
        if self._in_angles:
            return ca.SX(0, 1)
        down = self._attitude.rotation(q[3:-1])[2, :]
        omega, flat = self._attitude.omega(q[3:-1], v[3:6]), down[1] ** 2 + down[2] ** 2
        across = (down[1] * omega[1] + down[2] * omega[2]) / flat
        pitching = (down[2] * omega[1] - down[1] * omega[2]) / ca.sqrt(flat)
        roll, pitch = ca.atan2(down[1], down[2]), ca.atan2(-down[0], ca.sqrt(flat))
        return ca.vertcat(roll, pitch, omega[0] - down[0] * across, pitching, across)

    def tool(self, q: ca.SX) -> ca.SX:
        """Tip of the arm (paper Eq. 7)."""
        return self._along_arm(q, self.parameters.arm_length)

    def nose(self, q: ca.SX) -> ca.SX:
        """Body x axis."""
        return self._attitude.axis(q[3:-1], 0)

    def hover(self) -> Array:
        """Equal motor forces that carry the weight, arm straight down (paper below Eq. 33)."""
        p = self.parameters
        weight = (p.quadrotor_mass + p.arm_mass) * p.gravity
        return np.array([weight / 4] * 4 + [0.0])

    def specific_thrust(self, flown: Array) -> Array:
        """All motors at their limits."""
        p = self.parameters
        return np.full(len(flown), 4 * p.motor_force[1] / (p.quadrotor_mass + p.arm_mass))

    def follow(
        self, time: Array, position: Array, velocity: Array, thrust: Array
    ) -> tuple[Array, Array, Array]:
        """Thrust along the body z axis, nose along x, arm in the middle of its range."""
        from scipy.spatial.transform import Rotation  # a quarter of a second, which only this guess needs

        p, n = self.parameters, len(time)
        size = np.linalg.norm(thrust, axis=1)
        up = (thrust / np.maximum(size, 1e-9)[:, None])[np.minimum(np.arange(n), n - 2)]
        pitch = np.arctan2(up[:, 0], up[:, 2])
        roll = np.arcsin(np.clip(-up[:, 1], -1.0, 1.0))
        turned = np.zeros((n, 3))
        turned[:, :2] = np.clip(np.stack([roll, pitch], axis=1), -p.tilt, p.tilt)
        attitude = self._attitude.follow(Rotation.from_euler("ZYX", turned[:, ::-1]))
        q = np.hstack([position, attitude, np.full((n, 1), np.mean(p.arm_angle))])
        v = np.hstack([velocity, np.gradient(turned, time, axis=0), np.zeros((n, 1))])
        limits, motors = self.velocity, p.motor_force
        force = np.clip(size * (p.quadrotor_mass + p.arm_mass) / 4, *motors)
        u = np.hstack([np.repeat(force[:, None], 4, axis=1), np.zeros((n - 1, 1))])
        return q, np.clip(v, limits.lower, limits.upper), u

    @property
    def airframe(self) -> Airframe:
        """Rotors 1 to 4 stand where paper Eq. 2 has them."""
        p = self.parameters
        lever = np.sqrt(2) / 4 * p.frame
        return Airframe(
            mass=p.quadrotor_mass, arm_mass=p.arm_mass, inertia=np.array(p.quadrotor_inertia),
            arm_inertia=np.array(p.arm_inertia), arm_length=p.arm_length, arm_offset=p.arm_offset,
            rotors=lever * np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]]),
            drag=p.torque_coefficient * np.array([-1.0, -1.0, 1.0, 1.0]), gravity=p.gravity,
            motor_force=p.motor_force, servo_torque=p.servo_torque, speed=p.speed,
        )  # fmt: skip

    def way_from_rest(self, q: Array, time: Array) -> Bounds:
        """Proved in `aerial_manipulator_agility`."""
        upright = self._attitude.plant().rotation(q[3:-1])[2, 2]
        return agility.way(self.parameters, q[-1], float(np.arccos(np.clip(upright, -1.0, 1.0))), time)

    @property
    def level_yaw_acceleration(self) -> float:
        """That of the rotors' drag."""
        return agility.yaw_acceleration(self.parameters)

    def plant(self) -> Plant:
        """Independent Newton-Euler equations."""
        return self._plant

    @cached_property
    def _plant(self) -> Plant:
        """The one plant: it changes nothing in itself, and its tables take a while to make."""
        return AerialManipulatorPlant(self.parameters, self._attitude.plant())

    def _along_arm(self, q: ca.SX, s: float) -> ca.SX:
        alpha = q[-1]
        reach = ca.vertcat(s * ca.cos(alpha), 0, -self.parameters.arm_offset - s * ca.sin(alpha))
        return q[:3] + self._attitude.rotation(q[3:-1]) @ reach


def arm_rotation(alpha: ca.SX) -> ca.SX:
    """Arm to body (paper Eq. 6), (3, 3)."""
    c, s = ca.cos(alpha), ca.sin(alpha)
    return ca.vertcat(ca.horzcat(c, 0, s), ca.horzcat(0, 1, 0), ca.horzcat(-s, 0, c))
