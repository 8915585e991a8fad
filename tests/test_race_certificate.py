"""What the certificate says of a race flown by hand: a climb at constant thrust that turns as it rises.

z = 1 + t^2, heading 0.025 t^2, for 4 s in 20 intervals: everything that is measured on it can be written down.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
import yaml

from benchbench.certificate import advice
from benchbench.certificate.certificate import Certificate
from benchbench.certificate.certify import certify
from benchbench.certificate.check import Check
from benchbench.certificate.limits import Limits
from benchbench.certificate.passing import as_passed, gate_nodes
from benchbench.ocp.plan import Interpolation, Plan
from benchbench.ocp.race import Race
from benchbench_plugins.models.quadrotor import Quadrotor, Ramp

YAML = Path(__file__).parents[1] / "conf/certificate"
SAID = {
    **yaml.safe_load((YAML / "task.yaml").read_text()),
    **yaml.safe_load((YAML / "race.yaml").read_text()),
}
LIMITS = Limits(**{key: value for key, value in SAID.items() if key not in ("_target_", "defaults")})
N, T, RISE, TURN = 20, 4.0, 2.0, 0.05
"""Intervals, s, m/s^2, rad/s^2."""
THRUST = 0.85 * (RISE + 9.801) / 4
TWIST = 0.0017 * TURN / (4 * 0.05)
"""N of each motor, and by how much they differ to turn."""
TIME = np.linspace(0.0, T, N + 1)


def vehicle(**changes: Any) -> Quadrotor:
    fields: dict[str, Any] = {
        "name": "by_hand", "mass": 0.85, "inertia": (0.001, 0.001, 0.0017), "lever": 0.15, "torque_coefficient": 0.05,
        "motor_force": (0.0, 6.8794), "body_rate": (15.0, 15.0, 0.3), "gravity": 9.801,
    }  # fmt: skip
    return Quadrotor(**(fields | changes))


def climb(attitude: Literal["quaternion", "euler"] = "quaternion", linear: bool = False) -> Plan:
    model, none, heading = vehicle(attitude=attitude), np.zeros(N + 1), TURN * TIME**2 / 2
    turned = (
        [np.cos(heading / 2), none, none, np.sin(heading / 2)]
        if attitude == "quaternion"
        else [none, none, heading]
    )
    q = np.column_stack([none, none, 1 + RISE * TIME**2 / 2, *turned])
    v = np.column_stack([none, none, RISE * TIME, none, none, TURN * TIME])
    u = np.tile(THRUST + TWIST * np.array([1.0, -1.0, 1.0, -1.0]), (N + linear, 1))
    c, w, i = model.configuration, model.velocity, model.inputs
    how: Literal["linear", "hold"] = "linear" if linear else "hold"
    return Plan(TIME, q, v, u, none, how, c.names, c.units, i.names, i.units, w.names, w.units)


def race(**changes: Any) -> Race:
    fields: dict[str, Any] = {
        "name": "climb",
        "start": {"z": 1.0},
        "end": {"z": 17.0},
        "track": [[0.0, 0.0, 5.0]],
    }
    return Race(**(fields | changes))


def judged(plan: Plan | None = None, model: Quadrotor | None = None, **changes: Any) -> Certificate:
    return certify(plan or climb(), race(**changes), model or vehicle(), LIMITS)


def broken(certificate: Certificate) -> set[str]:
    return {check.name for check in certificate.broken}


def only(certificate: Certificate, name: str) -> Check:
    (check,) = (check for check in certificate.checks if check.name == name)
    return check


CHECKS = {
    **{f"finite_{name}": (0.0, "1", advice.RESTART) for name in ("time", "configuration", "velocity", "inputs", "progress")},
    "time": (0.0, "s", advice.RESTART),
    "planned_start": (1e-6, "m", advice.ACCURACY), "planned_start_rest": (1e-6, "m/s", advice.ACCURACY),
    "planned_quaternion": (1e-6, "1", advice.ACCURACY), "planned_configuration": (1e-6, "m", advice.ACCURACY),
    "planned_velocity": (1e-6, "m/s", advice.ACCURACY), "planned_input": (1e-6, "N", advice.ACCURACY),
    "defect_position": (1e-3, "m", advice.FINER), "defect_angle": (1e-2, "rad", advice.FINER),
    "defect_velocity": (0.01, "m/s", advice.FINER), "defect_rate": (0.05, "rad/s", advice.FINER),
    "gate": (0.01, "m", advice.GATE), "gate_speed": (0.05, "m/s", advice.GATE), "gate_heading": (0.01, "rad", advice.GATE),
    "segment": (0.01, "m", advice.FINER), "replay_position": (0.01, "m", advice.FINER),
    "replay_rate": (1.01, "times its limit", advice.RATE), "replay_end": (0.31, "m", advice.FINER),
    "replay_end_velocity": (0.05, "m/s", advice.FINER),
}  # fmt: skip
"""All that a race is asked, in order: limit, unit, what helps."""


def test_a_climb_by_hand_is_certified() -> None:
    gate = {"x": 0, "y": 0, "z": 5, "speed": [3.9, 4.1], "heading": 0.1}
    found = judged(track=[gate], end_velocity=[0.0, 0.0, 8.0])
    assert found.reasons == () and found.certified
    assert {check.name: (check.limit, check.unit, check.advice) for check in found.checks} == CHECKS
    assert list(dict.fromkeys(check.name for check in found.checks)) == list(CHECKS)
    assert only(found, "time").value == pytest.approx(0.2)
    assert only(found, "replay_rate").value == pytest.approx(0.2 / 0.3)
    assert [check.value for check in found.checks if check.name == "gate"] == pytest.approx([-0.3, -0.3])
    none = {"gate", "time", "replay_rate"}
    assert all(abs(check.value) < 1e-6 for check in found.checks if check.name not in none)
    measures = found.measures
    assert (measures.gates, measures.gates_passed) == (1, 1)
    assert measures.gate_worst_miss_m == pytest.approx(-0.3)
    assert measures.max_rate_ratio == pytest.approx(0.2 / 0.3)
    assert measures.contact_steps is None and measures.max_violation is None
    for value in (
        measures.replay_defect_position_m,
        measures.replay_drift_position_m,
        measures.replay_end_error_m,
    ):
        assert value is not None and value < 1e-7
    assert measures.replay_defect_angle_rad is not None and measures.replay_defect_angle_rad < 1e-7


@pytest.mark.parametrize("linear", [False, True])
def test_the_same_climb_in_angles(linear: bool) -> None:
    """Body rates are outputs there, not velocities."""
    plan, model = climb("euler", linear), vehicle(attitude="euler")
    found = judged(plan, model)
    assert found.reasons == ()
    assert "planned_quaternion" not in {check.name for check in found.checks}
    assert found.measures.max_rate_ratio == pytest.approx(0.2 / 0.3)
    slow = judged(plan, vehicle(attitude="euler", body_rate=(15.0, 15.0, 0.16)))
    assert broken(slow) == {"planned_output", "replay_rate"}
    assert only(slow, "planned_output").value == pytest.approx(0.04)
    assert "planned output 'wz'" in slow.reasons[0] and "0.04 rad/s at node 20" in slow.reasons[0]
    assert only(slow, "replay_rate").value == pytest.approx(0.2 / 0.16)
    assert "rate of 'wz' reaches 1.25 times its limit" in slow.reasons[1] and "t=4.000 s" in slow.reasons[1]


GATES: tuple[tuple[dict[str, Any], str, float, tuple[str, ...]], ...] = (
    ({"track": [[0.5, 0, 5]]}, "gate", 0.2, ("gate 1 ", " 0.5 m ", "t=2.000 s", "allowed 0.31 m")),
    ({"track": [[0.3, 0.4, 5]], "radius": 0.1}, "gate", 0.4, ("gate 1 ", " 0.5 m ", "allowed 0.11 m")),
    ({"track": [{"x": 0.6, "y": 0, "z": 5, "width": 1, "height": 1, "normal": [0, 0, 1]}]}, "gate", 0.1,
     ("gate 1 ", " 0.1 m beyond the edge ", "t=2.000 s", "allowed 0.01 m")),
    ({"track": [{"x": 0, "y": 0, "z": 5, "width": 1, "height": 1, "normal": [0, 0, -1]}]}, "gate", np.inf,
     ("gate 1 ", "not crossed in its direction")),
    ({"track": [{"x": 0, "y": 0, "z": 5, "speed": [6, 8]}]}, "gate_speed", 6 - 4.12,
     ("the speed at gate 1 is off its limits and reaches 1.88 m/s on the replay at t=", " s, allowed 0.05 m/s")),
    ({"track": [{"x": 0, "y": 0, "z": 5, "heading": -0.2}]}, "gate_heading", 0.025 * 1.94**2 + 0.2 - 0.1,
     ("the heading at gate 1 is off its limits and reaches 0.19409 rad on the replay at t=", " s, allowed 0.01 rad")),
    ({"end_velocity": [0.0, 0.0, 7.5]}, "replay_end_velocity", 0.5, ("velocity at the end on the replay is off and reaches 0.5 m/s, allowed 0.05 m/s",)),
    ({"end_velocity": [0.3, 0.4, 8.0]}, "replay_end_velocity", 0.5, (" 0.5 m/s",)),
    ({"end_velocity": "rest"}, "replay_end_velocity", 8.0, (" 8 m/s",)),
)  # fmt: skip


@pytest.mark.parametrize(("changes", "name", "value", "words"), GATES)
def test_what_is_said_of_gates_and_the_end(
    changes: dict[str, Any], name: str, value: float, words: tuple[str, ...]
) -> None:
    """Speed and heading count at the best sample inside the ball: from 1.94 s to 2.06 s."""
    found = judged(**changes)
    first = next(check for check in found.broken if check.name == name)
    assert first.value == pytest.approx(value, abs=1e-6)
    assert all(word in first.reason for word in words), first.reason
    if name != "gate":
        assert broken(found) == {name}


def test_gates_that_are_missed_spoil_those_after_them() -> None:
    """Up to 5 m first: then 3 m is not reached again, and the end does not count."""
    found = judged(track=[[0, 0, 5], [0, 0, 3]], gates=2)
    gates = [check for check in found.checks if check.name == "gate"]
    assert [check.ok for check in gates] == [True, False, False]
    entered = 5 - 0.31
    assert [check.value for check in gates] == pytest.approx([-0.3, entered - 3 - 0.3, -0.3], abs=1e-3)
    assert "gate 2" in gates[1].reason and "after the gates before it" in gates[2].reason
    assert gates[2].reason.startswith("the end ")
    assert (found.measures.gates, found.measures.gates_passed) == (2, 1)
    assert found.measures.gate_worst_miss_m == pytest.approx(entered - 3.3, abs=1e-3)
    free = judged(track=[[0, 0, 5], [0, 0, 3]], gates=2, order="free")
    assert free.certified and free.measures.gates_passed == 2


@pytest.mark.parametrize(
    ("up", "node"), [(5.0, 10), (5.3, 10), (5.6, 11), (1.01, None), (1.2, 2), (16.4, None), (16.0, 19)]
)
def test_the_replay_starts_again_at_the_node_nearest_to_a_gate(up: float, node: int | None) -> None:
    """Of a flight that is at height z at t = sqrt(z - 1); not at the first node or the last."""
    found = judged(track=[[0, 0, up]])
    assert found.flight is not None
    assert found.flight.restarts == (() if node is None else (node,))
    nodes = [check for check in found.checks if check.name == "segment"]
    assert len(nodes) == (1 if node is None else 2)


def test_the_replay_also_starts_again_after_some_seconds() -> None:
    """1 s, 2 s, where the gate is, and 3 s."""
    often = LIMITS.model_copy(update={"restart_seconds": 1.0})
    found = certify(climb(), race(), vehicle(), often)
    assert found.flight is not None and found.flight.restarts == (5, 10, 15)


def test_a_segment_is_flown_from_the_gate_before() -> None:
    """One per cent less thrust before the gate: 0.118 m/s^2 for 2 s. After it the flight starts anew."""
    plan = climb()
    weak = plan.inputs.copy()
    weak[:10] *= 0.99
    found = judged(replace(plan, inputs=weak))
    lost = 0.01 * (RISE + 9.801)
    assert [c.value for c in found.checks if c.name == "segment"] == pytest.approx(
        [lost * 2.0, 0.0], abs=1e-6
    )
    (said,) = (check.reason for check in found.broken if check.name == "segment")
    assert (
        said
        == "error of the replay since the gate before reaches 0.23602 m at node 10 (t=2.000 s), allowed 0.01 m"
    )
    assert found.measures.replay_drift_position_m == pytest.approx(lost * 2.0, abs=1e-6)
    assert found.measures.replay_defect_position_m == pytest.approx(lost * 0.2**2 / 2, abs=1e-6)
    last = plan.inputs.copy()
    last[10:] *= 0.99
    found = judged(replace(plan, inputs=last))
    assert [c.value for c in found.checks if c.name == "segment"] == pytest.approx(
        [0.0, lost * 2.0], abs=1e-6
    )
    assert found.measures.replay_end_error_m == pytest.approx(lost * 2.0, abs=1e-6)
    assert only(found, "replay_end").value == pytest.approx(lost * 2.0, abs=1e-6)


def test_ends_at_rest_have_no_radius() -> None:
    """0.2 m short: allowed for a free end of 0.3 m and a centimetre, not for a rest."""
    for velocity, limit in (("free", 0.31), ("rest", 0.02)):
        end = only(judged(end={"z": 17.2}, end_velocity=velocity), "replay_end")
        assert (end.value, end.limit, end.ok) == (
            pytest.approx(0.2, abs=1e-6),
            pytest.approx(limit),
            velocity == "free",
        )
        said = "distance from the end on the replay reaches 0.2 m, allowed 0.02 m"
        assert end.reason == ("" if velocity == "free" else said)
    own = only(judged(end={"z": 17.2}, end_radius=0.1), "replay_end")
    assert (own.limit, own.ok) == (pytest.approx(0.11), False)


LIMITED: tuple[tuple[dict[str, Any], dict[str, Any], dict[str, float], tuple[str, ...]], ...] = (
    ({"body_rate": (15.0, 15.0, 0.15)}, {}, {"planned_velocity": 0.05, "replay_rate": 0.2 / 0.15},
     ("'wz'", "0.05 rad/s at node 20", "1.33333 times its limit", "t=4.000 s")),
    ({"motor_force": (0.0, THRUST)}, {}, {"planned_input": TWIST}, ("'motor_1'", "N in row 0")),
    ({"motor_force": (THRUST, 6.0)}, {}, {"planned_input": TWIST}, ("'motor_2'", "N in row 0")),
    ({}, {"workspace": {"z": (0.5, 16.9)}}, {"planned_configuration": 0.1, "replay_position": 0.1},
     ("'z'", "0.1 m at node 20", "t=4.000 s, allowed 0.01 m")),
    ({}, {"workspace": {"z": (0.5, 16.995)}}, {"planned_configuration": 0.005}, ("0.005 m",)),
    ({}, {"start": {"z": 1.001}}, {"planned_start": 0.001}, ("'z'", "0.001 m", "start")),
    ({}, {"start_velocity": {"vz": 0.1}}, {"planned_start_rest": 0.1}, ("'vz'", "0.1 m/s", "start")),
)  # fmt: skip


@pytest.mark.parametrize(("model", "task", "expected", "words"), LIMITED)
def test_what_is_over_its_limit(
    model: dict[str, Any], task: dict[str, Any], expected: dict[str, float], words: tuple[str, ...]
) -> None:
    found = judged(None, vehicle(**model), **task)
    assert {check.name: check.value for check in found.broken} == pytest.approx(expected, abs=1e-7)
    said = " ".join(found.reasons)
    assert all(word in said for word in words), said


def test_a_quaternion_that_is_too_long() -> None:
    plan = climb()
    long = plan.configuration.copy()
    long[5, 3:] *= 1 + 1e-5
    found = only(judged(replace(plan, configuration=long)), "planned_quaternion")
    assert found.value == pytest.approx(1e-5, rel=1e-4) and not found.ok
    assert "1e-05 at node 5, allowed 1e-06" in found.reason


def test_limits_grow_along_the_ramp() -> None:
    """Node k is nominally 0.4 k m along up to the gate at node 10, then 1.2 m a node: the yaw rate is nearest there."""
    ramp = Ramp(metres=16.0, motor_force=6.8794, body_rate=(15.0, 15.0, 0.05))
    found = judged(None, vehicle(ramp=ramp))
    assert found.certified
    assert found.measures.max_rate_ratio == pytest.approx(0.1 / (0.05 + 0.25 * 4 / 16), rel=1e-6)
    weak = judged(None, vehicle(ramp=Ramp(metres=16.0, motor_force=2.5, body_rate=(15.0, 15.0, 0.3))))
    assert {c.name: c.value for c in weak.broken} == pytest.approx({"planned_input": THRUST + TWIST - 2.5})
    late = vehicle(ramp=Ramp(metres=16.0, motor_force=6.8794, body_rate=(15.0, 15.0, 0.03)))
    slow = judged(None, late)
    expected = {"planned_velocity": 0.0025, "replay_rate": 0.1 / 0.0975}
    assert {c.name: c.value for c in slow.broken} == pytest.approx(expected, abs=1e-6)
    assert "'wz' exceeds its limits by 0.0025 rad/s at node 10" in slow.reasons[0]
    assert "t=2.000 s" in slow.reasons[1]
    angles = vehicle(ramp=late.ramp, attitude="euler")
    same = judged(climb("euler"), angles)
    expected = {"planned_output": 0.0025, "replay_rate": 0.1 / 0.0975}
    assert {c.name: c.value for c in same.broken} == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(
    ("how", "rows", "row"), [("hold", N, 7), ("linear", N + 1, 7), ("bezier", 2 * N, 15)]
)
def test_inputs_are_limited_where_their_interval_begins(how: Interpolation, rows: int, row: int) -> None:
    """Node 7 is 2.8 m along a ramp of 16 m; two control points belong to an interval."""
    inputs = np.full((rows, 4), THRUST)
    inputs[row] = 6.0
    ramp = Ramp(metres=16.0, motor_force=2.6, body_rate=(15.0, 15.0, 0.3))
    plan = replace(climb(), inputs=inputs, interpolation=how)
    found = only(judged(plan, vehicle(ramp=ramp)), "planned_input")
    assert found.value == pytest.approx(6.0 - 2.6 - (6.8794 - 2.6) * 2.8 / 16)
    assert f"'motor_1' exceeds its limits by 2.6511 N in row {row}, " in found.reason


def along(x: float, y: float = 0.0) -> list[float]:
    return [x, y, 0.0]


def line() -> Plan:
    """From x = 0 to x = 10 in 10 s and intervals."""
    model, time = vehicle(), np.arange(11.0)
    q = np.zeros((11, 7))
    q[:, 0], q[:, 3] = time, 1.0
    c, w, i = model.configuration, model.velocity, model.inputs
    return Plan(
        time, q, np.zeros((11, 6)), np.zeros((10, 4)), 0 * time, "hold", c.names, c.units, i.names, i.units, w.names, w.units
    )  # fmt: skip


def straight(*gates: list[float], **changes: Any) -> Race:
    return Race(**({"name": "line", "start": {"z": 0.0}, "end": {"x": 8.0}, "track": list(gates)} | changes))


def test_where_the_replay_of_a_line_starts_again() -> None:
    """At the nodes nearest to gates that are passed; not at the first, the last, or for the end."""
    near = straight(along(3.4), along(3.6), along(5.6, 0.305))
    assert gate_nodes(line(), near, LIMITS) == (3, 4, 6)
    assert gate_nodes(line(), straight(along(0.3), along(0.6)), LIMITS) == (1,)
    assert gate_nodes(line(), straight(along(9.4), along(9.6)), LIMITS) == (9,)
    assert gate_nodes(line(), straight(along(2.0), along(5.6, 0.32)), LIMITS) == (2,)
    assert gate_nodes(line(), straight(along(3.4), along(3.45), end={"x": 5.0}), LIMITS) == (3,)


def test_gates_in_any_order_are_judged_in_that_of_the_flight() -> None:
    gates = (along(7.0), along(3.0), along(5.0, 4.0))
    fixed = straight(*gates)
    assert as_passed(line(), fixed, 0.01) is fixed
    flown = as_passed(line(), straight(*gates, order="free"), 0.01)
    assert (flown.order, flown.sequence) == ("fixed", (2, 3, 1))
    assert [gate.position[0] for gate in flown.goals] == [3.0, 5.0, 7.0, 8.0]


def test_the_replay_is_the_climb() -> None:
    flight = judged().flight
    assert flight is not None
    np.testing.assert_allclose(flight.time, 0.02 * np.arange(201), atol=1e-12)
    heading = TURN * flight.time**2 / 2
    expected = np.column_stack([1 + flight.time**2, np.cos(heading / 2), np.sin(heading / 2)])
    np.testing.assert_allclose(flight.configuration[:, [2, 3, 6]], expected, atol=1e-8)
    np.testing.assert_array_equal(flight.nodes, 10 * np.arange(N + 1))
