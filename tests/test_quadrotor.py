"""The racing quadrotor against MuJoCo and physics; what keeps its quaternions at length one."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import casadi as ca
import composing
import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from benchbench.ground.arrays import Array
from benchbench.ocp.model import ExplicitModel, ManifoldModel, OutputModel, RacingModel, RampModel
from benchbench.planning.case import Case
from benchbench.run import pipeline
from benchbench_plugins.models.attitude import UnitQuaternion
from benchbench_plugins.models.attitude_space import AttitudeSpace
from benchbench_plugins.models.quadrotor import Quadrotor
from benchbench_plugins.models.quadrotor_plant import QuadrotorPlant

LEVER, YAW = 0.15, 0.05
PLANT = QuadrotorPlant(0.85, (0.001, 0.0012, 0.0017), LEVER, YAW, 9.801)
MJCF = """
<mujoco><option gravity="0 0 -9.801"/><worldbody>
<body name="quad"><freejoint/><inertial pos="0 0 0" mass="0.85" diaginertia="0.001 0.0012 0.0017"/>
  <site name="front_left" pos="{r} {r} 0"/><site name="front_right" pos="{r} -{r} 0"/>
  <site name="rear_right" pos="-{r} -{r} 0"/><site name="rear_left" pos="-{r} {r} 0"/></body></worldbody>
<actuator><general site="front_left" gear="0 0 1 0 0 {c}"/><general site="front_right" gear="0 0 1 0 0 -{c}"/>
  <general site="rear_right" gear="0 0 1 0 0 {c}"/><general site="rear_left" gear="0 0 1 0 0 -{c}"/>
