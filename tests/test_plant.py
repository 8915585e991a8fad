"""The Newton-Euler plant against MuJoCo, energy conservation and the planner's Lagrangian."""

from __future__ import annotations

import math

import casadi as ca
import mujoco
import numpy as np
import pytest
from flights import TABLE_I, table_one
from scipy.integrate import solve_ivp
from scipy.linalg import block_diag
from scipy.spatial.transform import Rotation

from benchbench.ground.arrays import Array
from benchbench.ocp.mechanics import acceleration
from benchbench_plugins.models.aerial_manipulator import AerialManipulator
from benchbench_plugins.models.aerial_manipulator_plant import AerialManipulatorPlant
from benchbench_plugins.models.attitude_plant import Angles

ANGLES = Angles()
PHYSICAL = TABLE_I | {"quadrotor_inertia": (0.0348, 0.0459, 0.0717), "arm_inertia": (0.0007, 0.0019, 0.0015)}
MJCF = """
<mujoco><option gravity="0 0 -9.8066"/><compiler angle="radian" balanceinertia="false"/><worldbody>
<body name="quad"><freejoint/><inertial pos="0 0 0" mass="1.659" diaginertia="0.0348 0.0459 0.0717"/>
  <site name="m1" pos=" {r} -{r} 0"/><site name="m2" pos="-{r}  {r} 0"/>
  <site name="m3" pos=" {r}  {r} 0"/><site name="m4" pos="-{r} -{r} 0"/>
  <body name="arm" pos="0 0 -0.05"><joint name="servo" type="hinge" axis="0 1 0"/>
    <inertial pos="0.091 0 0" mass="0.36" diaginertia="0.0007 0.0019 0.0015"/>
    <site name="tip" pos="0.182 0 0"/></body></body></worldbody>
<actuator><general site="m1" gear="0 0 1 0 0 -0.013"/><general site="m2" gear="0 0 1 0 0 -0.013"/>
  <general site="m3" gear="0 0 1 0 0 0.013"/><general site="m4" gear="0 0 1 0 0 0.013"/>
  <general joint="servo" gear="1"/></actuator></mujoco>
"""


def random_states(count: int, seed: int = 0) -> tuple[Array, Array, Array]:
    draw = np.random.default_rng(seed)
    q = draw.uniform([-2, -2, 0, -1, -1, -3, 0.2], [2, 2, 2, 1, 1, 3, 2.9], (count, 7))
    u = draw.uniform([0, 0, 0, 0, -2], [8, 8, 8, 8, 2], (count, 5))
    return q, draw.uniform(-3, 3, (count, 7)), u


def rotation(q: Array) -> Array:
    return ANGLES.rotation(q[..., 3:6])


def body_rates(q: Array, v: Array) -> Array:
    return ANGLES.body_rates(q[..., 3:6], v[..., 3:6])


def engine(q: Array, v: Array, u: Array) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """MuJoCo with the same bodies at the same state; attitude through SciPy, not through our rotation()."""
    m = mujoco.MjModel.from_xml_string(MJCF.format(r=math.sqrt(2) / 4 * 0.33))
    d = mujoco.MjData(m)
    turn = Rotation.from_euler("ZYX", q[[5, 4, 3]])
    d.qpos[:] = [*q[:3], *turn.as_quat(scalar_first=True), q[6]]
    d.qvel[:] = [*v[:3], *body_rates(q, v), v[6]]
    d.ctrl[:] = u
    mujoco.mj_forward(m, d)
    return m, d


@pytest.fixture(scope="module")
def plant() -> AerialManipulatorPlant:
    return AerialManipulator("physical", **PHYSICAL).plant()


def test_body_rates_are_the_rotation_rate() -> None:
    def turn(q: Array) -> Array:
        return Rotation.from_euler("ZYX", q[[5, 4, 3]]).as_matrix()

    for q, v, _ in zip(*random_states(20), strict=True):
        turns = [turn(q + s * v) for s in (-2e-3, -1e-3, 1e-3, 2e-3)]
        slope = (turns[0] - 8 * turns[1] + 8 * turns[2] - turns[3]) / 12e-3
        np.testing.assert_allclose(rotation(q), turn(q), atol=1e-14)
        wheel = rotation(q).T @ slope
        np.testing.assert_allclose(body_rates(q, v), [wheel[2, 1], wheel[0, 2], wheel[1, 0]], atol=1e-9)


