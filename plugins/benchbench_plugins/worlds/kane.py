"""Kane's equations of a free body with a hinged arm and a point mass at its tip, and a step of RK4.

State x (15,) as `benchbench.flight.world.Truth.state`, with speeds nu = [v, omega, arm rate]. For each body, v_i = J_i nu and
omega_i = W_i nu, so that dv_i/dt = J_i dnu/dt + b_i with b_i what the motion alone gives:

    sum J_i^T m_i (J_i dnu/dt + b_i - g) + W_i^T (I_i (W_i dnu/dt + c_i) + omega_i x I_i omega_i) = forces
"""

from __future__ import annotations

import casadi as ca

from benchbench.flight.inertia import rigid
from benchbench.flight.mismatch import Drawn
from benchbench.ocp.airframe import Airframe


def stepper(airframe: Airframe, mismatch: Drawn, step: float) -> ca.Function:
    """Return (x, [thrust, torques, servo], force on the body, force on the tip, mass at the tip) -> x a step later.

    Thrust N and torques N m in the body frame, servo N m, forces N in the world, mass kg.
    """
    x, u = ca.SX.sym("x", 15), ca.SX.sym("u", 5)
    body, tip, mass = ca.SX.sym("body", 3), ca.SX.sym("tip", 3), ca.SX.sym("mass")
    slope = ca.Function("slope", [x, u, body, tip, mass], [_slope(airframe, mismatch, x, u, body, tip, mass)])
    given = (u, body, tip, mass)
    k1 = slope(x, *given)
    k2 = slope(x + step / 2 * k1, *given)
    k3 = slope(x + step / 2 * k2, *given)
    k4 = slope(x + step * k3, *given)
    after = x + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    after[3:7] = after[3:7] / ca.norm_2(after[3:7])
    return ca.Function("step", [x, *given], [after])


def _slope(
    a: Airframe, drawn: Drawn, x: ca.SX, u: ca.SX, body: ca.SX, tip: ca.SX, mass: ca.SX
) -> ca.SX:  # fmt: skip
    q, nu = x[:8], x[8:]
    w, i, j, k = ca.vertsplit(q[3:7])
    turn = ca.vertcat(
        ca.horzcat(1 - 2 * (j * j + k * k), 2 * (i * j - w * k), 2 * (i * k + w * j)),
        ca.horzcat(2 * (i * j + w * k), 1 - 2 * (i * i + k * k), 2 * (j * k - w * i)),
        ca.horzcat(2 * (i * k - w * j), 2 * (j * k + w * i), 1 - 2 * (i * i + j * j)),
    )
    omega, alpha = nu[3:6], q[7]
    spin = ca.vertcat(-i * omega[0] - j * omega[1] - k * omega[2], w * omega[0] + j * omega[2] - k * omega[1],
                      w * omega[1] + k * omega[0] - i * omega[2], w * omega[2] + i * omega[1] - j * omega[0]) / 2  # fmt: skip
    rates = ca.vertcat(nu[:3], spin, nu[6])
    real = rigid if drawn.rigid else (lambda moments: moments)
    along = ca.vertcat(ca.cos(alpha), 0, -ca.sin(alpha))
    mount, gravity = ca.SX([0, 0, -a.arm_offset]), ca.SX([0, 0, -a.gravity])
    to_arm = ca.vertcat(along.T, ca.horzcat(0, 1, 0), ca.horzcat(ca.sin(alpha), 0, ca.cos(alpha)))
    arm_omega = to_arm @ (omega + ca.vertcat(0, nu[6], 0))
    centre = ca.SX([*drawn.centre_of_mass, 0.0])
    places = {"body": centre, "arm": mount + a.arm_length / 2 * along, "tip": mount + a.arm_length * along}
    ways = {name: ca.jtimes(q[:3] + turn @ place, q, rates) for name, place in places.items()}
    masses: dict[str, ca.SX] = {
        "body": ca.SX(a.mass * (1 + drawn.mass)),
        "arm": ca.SX(a.arm_mass),
        "tip": mass,
    }
    forces = {"body": body, "arm": ca.SX.zeros(3), "tip": tip}
    turning = ((omega, real(a.inertia) * (1 + drawn.mass)), (arm_omega, real(a.arm_inertia)))
    whole, right = ca.SX(7, 7), ca.vertcat(turn[:, 2] * u[0], u[1:4], u[4])
    for name, way in ways.items():
        share, drift = ca.jacobian(way, nu), ca.jtimes(way, q, rates)
        whole += masses[name] * share.T @ share
        right += share.T @ (forces[name] + masses[name] * (gravity - drift))
    for spinning, moments in turning:
        share, inertia = ca.jacobian(spinning, nu), ca.diag(ca.SX(moments))
        drift = ca.jtimes(spinning, q, rates)
        whole += share.T @ inertia @ share
        right -= share.T @ (inertia @ drift + ca.cross(spinning, inertia @ spinning))
    return ca.vertcat(rates, ca.solve(whole, right))
