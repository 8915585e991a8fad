"""Robots that are no quadrotor: the examples of docs/your_problem.md, each against a third description of the same machine."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import casadi as ca
import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import benchbench as bb
from benchbench.conformance.checks import models
from benchbench.planning.validate import validate
from benchbench.run import config

ROBOTS = Path(__file__).parents[1] / "examples" / "robots"
RNG = np.random.default_rng(7)

ARM = """<mujoco><option gravity="0 0 0"/><worldbody><body pos="0 0 0.4">
<joint name="shoulder" type="hinge" axis="0 0 1" damping="0.1"/><inertial pos="0.2 0 0" mass="1.5" diaginertia="1e-9 0.02 0.02"/>
<body pos="0.4 0 0"><joint name="elbow" type="hinge" axis="0 0 1" damping="0.05"/>
<inertial pos="0.175 0 0" mass="1.0" diaginertia="1e-9 0.01020833333333333 0.01020833333333333"/>
<site name="tool" pos="0.35 0 0"/></body></body></worldbody></mujoco>"""


@pytest.fixture
def robots(monkeypatch: pytest.MonkeyPatch) -> str:
    """Where Hydra finds the examples, which Python can import."""
    monkeypatch.syspath_prepend(str(ROBOTS))
    return f"hydra.searchpath=[file://{ROBOTS / 'conf'}]"


def engine(text: str, q: Any, v: Any, force: Any) -> tuple[Any, Any]:
    """Acceleration (n,) and the tool's place (3,) by MuJoCo, which has its own equations."""
    body = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(body)
    data.qpos, data.qvel, data.qfrc_applied = q, v, force
    mujoco.mj_forward(body, data)
    return data.qacc.copy(), data.site("tool").xpos.copy()


def test_the_arm_moves_as_mujoco_says(robots: str) -> None:
    model = config.compose(robots, "+scenario=catch").model
    for check in models.CHECKS:
        check(model)
    plant = model.plant()
    for q, v, u in RNG.uniform(-2.0, 2.0, (10, 3, 2)):
        acceleration, place = engine(ARM, q, v, u)
        assert plant.acceleration(q, v, u) == pytest.approx(acceleration, rel=1e-6, abs=1e-6)
        assert plant.tool(q, v)[0] == pytest.approx(place, abs=1e-9)


def test_the_arm_catches_the_ball(robots: str) -> None:
    """Phases find the plan, and complementarity on its one step size one nearly as quick; flown by MuJoCo it catches and rests."""
    runs = [
        bb.plan(robots, "+scenario=catch", "scenario.intervals=30", *more)
        for more in ([], ["relaxation=scholtes"])
    ]
    first, second = (run.travel_time for run in runs)
    assert (
        all(run.certified for run in runs) and first is not None and second == pytest.approx(first, rel=0.03)
    )
    plan = runs[0].plan
    assert plan is not None and plan.coordinate_names == ("shoulder", "elbow")
    body = mujoco.MjModel.from_xml_string(
        ARM.replace("<option", '<option timestep="0.0005" integrator="RK4"')
    )
    data, (begin, _) = mujoco.MjData(body), plan.contacts[0]
    apart = []
    for k in range(plan.intervals):
        steps = round(np.diff(plan.time)[k] / 5e-4)
        body.opt.timestep = np.diff(plan.time)[k] / steps
        if k == 0:
            data.qpos, data.qvel = plan.configuration[0], plan.velocity[0]
        data.qfrc_applied = plan.inputs[k]
        mujoco.mj_step(body, data, steps)
        mujoco.mj_kinematics(body, data)
        apart.append(np.linalg.norm(data.site("tool").xpos - [-0.4 + 0.5 * plan.time[k + 1], 0.5, 0.4]))
    assert apart[begin - 1] < 0.012
    assert data.qpos == pytest.approx([1.8, -1.0], abs=0.02) and np.abs(data.qvel).max() < 0.1


def test_what_an_arm_cannot_do_is_told(robots: str) -> None:
    away = ("scenario.target.start_m=[-3,0.5,0.4]", "scenario.target.velocity_mps=[0.01,0,0]")
    for given, says in (
        (away, "scenario.target: is out of reach: the end effector comes no nearer to it than 2.2"),
        (("scenario.start.elbow=5",), "scenario.start.elbow: 5 rad is outside its limits"),
        (("+scenario.rate_margin.arm=0.1",), "scenario.rate_margin.arm: the vehicle has no such coordinate"),
    ):
        with pytest.raises(bb.BadInput, match=says):
            validate(config.compose(robots, "+scenario=catch", *given))
    with pytest.raises(bb.IncompatibleCase, match="no point mass flies as 'two_link' moves"):
        bb.plan(robots, "+scenario=catch", "guess=point_mass")


CART_POLE = """<mujoco><option gravity="0 0 -9.8066"/><worldbody><body>
<joint name="cart" type="slide" axis="1 0 0" damping="0.1"/><inertial pos="0 0 0" mass="1.0" diaginertia="1 1 1"/>
<body><joint name="pole" type="hinge" axis="0 1 0"/><inertial pos="0 0 0.5" mass="0.3" diaginertia="1e-12 1e-12 1e-12"/>
<site name="tool" pos="0 0 0.5"/></body></body></worldbody></mujoco>"""
HOPPER = """<mujoco><option gravity="0 0 -9.8066"/><worldbody><body>
<joint name="foot" type="slide" axis="0 0 1"/><inertial pos="0 0 0" mass="0.4" diaginertia="1 1 1"/>
<body><joint name="leg" type="slide" axis="0 0 1" damping="2"/><inertial pos="0 0 0" mass="1.0" diaginertia="1 1 1"/>
<site name="tool" pos="0 0 0"/></body></body></worldbody></mujoco>"""


