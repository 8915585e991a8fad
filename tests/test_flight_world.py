"""The MuJoCo world against our own equations of motion, and its magnet by lifting a ball."""

from __future__ import annotations

import numpy as np
import pytest
from flights import table_one
from flying import FRAME, RIG, same, still
from scipy.linalg import block_diag
from scipy.spatial.transform import Rotation
from test_plant import ANGLES, body_rates, random_states, rotation

from benchbench.flight.world import Actuators
from benchbench.ground.arrays import Array
from benchbench_plugins.models.aerial_manipulator_plant import AerialManipulatorPlant
from benchbench_plugins.worlds.mjcf import Ball
from benchbench_plugins.worlds.mujoco import Mujoco, compiled, place

mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed")
BALL = Ball(radius=0.03, mass=0.075, reach=0.022)
AWAY = np.array([3.0, 3.0, 0.4, 0.0, 0.0, 0.0])


def states(q: Array, v: Array) -> Array:
    turn = Rotation.from_euler("ZYX", q[:, [5, 4, 3]]).as_quat(scalar_first=True)
    return np.hstack([q[:, :3], turn, q[:, 6:], v[:, :3], body_rates(q, v), v[:, 6:]])


def test_mass_matrix_and_free_acceleration_are_those_of_our_model() -> None:
    """With mismatch off; B = blkdiag(R, I, 1) turns x of our plant into MuJoCo's velocities."""
    plant = AerialManipulatorPlant(table_one().parameters)
    model, data = compiled(FRAME, RIG, BALL, same())
    q, v, u = random_states(50)
    q[:, 2] += 2.0  # clear of the ground
    found, mass = np.zeros((50, 7)), np.zeros((model.nv, model.nv))
    for k, state in enumerate(states(q, v)):
        place(data, state, AWAY, BALL.radius)
        data.ctrl[:5] = u[k]
        mujoco.mj_forward(model, data)
        mujoco.mj_fullM(model, data, mass)
        to_body = block_diag(rotation(q[k]).T, np.eye(4))
        ours = to_body.T @ plant.inertia(q[k]) @ to_body
        np.testing.assert_allclose(mass[:7, :7], ours, rtol=0, atol=1e-12)
        found[k] = data.qacc[:7]
    wanted = plant.acceleration(q, v, u)
    spin = (
        ANGLES.body_rates
    )  # d omega/dt by difference of the Euler rates would lose digits: compare through them
    wanted[:, 3:6] = _spin(spin, q, v, wanted)
    np.testing.assert_allclose(found, wanted, rtol=1e-8, atol=1e-8)


def _spin(rates: object, q: Array, v: Array, a: Array) -> Array:
    """E(xi) d2xi/dt2 + dE/dt dxi/dt is d omega/dt; dE/dt by a complex step of our own E."""
    out = np.zeros((len(q), 3))
    for k in range(len(q)):
        h = 1e-30j
        (f, t), (df, dt, dp) = q[k, 3:5] + h * v[k, 3:5], v[k, 3:6]
        e = np.array(
            [
                [1, 0, -np.sin(t)],
                [0, np.cos(f), np.sin(f) * np.cos(t)],
                [0, -np.sin(f), np.cos(f) * np.cos(t)],
            ]
        )
        out[k] = e.real @ a[k, 3:6] + e.imag / 1e-30 @ [df, dt, dp]
    return out


def hanging(clearance: float, height: float = 0.6) -> tuple[Array, Array]:
    """The vehicle with its arm straight down, and the top of a ball so far below its tip."""
    state = np.zeros(15)
    state[[2, 3, 7]] = height, 1.0, np.pi / 2
    return state, np.array([0.0, 0.0, height - FRAME.arm_offset - FRAME.arm_length - clearance])


@pytest.mark.parametrize(
    ("clearance", "lifted"), [(0.016, True), (0.021, True), (0.023, False), (0.03, False)]
)
def test_magnet_lifts_from_within_its_reach_only(clearance: float, lifted: bool) -> None:
    state, target = hanging(clearance)
    reference = still(state, target)
    step = Mujoco().prepare(reference, FRAME, RIG, same())
    for _ in range(100):
        truth = step(Actuators(reference.inputs[0, :4], (np.pi / 2, 0.0, 0.0)))
    assert truth.attached is lifted
    assert truth.touched == ""


def test_ball_rides_on_its_moving_stand() -> None:
    state, _ = hanging(0.1)
    reference = still(state, np.array([1.0, 0.0, 0.3]), 2.0)
    angle = 0.3 * reference.time
    reference.target[:, 0], reference.target[:, 1] = 1 + 0.4 * np.cos(angle), 0.4 * np.sin(angle)
    reference.target[:, 3], reference.target[:, 4] = -0.12 * np.sin(angle), 0.12 * np.cos(angle)
    step = Mujoco().prepare(reference, FRAME, RIG, same())
    for _ in range(900):
        truth = step(Actuators(reference.inputs[0, :4], (np.pi / 2, 0.0, 0.0)))
    row = reference.row(truth.time)
    top = truth.ball[:3] + np.array([0, 0, BALL.radius])
    np.testing.assert_allclose(top, reference.target[row, :3], atol=2e-3)
    np.testing.assert_allclose(truth.ball[3:], reference.target[row, 3:], atol=5e-3)
