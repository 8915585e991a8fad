"""Races: what is planned, what the certificate accepts, and what it does not."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import composing
import numpy as np
import pytest
from flights import Bare
from PIL import Image
from scipy.integrate import solve_ivp

from benchbench.certificate.certificate import Certificate
from benchbench.certificate.certify import certify
from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.gates import passes
from benchbench.ocp.plan import Plan
from benchbench.ocp.track import Gate
from benchbench.planning.race_start import point_mass_plan
from benchbench.run import pipeline
from benchbench.storage.playback import read_mcap
from benchbench.storage.recording import write_mcap


@cache
def run(*overrides: str) -> pipeline.Run:
    return pipeline.run(composing.case_of("+scenario=race", *overrides))


def good() -> pipeline.Run:
    return run("scenario.gates=2", "scenario.nodes_per_gate=20")


@pytest.mark.parametrize(
    ("gates", "vehicle", "seconds"),
    [
        (1, "race_quadrotor", 1.2468),
        (2, "race_quadrotor", 2.7746),
        (1, "race_ramp", 1.8608),
        (2, "race_ramp", 3.6436),
    ],
)
def test_travel_times_of_an_independent_prototype(gates: int, vehicle: str, seconds: float) -> None:
    """RK4, 40 nodes per gate; the prototype's ramp of the body rates lags by one node."""
    done = run(f"scenario.gates={gates}", f"vehicle={vehicle}")
    assert done.certificate.certified, done.certificate.reasons
    assert done.record["travel_time_s"] == pytest.approx(seconds, abs=4e-4)
    assert done.record["gates_passed"] == gates
    assert done.record["replay_drift_position_m"] < 1e-3
    assert done.record["lower_bound_s"] < seconds
    assert done.record["kappa_init"] is None


def test_straight_up_takes_what_constant_thrust_takes() -> None:
    """Everything at its limit: s = a t^2 / 2 to the lower edge of the end, for the point mass and the quadrotor."""
    track = [
        "scenario.start={x: 0, y: 0, z: 1}",
        "scenario.end={x: 0, y: 0, z: 21}",
        "scenario.track=[[0, 0, 11]]",
        "scenario.gates=1",
    ]
    done = run(*track)
    exact = math.sqrt(2 * (20 - 0.3) / (4 * 6.8794 / 0.85 - 9.801))
    assert done.record["travel_time_s"] == pytest.approx(exact, rel=1e-6)
    case = composing.case_of("+scenario=race", *track)
    assert point_mass_plan(case.scenario, case, Ledger(60.0)).travel_time == pytest.approx(exact, rel=1e-6)


def test_the_replay_is_what_an_independent_integrator_flies() -> None:
    done = good()
    plan, flight = done.result.plan, done.certificate.flight
    assert flight is not None and flight.restarts == (20, 40)
    plant = done.case.model.plant()
    y = np.concatenate([plan.configuration[20], plan.velocity[20]])
    for k in range(20, 30):

        def flow(t: float, y: Array, u: Array = plan.inputs[k]) -> Array:
            return np.concatenate([plant.kinematics(y[:7], y[7:]), plant.acceleration(y[:7], y[7:], u)])

        y = solve_ivp(flow, plan.time[k : k + 2], y, rtol=1e-10, atol=1e-11, method="LSODA").y[:, -1]
    np.testing.assert_allclose(flight.configuration[flight.nodes[30]], y[:7], atol=1e-7)


def test_ends_at_rest_and_with_a_given_velocity() -> None:
    few = ("scenario.gates=1", "scenario.nodes_per_gate=30")
    rest, moving = run(*few, "scenario.end_velocity=rest"), run(*few, "scenario.end_velocity=[1,-2,0]")
    for done in (rest, moving):
        assert done.certificate.certified, done.certificate.reasons
    plan = rest.result.plan
    np.testing.assert_allclose(plan.configuration[-1, :3], [4.75, -0.9, 1.2], atol=1e-8)
    np.testing.assert_allclose(plan.velocity[-1], 0, atol=1e-8)
    np.testing.assert_allclose(plan.configuration[-1, 4:6], 0, atol=1e-8)
    np.testing.assert_allclose(moving.result.plan.velocity[-1, :3], [1, -2, 0], atol=1e-7)
    free = run(*few).record["travel_time_s"]
    assert free < moving.record["travel_time_s"] < rest.record["travel_time_s"]