@pytest.mark.parametrize(("scenario", "text"), [("bounce", CART_POLE), ("hop", HOPPER)])
def test_robots_with_contact_move_as_mujoco_says(robots: str, scenario: str, text: str) -> None:
    """Away from contact as MuJoCo says; in it the plant's own force is the one at which the model's pair vanishes."""
    model = config.compose(robots, f"+scenario={scenario}").model
    for check in models.CHECKS:
        check(model)
    symbols = [ca.SX.sym(name, 2) for name in "qvu"]
    lagrange = ca.Function("lagrange", symbols, [bb.acceleration(model, *symbols)])
    plant, states = model.plant(), RNG.uniform(-0.2, 0.2, (20, 4))
    states[:10, 0] = {"bounce": -0.8, "hop": 0.5}[scenario]
    pushed = 0
    for q, v in zip(states[:, :2], 5 * states[:, 2:], strict=True):
        q = q + ([0.3, 0.5] if scenario == "bounce" else [0.0, 0.4])
        u = np.array([3.0, _force(plant, q)])
        pushed += u[1] > 0
        acceleration, place = engine(text, q, v, _generalised(scenario, q, u))
        assert plant.acceleration(q, v, u) == pytest.approx(acceleration, rel=1e-6, abs=1e-6)
        assert lagrange(q, v, u).full().ravel() == pytest.approx(acceleration, rel=1e-6, abs=1e-6)
        assert plant.tool(q, v)[0] == pytest.approx(place, abs=1e-9)
        one, other = (float(x) for x in model.contact(ca.SX(q), ca.SX(v), ca.SX(u)))
        assert min(one, other) == pytest.approx(0.0, abs=1e-9) and max(one, other) > 0
    assert 2 <= pushed <= 10


def _force(plant: Any, q: Any) -> float:
    return float(plant.wall_force(q) if hasattr(plant, "wall_force") else plant.ground_force(q))


def _generalised(scenario: str, q: Any, u: Any) -> list[float]:
    """What motor and contact do along each coordinate."""
    return [u[0] - u[1], -u[1] * 0.5 * np.cos(q[1])] if scenario == "bounce" else [u[1], u[0]]


def test_the_pole_is_caught_with_the_wall(robots: str) -> None:
    """The plan is flown once more, the way from contact to contact found by events; without the wall nothing is found as quick."""
    run = bb.plan(robots, "+scenario=bounce")
    plan = run.plan
    assert run.certified and plan is not None and run.record["n_pairs"] == plan.intervals + 1
    plant, state = run.source.scene()[1].plant(), [*plan.configuration[0], *plan.velocity[0]]
    for a, b in pairwise(plan.time):
        found = solve_ivp(
            lambda t, y: [*y[2:], *plant.acceleration(y[:2], y[2:], plan.input_at(np.array([t]))[0])],
            (a, b),
            state,
            max_step=1e-3,
        )
        state = found.y[:, -1]
    assert state[:2] == pytest.approx([0.0, 0.0], abs=0.02)
    forces = plan.inputs[:, 1]
    assert forces.max() > 15.0 and np.flatnonzero(forces > 0.01).size > 10
    beyond = plan.configuration[:, 0] + 0.5 * np.sin(plan.configuration[:, 1]) - 0.35
    assert forces == pytest.approx(300.0 * np.maximum(beyond, 0.0), abs=1e-3)


def test_the_hopper_leaves_the_ground(robots: str) -> None:
    """Higher than it can stand; in the air nothing pushes, and energy at the take-off is enough for the height."""
    run = bb.plan(robots, "+scenario=hop", "scenario.intervals=40", "strategy=phases")
    plan = run.plan
    assert plan is not None and run.record["claimed_success"]
    foot, leg = plan.configuration.T
    (first, _), air = plan.contacts[0], np.flatnonzero(foot > 0.03)
    assert (
        foot[first] + leg[first] > 0.789
        and leg.max() <= 0.55 + 1e-6
        and np.abs(plan.inputs[air, 1]).max() < 1e-4
    )
    rising = air[(air > 0) & (air < first)][0]
    speed = (
        0.4 * plan.velocity[rising, 0] + 1.0 * plan.velocity[rising].sum()
    ) / 1.4  # of the common centre of mass
    centre = [(0.4 * foot[k] + 1.0 * (foot[k] + leg[k])) / 1.4 for k in (rising, first)]
    assert centre[1] - centre[0] <= speed**2 / (2 * 9.8066) + 2e-3


def test_what_contact_asks_for_is_told(robots: str) -> None:
    for given, says in (
        (
            ("+scenario=bounce", "dynamics=verlet"),
            "dynamics: has no inputs at its nodes, where wall of the vehicle is found",
        ),
        (
            ("+scenario=bounce", "vehicle.stiffness=-1"),
            "vehicle.stiffness: -1 was given; allowed: a number greater than 0",
        ),
        (("+scenario=bounce", "scenario.end.pole=2"), "scenario.end.pole: 2 rad is outside its limits"),
        (("+scenario=bounce", "+scenario.order=free"), "scenario.order: does not exist"),
    ):
        with pytest.raises(bb.BadInput, match=says):
            bb.plan(robots, *given)
