"""The examples of docs/your_problem.md do what the page says."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from packages import install_example
from program import told

import benchbench as bb
from benchbench.ground.arrays import Array

EXAMPLES = Path(__file__).parents[1] / "examples"


def own(monkeypatch: pytest.MonkeyPatch, example: str) -> str:
    """Make the folder of an example one that Python and Hydra look into."""
    monkeypatch.syspath_prepend(str(EXAMPLES / example))
    return f"hydra.searchpath=[file://{EXAMPLES / example / 'conf'}]"


def test_a_sphere_is_flown_around(monkeypatch: pytest.MonkeyPatch) -> None:
    """By its replay, not by our own condition; without the sphere it would be flown through."""
    sphere = own(monkeypatch, "obstacle")
    run, without = bb.plan(sphere, "+scenario=around"), bb.plan("+scenario=static")
    _, _, replay = run.source.scene()
    assert run.certified and without.certified and replay is not None and without.plan is not None
    centre, radius = (1.8, 0.02, 0.62), 0.35
    away, through = (
        float(np.linalg.norm(flown.configuration[:, :3] - centre, axis=1).min())
        for flown in (replay, without.plan)
    )
    assert away > radius - 0.01 and through < 0.5 * radius
    assert run.travel_time is not None and without.travel_time is not None
    assert run.travel_time > without.travel_time


def test_a_box_is_flown_over_and_a_zone_around(monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither asks for less at its corners or rim, and both are in the way."""
    obstacle = own(monkeypatch, "obstacle")
    for name, without, outside in (
        ("over", "scenario.intervals=25", _out_of_the_box),
        ("race_zone", "", _off_the_zone),
    ):
        given = [obstacle, f"+scenario={name}", *filter(None, [without])]
        free = "scenario.obstacles.box=null" if name == "over" else "scenario.obstacles.zone=null"
        run, through = bb.plan(*given), bb.plan(*given, free)
        _, _, replay = run.source.scene()
        assert run.certified and through.certified and replay is not None and through.plan is not None
        assert outside(replay.configuration[:, :3]).min() > -0.01
        assert outside(through.plan.configuration[:, :3]).min() < -0.1
        assert run.travel_time is not None and through.travel_time is not None
        assert run.travel_time > through.travel_time


def _out_of_the_box(place: Array) -> Array:
    """Metres beyond the nearest of the planes that the scenario's box is made of; below zero inside."""
    low, high = np.array([1.55, -0.6, 0.1]), np.array([2.05, 0.6, 0.7])
    return np.asarray(np.max(np.maximum(low - place, place - high), axis=1))


def _off_the_zone(place: Array) -> Array:
    return np.asarray(np.abs(place[:, 0] - 2.0 + 1j * (place[:, 1] + 1.2)) - 1.0)


def test_own_costs_count(monkeypatch: pytest.MonkeyPatch) -> None:
    """They are paid for with travel time, and the objective adds up from the plan's own table."""
    cost = own(monkeypatch, "cost")
    run, without = (bb.plan(cost, "+scenario=low", "scenario.intervals=60", *free) for free in ([], [
        "scenario.costs.height=null", "scenario.costs.effort=null"]))  # fmt: skip
    assert run.certified and without.certified and run.plan is not None and without.plan is not None
    assert without.record["costs"] is None and run.record["travel_time_s"] > without.record["travel_time_s"]
    assert _tip(run.plan).mean() < _tip(without.plan).mean() - 0.02
    plan, costs = run.plan, run.record["costs"]
    hover = np.array([(1.659 + 0.36) * 9.8066 / 4] * 4 + [0.0])
    squares = np.diff(plan.time) @ np.stack([plan.inputs**2, (plan.inputs - hover) ** 2], axis=2).sum(axis=1)
    height = np.trapezoid(_tip(plan) ** 2, plan.time)
    assert costs == {
        "height": pytest.approx(height, rel=0.02),
        "effort": pytest.approx(1e-3 * squares[0], rel=1e-9),
    }
    total = plan.travel_time + 3e-3 * squares[1] + sum(costs.values())
    assert run.record["objective"] == pytest.approx(total, rel=0.01)


def _tip(plan: bb.Plan) -> Array:
    """Height of the end effector at the nodes, m; the plan stays in the x-z plane."""
    z, pitch, arm = (
        plan.configuration[:, plan.coordinate_names.index(name)] for name in ("z", "pitch", "arm")
    )
    return np.asarray(z - 0.05 * np.cos(pitch) - 0.182 * np.sin(arm + pitch))