def test_inertia_equals_mujoco(plant: AerialManipulatorPlant) -> None:
    for q, v, u in zip(*random_states(20), strict=True):
        m, d = engine(q, v, u)
        theirs = np.zeros((7, 7))
        mujoco.mj_fullM(m, d, theirs)
        to_world = block_diag(rotation(q), np.eye(4))
        np.testing.assert_allclose(to_world @ plant.inertia(q) @ to_world.T, theirs, rtol=0, atol=1e-12)


def test_forced_acceleration_equals_mujoco(plant: AerialManipulatorPlant) -> None:
    for q, v, u in zip(*random_states(20), strict=True):
        _, d = engine(q, v, u)
        ours = plant.acceleration(q, v, u)
        rates = [body_rates(q + s * v + s * s / 2 * ours, v + s * ours) for s in (-2e-4, -1e-4, 1e-4, 2e-4)]
        spin = (rates[0] - 8 * rates[1] + 8 * rates[2] - rates[3]) / 12e-4
        np.testing.assert_allclose([*ours[:3], *spin, ours[6]], d.qacc, rtol=1e-8, atol=1e-8)


def test_tool_equals_mujoco(plant: AerialManipulatorPlant) -> None:
    for q, v, u in zip(*random_states(20), strict=True):
        m, d = engine(q, v, u)
        jacobian = np.zeros((3, 7))
        mujoco.mj_jacSite(m, d, jacobian, None, 4)
        position, velocity = plant.tool(q, v)
        np.testing.assert_allclose(position, d.site_xpos[4], atol=1e-12)
        np.testing.assert_allclose(velocity, jacobian @ d.qvel, atol=1e-12)
        lines = plant.skeleton(q)
        np.testing.assert_allclose(lines["arm"][1], position, atol=1e-12)
        rotors = np.concatenate([lines["frame_a"], lines["frame_b"]])
        np.testing.assert_allclose(rotors, d.site_xpos[:4], atol=1e-12)


@pytest.mark.parametrize("parameters", [TABLE_I, PHYSICAL], ids=["table_I", "physical"])
def test_equals_the_lagrangian(parameters: dict[str, object]) -> None:
    model = AerialManipulator("any", **parameters)
    q, v, u = (ca.SX.sym(name, n) for name, n in (("q", 7), ("v", 7), ("u", 5)))
    planner = ca.Function("a", [q, v, u], [acceleration(model, q, v, u)])
    states = random_states(20, seed=1)
    theirs = [np.asarray(planner(*state)).ravel() for state in zip(*states, strict=True)]
    np.testing.assert_allclose(model.plant().acceleration(*states), theirs, rtol=1e-9, atol=1e-9)


def test_a_batch_equals_a_loop(plant: AerialManipulatorPlant) -> None:
    q, v, u = random_states(6)
    one_by_one = np.array([plant.acceleration(*state) for state in zip(q, v, u, strict=True)])
    np.testing.assert_allclose(plant.acceleration(q, v, u), one_by_one, rtol=1e-13, atol=1e-13)
    folded = plant.acceleration(q.reshape(2, 3, 7), v.reshape(2, 3, 7), u.reshape(2, 3, 5))
    np.testing.assert_allclose(folded.reshape(6, 7), one_by_one, rtol=1e-13, atol=1e-13)


def test_energy_is_conserved_without_inputs(plant: AerialManipulatorPlant) -> None:
    def energy(state: Array) -> float:
        q, v = state[:7], state[7:]
        twist = np.concatenate([rotation(q).T @ v[:3], body_rates(q, v), v[6:]])
        arm_height = plant.skeleton(q)["arm"][:, 2].mean()
        return float(twist @ plant.inertia(q) @ twist / 2 + 9.8066 * (1.659 * q[2] + 0.36 * arm_height))

    start = np.array([0, 0, 1, 0.2, -0.1, 0.3, 1.2, 0.5, -0.2, 0.1, 0.4, 0.6, -0.8, 3.0])
    fall = solve_ivp(
        lambda t, y: np.concatenate([y[7:], plant.acceleration(y[:7], y[7:], np.zeros(5))]),
        (0, 0.8), start, method="DOP853", rtol=1e-12, atol=1e-12,
    )  # fmt: skip
    assert np.ptp(fall.y[6]) > 0.5
    energies = [energy(state) for state in fall.y.T]
    np.testing.assert_allclose(energies, energies[0], rtol=1e-10)


def test_hover_stays(plant: AerialManipulatorPlant) -> None:
    model = table_one()
    q = np.array([0, 0, 0.65, 0, 0, 0, math.pi / 2])
    np.testing.assert_allclose(model.plant().acceleration(q, 0 * q, model.hover()), 0, atol=1e-13)
