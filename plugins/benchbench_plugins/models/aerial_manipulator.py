"""Quadrotor with a one-joint arm (paper Sec. II), as a Lagrangian system in Euler angles.

q = [x y z roll pitch yaw arm], written [p, xi, alpha] in the paper; R = Rz(psi) Ry(theta) Rx(phi) turns
body into world coordinates; u = [f_1 .. f_4, tau_servo].
"""

from __future__ import annotations

from typing import Any, Literal, final

import casadi as ca
import numpy as np
from pydantic import ValidationError

from benchbench.errors import BadInput, invalid
from benchbench.model import Coordinates, Model, Plant, box
from benchbench.plan import Array
from benchbench_plugins.models.aerial_manipulator_parameters import Parameters
from benchbench_plugins.models.aerial_manipulator_plant import AerialManipulatorPlant

NAMES = ("x", "y", "z", "roll", "pitch", "yaw", "arm")
UNITS = ("m", "m", "m", "rad", "rad", "rad", "rad")
INPUTS = ("motor_1", "motor_2", "motor_3", "motor_4", "servo")


@final
class AerialManipulator(Model):
    """Aerial manipulator of the paper.

    force_model "virtual_work": Q_p = R e_3 sum f, Q_xi = E(xi)^T tau_B, Q_alpha = tau_servo. The arm angle
    is relative, so the internal servo torque does no work on the attitude.
    force_model "paper": motor torques act on the Euler angles directly, a named ablation; plans made with
    it are replayed on the correct plant and judged by that.
    """

    def __init__(
        self, name: str, force_model: Literal["virtual_work", "paper"] = "virtual_work", **parameters: Any
    ) -> None:
        """Take the fields of `Parameters` as keywords; raises BadInput that names a wrong field."""
        if force_model not in ("virtual_work", "paper"):
            raise BadInput("vehicle.force_model", f"'{force_model}' does not exist", "virtual_work, paper")
        try:
            self.parameters = Parameters(**parameters)
        except ValidationError as error:
            raise invalid("vehicle", error, Parameters.model_fields) from None
        self.name, self.force_model = name, force_model

    @property
    def configuration(self) -> Coordinates:
        """Position is limited by the scenario's workspace only, yaw not at all."""
        p, far = self.parameters, np.inf
        low, high = p.arm_angle
        return box(
            NAMES, UNITS, [-far] * 3 + [-p.tilt] * 2 + [-far, low], [far] * 3 + [p.tilt] * 2 + [far, high]
        )

    @property
    def velocity(self) -> Coordinates:
        """Limits on world velocity, Euler angle rates and arm rate."""
        p = self.parameters
        most = np.array([*p.speed, *p.angular_rate, p.arm_rate])
        return box(NAMES, tuple(f"{unit}/s" for unit in UNITS), (-most).tolist(), most.tolist())

    @property
    def inputs(self) -> Coordinates:
        """Motor forces and servo torque."""
        (f_low, f_high), (t_low, t_high) = self.parameters.motor_force, self.parameters.servo_torque
        return box(INPUTS, ("N",) * 4 + ("N m",), [f_low] * 4 + [t_low], [f_high] * 4 + [t_high])

    def lagrangian(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """L = K - V of quadrotor and arm (paper Eq. 10-12)."""
        p = self.parameters
        omega = euler_rate_matrix(q) @ v[3:6]
        arm_centre = self._along_arm(q, p.arm_length / 2)
        arm_velocity = ca.jtimes(arm_centre, q, v)
        to_arm = arm_rotation(q[6]).T
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
            torque = euler_rate_matrix(q).T @ torque
        return ca.vertcat(rotation(q)[:, 2] * ca.sum1(f), torque, u[4])

    def tool(self, q: ca.SX) -> ca.SX:
        """Tip of the arm (paper Eq. 7)."""
        return self._along_arm(q, self.parameters.arm_length)

    def nose(self, q: ca.SX) -> ca.SX:
        """Body x axis."""
        return rotation(q)[:, 0]

    def hover(self) -> Array:
        """Equal motor forces that carry the weight, arm straight down (paper below Eq. 33)."""
        p = self.parameters
        weight = (p.quadrotor_mass + p.arm_mass) * p.gravity
        return np.array([weight / 4] * 4 + [0.0])

    def plant(self) -> Plant:
        """Independent Newton-Euler equations."""
        return AerialManipulatorPlant(self.parameters)

    def _along_arm(self, q: ca.SX, s: float) -> ca.SX:
        alpha = q[6]
        reach = ca.vertcat(s * ca.cos(alpha), 0, -self.parameters.arm_offset - s * ca.sin(alpha))
        return q[:3] + rotation(q) @ reach


def rotation(q: ca.SX) -> ca.SX:
    """Body to world, R = Rz(psi) Ry(theta) Rx(phi), (3, 3)."""
    cf, sf, ct, st, cp, sp = (fn(q[i]) for i in (3, 4, 5) for fn in (ca.cos, ca.sin))
    return ca.vertcat(
        ca.horzcat(cp * ct, cp * st * sf - sp * cf, cp * st * cf + sp * sf),
        ca.horzcat(sp * ct, sp * st * sf + cp * cf, sp * st * cf - cp * sf),
        ca.horzcat(-st, ct * sf, ct * cf),
    )


def euler_rate_matrix(q: ca.SX) -> ca.SX:
    """E(xi) with omega_B = E(xi) d xi/dt, the inverse of the paper's T(xi), (3, 3)."""
    cf, sf, ct, st = ca.cos(q[3]), ca.sin(q[3]), ca.cos(q[4]), ca.sin(q[4])
    return ca.vertcat(ca.horzcat(1, 0, -st), ca.horzcat(0, cf, sf * ct), ca.horzcat(0, -sf, cf * ct))


def arm_rotation(alpha: ca.SX) -> ca.SX:
    """Arm to body (paper Eq. 6), (3, 3)."""
    c, s = ca.cos(alpha), ca.sin(alpha)
    return ca.vertcat(ca.horzcat(c, 0, s), ca.horzcat(0, 1, 0), ca.horzcat(-s, 0, c))