def test_smaller_gates_and_own_gates_take_longer(tmp_path: Path) -> None:
    small = run("scenario.gates=2", "scenario.nodes_per_gate=20", "scenario.radius=0.05")
    assert small.certificate.certified
    assert small.record["travel_time_s"] > good().record["travel_time_s"] + 0.01
    shuffled = tmp_path / "track.csv"
    shuffled.write_text("x,y,z,order\n9.2,6.6,1.0,2\n-1.1,-1.6,3.6,1\n")
    same = run("scenario.gates=null", "scenario.nodes_per_gate=20", f"scenario.track={shuffled}")
    assert same.record["mpcc_hash"] == good().record["mpcc_hash"]


def test_who_cannot_race_is_told() -> None:
    case = composing.case_of("+scenario=race")
    with pytest.raises(BadInput, match="'race_quadrotor' cannot race"):
        pipeline.run(replace(case, model=Bare(case.model)))
    with pytest.raises(BadInput, match="gate 1 is outside the workspace"):
        run("scenario.track=[[0,0,-1]]", "scenario.gates=1")
    with pytest.raises(BadInput, match="too short for this race"):
        run("scenario.travel_time=[0.1,0.5]")


def test_recordings_are_read_back(tmp_path: Path) -> None:
    done = good()
    write_mcap(
        tmp_path / "plan.mcap",
        done.result.plan,
        done.certificate.flight,
        done.case.scenario,
        done.case.model,
        {},
    )
    again = read_mcap(tmp_path / "plan.mcap").plan
    assert again.velocity_names == done.result.plan.velocity_names == ("vx", "vy", "vz", "wx", "wy", "wz")
    np.testing.assert_array_equal(again.velocity, done.result.plan.velocity)


def test_picture_and_recording_are_written(tmp_path: Path) -> None:
    done = good()
    done = replace(done, record={**done.record, "run_id": "race"})
    paths = pipeline.write(done, tmp_path / "run", tmp_path / "table", "scenario: race")
    with Image.open(paths["picture"]) as picture:
        colours = len(picture.convert("RGB").reduce(4).getcolors(1_000_000))
    assert colours > 200  # the track is drawn in the colours of its speeds
    assert paths["plan"].stat().st_size > 10_000


# The certificate against spoiled plans


def judge(plan: Plan, **changes: object) -> Certificate:
    case = good().case
    said = {name: getattr(case.scenario, name) for name in case.scenario.model_fields_set}
    return certify(plan, type(case.scenario)(**{**said, **changes}), case.model, case.limits)


def broken(certificate: Certificate) -> set[str]:
    return {check.name for check in certificate.checks if not check.ok}


def moved(plan: Plan, what: str, rows: object, column: int, by: float) -> Plan:
    values = getattr(plan, what).copy()
    values[rows, column] += by
    return replace(plan, **{what: values})


def test_the_good_plan_passes() -> None:
    assert broken(judge(good().result.plan)) == set()


SPOILED: dict[str, tuple[Callable[[Plan], Plan], str]] = {
    "inputs too weak": (lambda p: replace(p, inputs=p.inputs * 0.99), "segment"),
    "faster than the dynamics": (lambda p: replace(p, time=p.time * 0.97), "defect_position"),
    "motor over its limit": (lambda p: moved(p, "inputs", 7, 2, 0.2), "planned_input"),
    "negative thrust": (lambda p: moved(p, "inputs", 7, 2, -7.0), "planned_input"),
    "start moved": (lambda p: moved(p, "configuration", 0, 1, 0.01), "planned_start"),
    "start not at rest": (lambda p: moved(p, "velocity", 0, 0, 0.1), "planned_start_rest"),
    "yaw rate over its limit": (lambda p: moved(p, "velocity", 12, 5, 0.4), "planned_velocity"),
    "long quaternion": (lambda p: moved(p, "configuration", 12, 3, 0.05), "planned_quaternion"),
    "a jump at a gate": (lambda p: moved(p, "configuration", slice(20, None), 0, 0.02), "segment"),
    "not a number": (lambda p: moved(p, "inputs", 3, 0, np.nan), "finite_inputs"),
}