</actuator></mujoco>
"""


def random_states(count: int) -> tuple[Array, Array, Array]:
    draw = np.random.default_rng(0)
    q = np.hstack([draw.uniform(-3, 3, (count, 3)), Rotation.random(count, rng=1).as_quat(scalar_first=True)])
    return q, draw.uniform(-8, 8, (count, 6)), draw.uniform(0, 7, (count, 4))


def test_mujoco_agrees() -> None:
    model = mujoco.MjModel.from_xml_string(MJCF.format(r=LEVER, c=YAW))
    data = mujoco.MjData(model)
    for q, v, u in zip(*random_states(30), strict=True):
        data.qpos[:], data.qvel[:], data.ctrl[:] = q, v, u
        mujoco.mj_forward(model, data)
        np.testing.assert_allclose(PLANT.acceleration(q, v, u), data.qacc, rtol=1e-9, atol=1e-8)
        ahead = data.qpos.copy()
        mujoco.mj_integratePos(model, ahead, data.qvel, 1e-6)
        np.testing.assert_allclose(PLANT.kinematics(q, v), (ahead - q) / 1e-6, atol=2e-5)


def test_a_free_spin_keeps_angular_momentum_and_energy() -> None:
    inertia = np.array([0.001, 0.0012, 0.0017])

    def flow(t: float, y: Array) -> Array:
        return np.concatenate([PLANT.kinematics(y[:7], y[7:]), PLANT.acceleration(y[:7], y[7:], np.zeros(4))])

    start = np.concatenate([np.zeros(3), [1, 0, 0, 0], [0, 0, 3], [4, -2, 5]])
    flight = solve_ivp(flow, (0, 2), start, rtol=1e-11, atol=1e-12, method="DOP853")
    states = flight.y.T
    turn = Rotation.from_quat(states[:, 3:7], scalar_first=True)
    momentum = turn.apply(states[:, 10:] * inertia)
    np.testing.assert_allclose(momentum, np.tile(momentum[0], (len(states), 1)), atol=1e-10)
    spinning = np.sum(states[:, 10:] ** 2 * inertia, axis=1)
    np.testing.assert_allclose(spinning, spinning[0], rtol=1e-9)
    np.testing.assert_allclose(states[:, 2], 3 * flight.t - 9.801 / 2 * flight.t**2, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(states[:, 3:7], axis=1), 1, atol=1e-10)


def race(*overrides: str) -> Case:
    settings = ("scenario.gates=2", "scenario.nodes_per_gate=16", "strategy.margin=0")
    return composing.case_of("+scenario=race", "strategy=phases", *settings, *overrides)


@pytest.mark.parametrize(
    "dynamics",
    [
        "dynamics=rk4",
        "dynamics.form=stages",
        "dynamics=collocation",
        "dynamics=hermite_simpson",
        "dynamics=trapezoidal",
        "dynamics=lie_verlet",
    ],
)
def test_planned_quaternions_have_length_one(dynamics: str) -> None:
    plan = pipeline.run(race(dynamics)).result.plan
    length = np.linalg.norm(plan.configuration[:, 3:], axis=1)
    np.testing.assert_allclose(length, 1, atol=1e-8)
    assert 2.7 < plan.travel_time < 2.9


class Unnormalised(ExplicitModel, ManifoldModel, OutputModel, RacingModel, RampModel):
    """The same vehicle as public planners write it: the thrust grows with the quaternion, which nothing holds."""

    configuration = velocity = inputs = outputs = output = hover = plant = None  # type: ignore[assignment]
    tool = nose = specific_thrust = follow = None  # type: ignore[assignment]
    velocity_bounds = input_bounds = output_bounds = None  # type: ignore[assignment]

    def __init__(self, whole: Quadrotor) -> None:
        self.whole = whole

    def __getattribute__(self, name: str) -> Any:
        own = name in ("whole", "acceleration", "space") or name.startswith("__")
        return super().__getattribute__(name) if own else getattr(self.whole, name)

    def acceleration(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        a = self.whole.acceleration(q, v, u)
        fall = ca.DM([0, 0, -self.whole.gravity])
        return ca.vertcat((a[:3] - fall) * ca.sumsqr(q[3:]) + fall, a[3:])

    @property
    def space(self) -> AttitudeSpace:
        attitude = UnitQuaternion()
        attitude.normalised = lambda a: a  # type: ignore[method-assign]
        return AttitudeSpace(attitude, joints=0, heading_free=True)


COURSE = (
    "+scenario=race",
    "strategy=phases",
    "strategy.margin=0",
    "scenario.gates=5",
    "scenario.end_velocity=rest",
    "vehicle.body_rate=[15,15,2.99]",
)


@cache
def needed() -> float:
    """Seconds on a fine grid."""
    fine = pipeline.run(composing.case_of(*COURSE, "scenario.nodes_per_gate=30"))
    return float(fine.record["travel_time_s"])


def test_coarse_grids_are_exploited_without_normalising() -> None:
    """With growing quaternions a coarse grid is "solved" in far too little time; ours needs what a fine one needs."""
    coarse = composing.case_of(*COURSE, "scenario.nodes_per_gate=10")
    honest = pipeline.run(coarse)
    assert honest.record["travel_time_s"] == pytest.approx(needed(), rel=0.02)
    assert isinstance(coarse.model, Quadrotor)
    exploited = pipeline.run(replace(coarse, model=Unnormalised(coarse.model)))
    assert exploited.record["claimed_success"] and not exploited.certificate.certified
    assert exploited.record["travel_time_s"] < 0.8 * honest.record["travel_time_s"]
    assert exploited.record["replay_drift_position_m"] > 10 * honest.record["replay_drift_position_m"]


@pytest.mark.parametrize(
    ("dynamics", "error_m"),
    [("collocation", 0.2), ("hermite_simpson", 0.5), ("trapezoidal", 10.0), ("lie_verlet", 10.0)],
)
def test_coarse_grids_gain_nothing(dynamics: str, error_m: float) -> None:
    """Ten nodes per gate: unit quaternions, an honest time, a replay that is near for its order (exploits: 44 to 219 m)."""
    done = pipeline.run(composing.case_of(*COURSE, "scenario.nodes_per_gate=10", f"dynamics={dynamics}"))
    length = np.linalg.norm(done.result.plan.configuration[:, 3:], axis=1)
    np.testing.assert_allclose(length, 1, atol=1e-8)
    assert done.record["travel_time_s"] == pytest.approx(needed(), rel=0.04)
    assert done.record["replay_drift_position_m"] < error_m
