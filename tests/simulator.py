"""A quadrotor of its own, flown through gates by a feedback controller: plans that none of our code has made.

Rotation matrices, forces rotor by rotor, SciPy's integrator, thrusts held for each step of the controller (Lee,
Leok & McClamroch 2010, doi:10.1109/CDC.2010.5717652). Also the public planners' CSV.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import make_interp_spline
from scipy.spatial.transform import Rotation

MASS, GRAVITY, LEVER, YAW = 0.85, 9.801, 0.15, 0.05
INERTIA = np.array([0.001, 0.001, 0.0017])
MOST = 6.8794
MIX = np.array(
    [[1, 1, 1, 1], [LEVER, -LEVER, -LEVER, LEVER], [-LEVER, -LEVER, LEVER, LEVER], [YAW, -YAW, YAW, -YAW]]
)
HEADER = "t p_x p_y p_z q_w q_x q_y q_z v_x v_y v_z w_x w_y w_z a_lin_x a_lin_y a_lin_z a_rot_x a_rot_y a_rot_z u_1 u_2 u_3 u_4"
GOOD = ((-5.0, 4.5, 1.2), (-3.0, 3.0, 2.0), (0.0, 2.0, 1.6), (2.0, -1.0, 1.2))
"""Start, two gates, end."""


@dataclass
class Flown:
    """Rows t, p, q (w x y z), v, omega, four thrusts."""

    rows: np.ndarray

    def csv(self, digits: int = 17, last: bool = True) -> str:
        """The public planners' file; `last`: the last row has thrusts, else 0 as the CPC planner writes."""
        a = np.zeros((len(self.rows), 6))
        table = np.hstack([self.rows[:, :14], a, self.rows[:, 14:]])
        if not last:
            table[-1, 20:] = 0.0
        lines = [",".join(f"{x:.{digits}g}" for x in row) for row in table]
        return "\n".join([HEADER.replace(" ", ","), *lines]) + "\n"

    def changed(self, columns: object, rows: object, by: object) -> Flown:
        """The same with something added."""
        new = self.rows.copy()
        new[rows, columns] += by
        return Flown(new)


def fly(
    places: Sequence[Sequence[float]] = GOOD, seconds: float = 1.4, step: float = 0.02, rest: bool = False,
    linear: bool = False, gust: Callable[[float], np.ndarray] | None = None,
) -> Flown:  # fmt: skip
    """Fly along a spline from place to place, `seconds` each, to the end or to rest there.

    linear: thrusts run linearly to what the controller asked for a step ago; gust: thrusts that the file does not tell of.
    """
    knots = seconds * np.arange(len(places))
    still, last = [(1, np.zeros(3)), (2, np.zeros(3))], [(2, np.zeros(3)), (3, np.zeros(3))]
    path = make_interp_spline(knots, np.array(places, float), 5, bc_type=(still, still if rest else last))
    state = np.concatenate([np.array(places[0], float), np.eye(3).ravel(), np.zeros(6)])
    rows = []
    count = round(knots[-1] / step)
    old = np.full(4, MASS * GRAVITY / 4)
    for k in range(count + 1):
        t = k * step
        new = controlled(state, [path(t, nu) for nu in range(4)])
        q = Rotation.from_matrix(state[3:12].reshape(3, 3)).as_quat(scalar_first=True)
        rows.append([t, *state[:3], *(q if q[0] >= 0 else -q), *state[12:], *(old if linear else new)])
        if k < count:
            state = step_on(state, t, t + step, (old if linear else new, new), gust)
            left, _, right = np.linalg.svd(state[3:12].reshape(3, 3))
            state[3:12] = (left @ right).ravel()
        old = new
    return Flown(np.array(rows))


def step_on(
    state: np.ndarray, t: float, end: float, thrusts: tuple[np.ndarray, np.ndarray],
    gust: Callable[[float], np.ndarray] | None,
) -> np.ndarray:  # fmt: skip
    """State at the end of a step, thrusts from the first to the second."""
    first, second = thrusts

    def flow(s: float, y: np.ndarray) -> np.ndarray:
        u = first + (s - t) / (end - t) * (second - first)
        return motion(y, u if gust is None else u + gust(s))

    shortest = (end - t) / 8 if gust else np.inf
    return solve_ivp(flow, (t, end), state, "DOP853", rtol=1e-10, atol=1e-12, max_step=shortest).y[:, -1]


def motion(y: np.ndarray, u: np.ndarray) -> np.ndarray:
    """d/dt of position, rotation matrix, velocity, body rates."""
    turn, v, omega = y[3:12].reshape(3, 3), y[12:15], y[15:]
    force, *torque = MIX @ u
    spin = np.array([[0, -omega[2], omega[1]], [omega[2], 0, -omega[0]], [-omega[1], omega[0], 0]])
    acceleration = turn[:, 2] * force / MASS - [0, 0, GRAVITY]
    return np.concatenate(
        [v, (turn @ spin).ravel(), acceleration, (torque - np.cross(omega, INERTIA * omega)) / INERTIA]
    )


def controlled(y: np.ndarray, wanted: Sequence[np.ndarray]) -> np.ndarray:
    """Thrusts that follow position, velocity, acceleration and jerk, nose along x, within the motors' limits."""
    turn, v, omega = y[3:12].reshape(3, 3), y[12:15], y[15:]
    a = wanted[2] + 9 * (wanted[0] - y[:3]) + 5 * (wanted[1] - v) + [0, 0, GRAVITY]
    up = a / np.linalg.norm(a)
    side = np.cross(up, [1.0, 0, 0])
    side /= np.linalg.norm(side)
    goal = np.column_stack([np.cross(side, up), side, up])
    rate = (wanted[3] - up * (up @ wanted[3])) / np.linalg.norm(a)
    ahead = np.array([-rate @ goal[:, 1], rate @ goal[:, 0], 0.0])
    skew = (goal.T @ turn - turn.T @ goal) / 2
    off = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
    torque = INERTIA * (-250 * off - 28 * (omega - turn.T @ goal @ ahead)) + np.cross(omega, INERTIA * omega)
    return np.clip(np.linalg.solve(MIX, [MASS * (a @ turn[:, 2]), *torque]), 0.0, MOST)
