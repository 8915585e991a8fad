"""Independent numeric model of the aerial manipulator: Newton-Euler for two rigid bodies, NumPy only.

Written apart from the Lagrangian that planners use. Everything is in the body frame: omega body rates,
j = [0, 1, 0] the arm's axis, c the arm's centre of mass, c' = dc/d arm, "x" the cross product. With gravity
moved into the acceleration, a = R^T (dv/dt + [0 0 g]), and x = [a, d omega/dt, d2 arm/dt2],

    arm, cut free:  F = m (S x + b),         S = [I, -hat(c), c'],  b = terms of omega and d arm/dt only
                    N = K (W x) + n,         W = [0, I, j],         K inertia, N moment about its centre
    whole vehicle:  S^T F + W^T N + [m_body a, J d omega/dt + omega x J omega, 0] = [thrust, torque, servo]

The three rows are the balances of force, of moment about the body's centre, and of moment about the joint
(c' = j x (centre - mount), so c'.F is the moment of F about the joint). What the servo does to the body is
inside F and N: nothing is added for it.

All of it is of second degree in cos(arm) and sin(arm), and in [omega, d arm/dt]. So the balances, written as above in
`inertia` and `_turning`, are asked at a few arm angles and rates when a plant is made; what a flight asks a million
times are the coefficients found there.
"""

from __future__ import annotations

from typing import final

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ocp.model import Plant
from benchbench_plugins.models.aerial_manipulator_parameters import Parameters
from benchbench_plugins.models.attitude_plant import Angles, AttitudePlant

AXIS, IDENTITY = np.array([0.0, 1.0, 0.0]), np.eye(3)
LEVI_CIVITA = np.cross(IDENTITY[:, None], IDENTITY).transpose(0, 2, 1).reshape(3, 9)
"""a @ LEVI_CIVITA is the matrix of a x, row by row."""
ARM_TURN = np.hstack([np.zeros((3, 3)), IDENTITY, AXIS[:, None]])
"""W: angular acceleration of the arm from x, without velocity terms."""
ROTOR_SIGNS = np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]])
"""Where rotors 1 to 4 stand (x forward, y left); with the drag signs this is the paper's Eq. (2)."""
PAIRS = np.triu_indices(4)
"""Which two of the rates [omega, d arm/dt] are multiplied with one another: each with itself and with those after it."""
DRAG_SIGNS = np.array([-1.0, -1.0, 1.0, 1.0])
ANGLES = Angles()


