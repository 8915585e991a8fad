"""Robots that are no quadrotor: the examples of docs/your_problem.md, each against a third description of the same machine."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

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