def test_a_cost_that_two_count_differently_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """The planner pays half of what the certificate counts."""
    cost = own(monkeypatch, "cost")
    from effort import Effort

    counted = Effort.spent
    monkeypatch.setattr(Effort, "spent", lambda *given: 2 * counted(*given))
    run = bb.plan(cost, "+scenario=low", "scenario.intervals=25", "strategy=phases")
    (reason,) = (said for said in run.record["reasons"] if "objective" in said)
    assert not run.certified and "counted again on the replay" in reason


def test_bad_obstacles_and_costs(monkeypatch: pytest.MonkeyPatch) -> None:
    from benchbench.planning.validate import validate
    from benchbench.run import config

    obstacle, cost = own(monkeypatch, "obstacle"), own(monkeypatch, "cost")
    held = "{_target_: benchbench_plugins.contacts.position.Position, limit: 0.02}"
    for given, field in (
        (
            (obstacle, "+scenario=around", "scenario.obstacles.sphere.centre=[0,0,0.65]"),
            "scenario.obstacles.sphere",
        ),
        (
            (obstacle, "+scenario=over", "scenario.obstacles.box.half=[0,1,1]"),
            "scenario.obstacles.box.half.0",
        ),
        (("+scenario=static", f"+scenario.obstacles.p={held}"), "scenario.obstacles.p"),
        ((cost, "+scenario=low", "scenario.costs.effort.weight=-1"), "scenario.costs.effort.weight"),
        (("+scenario=static", f"+scenario.costs.p={held}"), "scenario.costs.p"),
    ):
        with pytest.raises(bb.BadInput) as told_:
            validate(config.compose(*given))
        assert told_.value.field == field


def test_a_sphere_is_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    from benchbench.report.scene import standing_lines
    from benchbench.run import config

    case = config.compose(own(monkeypatch, "obstacle"), "+scenario=around")
    (line,) = standing_lines(case.scenario.obstacles.items()).values()
    distance = np.linalg.norm(line - (1.8, 0.02, 0.62), axis=1)
    assert distance[~np.isnan(distance)] == pytest.approx(0.35)


def test_the_block_obeys_friction_and_wall(tmp_path: Path) -> None:
    """Its push is applied step by step to a block that knows nothing of complementarity."""
    folder = EXAMPLES / "block_and_wall"
    done = told(tmp_path, "--config-dir", str(folder / "conf"), "+scenario=block_and_wall", "relaxation=scholtes",
                "hydra.run.dir=out", PYTHONPATH=str(folder))  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    w = np.ravel(json.loads((tmp_path / "out" / "solution.json").read_text())["w"])
    x, v, u, wall = w.reshape(7, 20)[:4]
    h, place, speed = 0.1, 0.0, 0.0
    for k in range(20):
        free = speed + h * u[k]
        slowed = np.sign(free) * max(abs(free) - h * 2.0, 0.0)
        speed = min(slowed, (1.0 - place) / h)
        place += h * speed
        assert (place, speed) == (pytest.approx(x[k], abs=1e-5), pytest.approx(v[k], abs=1e-5))
    assert place == pytest.approx(1.0, abs=1e-6) and wall[-1] >= 3.0 - 1e-6
    # In the last step, at rest, friction may point either way: least effort takes all of it to press the wall.
    assert wall[-1] - (v[-2] / h + u[-1]) == pytest.approx(2.0, abs=1e-4)


def test_runs_with_own_parts_are_read_again_where_these_are_installed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Results are data: what they name has to be installed, an obstacle and a cost as well as a robot."""
    own(monkeypatch, "obstacle")
    cost = own(monkeypatch, "cost")
    run = bb.plan(cost, "+scenario=low", "scenario.intervals=25", "strategy=phases", f"output={tmp_path}",
                  "+scenario.obstacles.sphere={_target_: sphere.Sphere, centre: [1.8, 0.5, 0.6], radius: 0.3}")  # fmt: skip
    folder = run.save(tmp_path / "kept")
    with pytest.raises(bb.BadInput, match=r"height\.Height.*no installed plugin"):
        bb.load(folder).source.scene()
    for name in ("obstacle", "cost"):
        install_example(EXAMPLES / name, tmp_path / "site")
    monkeypatch.syspath_prepend(str(tmp_path / "site"))
    scenario, _, replay = bb.load(folder).source.scene()
    assert (list(scenario.obstacles), list(scenario.costs)) == (
        ["sphere"],
        ["height", "effort"],
    ) and replay is not None