@final
class AerialManipulatorPlant(Plant):
    """q = [x y z, attitude, arm] (m, rad), v = [world velocity, attitude rates, arm rate], u = [f1 f2 f3 f4 servo].

    Forces in N, the servo's torque in N m. The outputs of a vehicle in quaternions are roll, pitch and Euler rates.
    """

    def __init__(self, parameters: Parameters, attitude: AttitudePlant = ANGLES) -> None:
        """Keep the numbers of the vehicle as arrays."""
        self._attitude = attitude
        p = parameters
        self._mass, self._arm_mass, self._gravity = p.quadrotor_mass, p.arm_mass, p.gravity
        self._mount, self._length = np.array([0.0, 0.0, -p.arm_offset]), p.arm_length
        self._inertia, self._arm_inertia = np.diag(p.quadrotor_inertia), np.diag(p.arm_inertia)
        self._rotors = np.sqrt(2) / 4 * p.frame * ROTOR_SIGNS
        self._body = np.diag([self._mass] * 3 + [*p.quadrotor_inertia, 0.0])
        self._wrench = np.zeros((7, 5))
        self._wrench[2, :4] = 1.0
        self._wrench[3, :4], self._wrench[4, :4] = self._rotors[:, 1], -self._rotors[:, 0]
        self._wrench[5, :4], self._wrench[6, 4] = p.torque_coefficient * DRAG_SIGNS, 1.0
        self._inertia_table, self._turning_table = self._tables()

    def inertia(self, q: Array) -> Array:
        """Return the matrix (..., 7, 7) that multiplies x (see the module) in the balances; q (..., 7)."""
        frame = arm_frame(q)
        shift, arm_inertia = self._shift(frame), frame @ self._arm_inertia @ _transpose(frame)
        arm = self._arm_mass * _transpose(shift) @ shift + ARM_TURN.T @ arm_inertia @ ARM_TURN
        return np.asarray(self._body + arm)

    def acceleration(self, q: Array, v: Array, u: Array) -> Array:
        """Return dv/dt (..., 7) for q (..., 7 or 8), v (..., 7) and u (..., 5)."""
        turning, w, arm = q[..., 3:-1], v[..., 3:6], _harmonics(q[..., -1])
        rates = np.concatenate([self._attitude.body_rates(turning, w), v[..., 6:]], axis=-1)
        products = rates[..., PAIRS[0]] * rates[..., PAIRS[1]]
        both = (products[..., None] * arm[..., None, :]).reshape(*products.shape[:-1], -1)
        right = _apply(self._wrench, u) - both @ self._turning_table
        matrix = (arm @ self._inertia_table).reshape(*arm.shape[:-1], 7, 7)
        x = np.linalg.solve(matrix, right[..., None])[..., 0]
        out = np.empty_like(x)
        out[..., :3] = _apply(self._attitude.rotation(turning), x[..., :3])
        out[..., 2] -= self._gravity
        out[..., 3:6] = self._attitude.accelerations(turning, w, x[..., 3:6])
        out[..., 6] = x[..., 6]
        return out

    def kinematics(self, q: Array, v: Array) -> Array:
        """Return dq/dt."""
        turning = self._attitude.kinematics(q[..., 3:-1], v[..., 3:6])
        out = np.empty((*turning.shape[:-1], turning.shape[-1] + 4))
        out[..., :3], out[..., 3:-1], out[..., -1] = v[..., :3], turning, v[..., 6]
        return out

    def output(self, q: Array, v: Array) -> Array:
        """Return roll, pitch and the rates of roll, pitch, yaw (..., 5), where they are no coordinates."""
        if self._attitude.size == ANGLES.size:
            return np.zeros((*q.shape[:-1], 0))
        turn = self._attitude.rotation(q[..., 3:-1])
        angles = np.zeros((*q.shape[:-1], 3))
        angles[..., 0] = np.arctan2(turn[..., 2, 1], turn[..., 2, 2])
        angles[..., 1] = -np.arcsin(np.clip(turn[..., 2, 0], -1.0, 1.0))
        columns = [ANGLES.body_rates(angles, unit) for unit in IDENTITY]
        omega = self._attitude.body_rates(q[..., 3:-1], v[..., 3:6])
        rates = np.linalg.solve(np.stack(columns, axis=-1), omega[..., None])[..., 0]
        return np.concatenate([angles[..., :2], rates], axis=-1)

    def tool(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Return position (..., 3) m and velocity (..., 3) m/s of the end effector in the world."""
        turn, frame = self._attitude.rotation(q[..., 3:-1]), arm_frame(q)
        tip, swing = self._mount + self._length * frame[..., 0], -self._length * frame[..., 2]
        omega = self._attitude.body_rates(q[..., 3:-1], v[..., 3:6])
        moving = _apply(_hat(omega), tip) + swing * v[..., 6:]
        return q[..., :3] + _apply(turn, tip), v[..., :3] + _apply(turn, moving)

    def nose(self, q: Array) -> Array:
        """Return the body x axis in the world frame, shape (..., 3)."""
        return self._attitude.rotation(q[..., 3:-1])[..., 0]

    def skeleton(self, q: Array) -> dict[str, Array]:
        """Return the lines between opposite rotors and the arm from its mount to its tip, each (2, 3) m; plus the mount."""
        arm = np.stack([self._mount, self._mount + self._length * arm_frame(q)[:, 0]])
        lines = {"frame_a": self._rotors[:2], "frame_b": self._rotors[2:], "arm": arm}
        lines["mount"] = np.stack([np.zeros(3), self._mount])
        turn = self._attitude.rotation(q[3:-1])
        return {name: q[:3] + line @ turn.T for name, line in lines.items()}

    def _shift(self, frame: Array) -> Array:
        """S (..., 3, 7): acceleration of the arm's centre of mass from x, without velocity terms."""
        shift = np.zeros((*frame.shape[:-1], 7))
        shift[..., :3] = IDENTITY
        shift[..., 3:6] = -_hat(self._mount + self._length / 2 * frame[..., 0])
        shift[..., 6] = -self._length / 2 * frame[..., 2]
        return shift

    def _turning(self, frame: Array, rates: Array) -> Array:
        """S^T m b + W^T n + [0, omega x J omega, 0] (..., 7) for rates [omega, d arm/dt] (..., 4): what turning asks for."""
        shift, arm_inertia = self._shift(frame), frame @ self._arm_inertia @ _transpose(frame)
        omega, rate = rates[..., :3], rates[..., 3:]
        from_mount, swing = self._length / 2 * frame[..., 0], shift[..., 6]
        spin, arm_omega = _hat(omega), omega + rate * AXIS
        b = _apply(spin, _apply(spin, self._mount + from_mount) + 2 * rate * swing) - rate**2 * from_mount
        n = _apply(arm_inertia, _apply(spin, rate * AXIS))
        n += _apply(_hat(arm_omega), _apply(arm_inertia, arm_omega))
        out = _apply(_transpose(shift), self._arm_mass * b) + n @ ARM_TURN
        out[..., 3:6] += _apply(spin, _apply(self._inertia, omega))
        return out

    def _tables(self) -> tuple[Array, Array]:
        """Coefficients of the inertia (5, 49) in `_harmonics`, and of `_turning` (50, 7) in products of rates times those."""
        arm: Array = np.linspace(0.0, 2 * np.pi, 5, endpoint=False)
        frame, fit = arm_frame(arm[:, None]), np.linalg.inv(_harmonics(arm))
        alone, of_each = np.eye(4), self._turning
        single = np.stack([of_each(frame, alone[i]) for i in range(4)])
        pairs = np.stack(
            [
                single[i] if i == j else of_each(frame, alone[i] + alone[j]) - single[i] - single[j]
                for i, j in zip(*PAIRS, strict=True)
            ]
        )
        return _exact(fit @ self.inertia(arm[:, None]).reshape(5, 49)), _exact((fit @ pairs).reshape(50, 7))


def _exact(table: Array) -> Array:
    """The table with zeros where rounding left something else: what is symmetric stays so in flight."""
    return np.where(np.abs(table) < 1e-13 * np.abs(table).max(), 0.0, table)


def arm_frame(q: Array) -> Array:
    """Return R_m(arm) (..., 3, 3), arm to body frame; column 0 points along the arm (paper Eq. 4)."""
    c, s = np.cos(q[..., -1]), np.sin(q[..., -1])
    frame = np.zeros((*c.shape, 3, 3))
    frame[..., 0, 0], frame[..., 0, 2], frame[..., 1, 1] = c, s, 1.0
    frame[..., 2, 0], frame[..., 2, 2] = -s, c
    return frame


def _harmonics(arm: Array) -> Array:
    """1, cos, sin, cos 2 and sin 2 (..., 5) of the arm's angle (...): all of second degree in cos and sin."""
    c, s = np.cos(arm), np.sin(arm)
    out = np.empty((*np.shape(arm), 5))
    out[..., 0], out[..., 1], out[..., 2] = 1.0, c, s
    out[..., 3], out[..., 4] = c * c - s * s, 2 * c * s
    return out


def _hat(a: Array) -> Array:
    """Matrix (..., 3, 3) with hat(a) b = a x b."""
    return np.asarray((a @ LEVI_CIVITA).reshape(*a.shape, 3))


def _apply(matrix: Array, vector: Array) -> Array:
    return np.asarray((matrix @ vector[..., None])[..., 0])


def _transpose(matrix: Array) -> Array:
    return np.swapaxes(matrix, -1, -2)
