"""A plan as people who fly want it: the motion of a body with four motors, and of its arm, free of any model.

Body rates are Rz(yaw) Ry(pitch) Rx(roll) read backwards: omega = E(xi) d xi/dt, E = [[1, 0, -sin theta],
[0, cos phi, sin phi cos theta], [0, -sin phi, cos phi cos theta]].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.ocp.model import Model
from benchbench.ocp.plan import Interpolation, Plan

POSITION, QUATERNION = ("x", "y", "z"), ("qw", "qx", "qy", "qz")
ANGLES, RATES = ("roll", "pitch", "yaw"), ("wx", "wy", "wz")
MOTORS = ("motor_1", "motor_2", "motor_3", "motor_4")
ARM, SERVO = "arm", "servo"
STEEP = 1 - 1e-9
"""Sine of a pitch at which Euler angles have no rates: 90 degrees but 3e-3."""


@dataclass(frozen=True)
class MultirotorTrajectory:
    """States and inputs at n times; motors are numbered as the vehicle's inputs.

    time         (n,) s
    position     (n, 3) m, world
    quaternion   (n, 4) w, x, y, z of the rotation from body to world, without jumps of sign
    velocity     (n, 3) m/s, world
    body_rates   (n, 3) rad/s, about the body axes
    thrusts      (n, 4) N; where the plan holds inputs, row k acts until the next and the last row repeats
    arm          (n, 3) rad, rad/s, N m: angle, rate, servo torque; None for a vehicle without arm
    progress     (n,) progress index of the plan, by which it claims contact; None where it claims none, or at several stops
    """

    time: Array
    position: Array
    quaternion: Array
    velocity: Array
    body_rates: Array
    thrusts: Array
    arm: Array | None = None
    progress: Array | None = None


def trajectory_of(plan: Plan) -> MultirotorTrajectory:
    """Read a plan by the names of its columns. Raises BadInput for a vehicle that is not of this kind."""
    q, v = (
        dict(zip(names, values.T, strict=True))
        for names, values in (
            (plan.coordinate_names, plan.configuration), (plan.velocity_names, plan.velocity)
        )
    )  # fmt: skip
    u = dict(zip(plan.input_names, plan.input_at(plan.time).T, strict=True))
    missing = [name for name in (*POSITION, *MOTORS) if name not in q | u]
    if missing:
        raise BadInput("plan", f"has no {', '.join(missing)}", "a plan of a vehicle with four motors")
    position, turn = vehicle_pose(plan.coordinate_names, plan.configuration)
    scalar_first = turn[:, [3, 0, 1, 2]]
    speeds = ("vx", "vy", "vz") if "vx" in v else POSITION
    rates = _columns(v, RATES) if "wx" in v else body_rates(_columns(q, ANGLES), _columns(v, ANGLES))
    arm = np.stack([q[ARM], v[ARM], u[SERVO]], axis=-1) if ARM in q and SERVO in u else None
    progress = plan.progress if plan.progress.ndim == 1 and np.any(plan.progress > 0) else None
    return MultirotorTrajectory(
        time=plan.time, position=position, quaternion=continuous(scalar_first), velocity=_columns(v, speeds),
        body_rates=rates, thrusts=_columns(u, MOTORS), arm=arm, progress=progress,
    )  # fmt: skip


def plan_of(flight: MultirotorTrajectory, model: Model, interpolation: Interpolation) -> Plan:
    """Return the flight as a plan of a model; "hold" leaves out the last row of inputs, "linear" keeps it.

    Raises BadInput for a model with coordinates or inputs that a flight does not know, or with Euler angles for an
    attitude that they cannot describe.
    """
    angles = np.zeros((len(flight.time), 3))
    if ANGLES[0] in model.configuration.names:
        angles = _angles(flight)
    arm = np.zeros((len(flight.time), 3)) if flight.arm is None else flight.arm
    q = dict(zip((*POSITION, *QUATERNION), np.hstack([flight.position, flight.quaternion]).T, strict=True))
    q |= dict(zip((*ANGLES, ARM), [*angles.T, arm[:, 0]], strict=True))
    rates = [*flight.body_rates.T, *euler_rates(angles, flight.body_rates).T, arm[:, 1]]
    v = dict(zip(("vx", "vy", "vz"), flight.velocity.T, strict=True))
    v |= dict(zip((*POSITION, *RATES, *ANGLES, ARM), [*flight.velocity.T, *rates], strict=True))
    u = dict(zip((*MOTORS, SERVO), [*flight.thrusts.T, arm[:, 2]], strict=True))
    c, w, i = model.configuration, model.velocity, model.inputs
    wanted = [(c.names, q), (w.names, v), (i.names, u)]
    unknown = [name for names, known in wanted for name in names if name not in known]
    if unknown or (flight.arm is None and ARM in c.names):
        problem = f"'{model.name}' has {', '.join(unknown) or ARM}, which the flight has not"
        allowed = "the vehicle of the flight, or a flight with the columns of docs/foreign_plans.md"
        raise BadInput("vehicle", problem, allowed)
    inputs = _columns(u, i.names)
    progress = np.full(len(flight.time), np.nan) if flight.progress is None else flight.progress
    return Plan.of(
        model, time=flight.time, configuration=_columns(q, c.names),
        velocity=_columns(v, w.names), inputs=inputs[:-1] if interpolation == "hold" else inputs,
        progress=progress, interpolation=interpolation,
    )  # fmt: skip


def continuous(quaternion: Array) -> Array:
    """Give quaternions (n, 4) the signs with which none jumps from one to the next; the first w is not below 0."""
    same = np.sum(quaternion[1:] * quaternion[:-1], axis=1) >= 0
    return np.asarray(quaternion * np.cumprod(np.where([quaternion[0, 0] >= 0, *same], 1.0, -1.0))[:, None])


def vehicle_pose(names: tuple[str, ...], q: Array) -> tuple[Array, Array]:
    """Position (n, 3) m and unit quaternion (n, 4) x, y, z, w from coordinates q (n, n_q) by name.

    Reads x, y, z and either the quaternion qw, qx, qy, qz or the angles roll, pitch, yaw of
    R = Rz(yaw) Ry(pitch) Rx(roll); what a model does not have is 0.
    """
    column = {name: q[:, i] for i, name in enumerate(names)}
    none = np.zeros(len(q))
    position = np.stack([column.get(axis, none) for axis in ("x", "y", "z")], axis=-1)
    if "qw" in column:
        turn = np.stack([column[name] for name in ("qx", "qy", "qz", "qw")], axis=-1)
        return position, turn / np.linalg.norm(turn, axis=-1, keepdims=True)
    half = [column.get(angle, none) / 2 for angle in ("roll", "pitch", "yaw")]
    (cr, cp, cy), (sr, sp, sy) = np.cos(half), np.sin(half)
    quaternion = [
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    ]
    return position, np.stack(quaternion, axis=-1)


def body_rates(angles: Array, rates: Array) -> Array:
    """Body rates (n, 3) from roll, pitch, yaw (n, 3) rad and their rates (n, 3) rad/s."""
    return np.einsum("nij,nj->ni", _euler_rate_matrices(angles), rates)


def euler_rates(angles: Array, omega: Array) -> Array:
    """Rates (n, 3) of roll, pitch, yaw from body rates (n, 3); the inverse of `body_rates`."""
    return np.asarray(np.linalg.solve(_euler_rate_matrices(angles), omega[..., None])[..., 0])


def _angles(flight: MultirotorTrajectory) -> Array:
    """Roll, pitch, yaw (n, 3) without jumps of a turn."""
    from scipy.spatial.transform import Rotation  # a quarter of a second, which a recording need not take

    w, x, y, z = flight.quaternion.T
    if (steep := np.abs(2 * (w * y - x * z)) > STEEP).any():
        when = f"the attitude at t={flight.time[int(np.argmax(steep))]:.6g} s has a pitch of 90 degrees"
        raise BadInput("plan", when, "pitch that Euler angles can describe, or a vehicle in quaternions")
    angles = Rotation.from_quat(flight.quaternion, scalar_first=True).as_euler("ZYX")[:, ::-1]
    return np.asarray(np.unwrap(angles, axis=0))


def _euler_rate_matrices(angles: Array) -> Array:
    (cr, cp, _), (sr, sp, _) = np.cos(angles).T, np.sin(angles).T
    one, none = np.ones(len(angles)), np.zeros(len(angles))
    rows = [[one, none, -sp], [none, cr, sr * cp], [none, -sr, cr * cp]]
    return np.moveaxis(np.array(rows), -1, 0)


def _columns(by_name: dict[str, Array], names: tuple[str, ...]) -> Array:
    missing = [name for name in names if name not in by_name]
    if missing:
        raise BadInput("plan", f"has no {', '.join(missing)}", "a plan of a vehicle with four motors")
    return np.stack([by_name[name] for name in names], axis=-1)