@pytest.mark.parametrize("name", SPOILED)
def test_spoiled_plans_are_refused(name: str) -> None:
    spoil, check = SPOILED[name]
    assert check in broken(judge(spoil(good().result.plan)))


def test_a_skipped_node_is_a_jump() -> None:
    """Tunnelling between nodes: the states agree with the gates, the flight between them does not exist."""
    plan = good().result.plan
    keep = np.delete(np.arange(61), slice(8, 12))
    gone = replace(
        plan, time=plan.time[:57], configuration=plan.configuration[keep], velocity=plan.velocity[keep],
        progress=plan.progress[keep], inputs=np.delete(plan.inputs, slice(8, 12), axis=0),
    )  # fmt: skip
    assert {"defect_position", "segment"} <= broken(judge(gone))


def test_gates_are_missed_by_moving_them() -> None:
    """The flight passes at a gate's edge: moved away by 2 cm it is missed, moved nearer it is not."""
    plan, gates = good().result.plan, good().case.scenario.goals  # type: ignore[attr-defined]
    edge = plan.configuration[20, :3] - np.array(gates[0].position)
    for shift, missed in ((-0.02, True), (-0.005, False), (0.02, False)):
        first = np.array(gates[0].position) + shift * edge / np.linalg.norm(edge)
        certificate = judge(plan, track=[first.tolist(), list(gates[1].position)], gates=2)
        assert ("gate" in broken(certificate)) == missed


def test_order_counts() -> None:
    plan, gates = good().result.plan, good().case.scenario.goals  # type: ignore[attr-defined]
    swapped = judge(plan, track=[list(gates[1].position), list(gates[0].position)], gates=2)
    assert "gate" in broken(swapped)
    assert swapped.measures.gates_passed == 1


def test_ground_between_nodes() -> None:
    """The good flight touches its ground limit of 0.5 m: a higher ground is broken, and by the flown path."""
    lowest = float(good().result.plan.configuration[:, 2].min())
    raised = judge(good().result.plan, workspace={"z": (lowest + 0.02, 100.0)})
    assert {"planned_configuration", "replay_position"} <= broken(raised)


# passes()


def path(*corners: tuple[float, float, float]) -> tuple[Array, Array]:
    return np.arange(float(len(corners))), np.array(corners)


A, B = Gate((1.0, 0.0, 0.0), 0.1), Gate((3.0, 0.0, 0.0), 0.1)


def test_gates_between_two_samples_count() -> None:
    """Both gates lie on one straight piece; in the other order the second is never reached again."""
    line = path((0, 0, 0), (4, 0, 0))
    one, two = passes(*line, (A, B), 0.0)
    assert (one.inside, two.inside) == (True, True)
    assert (one.time, two.time) == (0.25, 0.75)
    assert [p.inside for p in passes(*line, (B, A), 0.0)] == [True, False]


def test_a_path_that_comes_back_may_pass_in_the_other_order() -> None:
    there_and_back = path((0, 0, 0), (4, 0, 0), (0, 0, 0))
    assert [p.inside for p in passes(*there_and_back, (B, A), 0.0)] == [True, True]
    assert [p.inside for p in passes(*there_and_back, (A, B, A), 0.0)] == [True, True, True]
    assert [p.inside for p in passes(*there_and_back, (B, A, B), 0.0)] == [True, True, False]


@pytest.mark.parametrize(("height", "inside"), [(0.1, True), (0.1099, True), (0.1101, False), (5.0, False)])
def test_the_allowance_is_added_to_the_radius(height: float, inside: bool) -> None:
    (found,) = passes(*path((0, 0, height), (4, 0, height)), (A,), 0.01)
    assert found.inside == inside
    assert found.beyond == pytest.approx(height - 0.1)


def test_after_a_missed_gate_none_counts() -> None:
    far = Gate((2.0, 9.0, 0.0), 0.1)
    assert [p.inside for p in passes(*path((0, 0, 0), (4, 0, 0)), (A, far, B), 0.0)] == [True, False, False]
