"""Every check of a race on a flight that is written down: along x at 2 m/s, rolling as it goes.

The plan is at x = 2 t, the flight a little beside it in y; its nodes are every second sample.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from test_race_certificate import LIMITS, vehicle
from test_reasons import close, told

from benchbench.certificate.advice import FINER, GATE
from benchbench.certificate.checks.gates import gates, race_end, segments
from benchbench.certificate.limited import Limited
from benchbench.certificate.passing import GateEvidence
from benchbench.certificate.replay import Defects, Replay
from benchbench.ocp.gates import passes
from benchbench.ocp.plan import Plan
from benchbench.ocp.race import Race

MODEL = vehicle()
TIME = np.arange(6.0)
DENSE = np.arange(0.0, 5.5, 0.5)
NODES = np.arange(0, 11, 2)


def line() -> Plan:
    q = np.zeros((6, 7))
    q[:, 0], q[:, 3] = 2 * TIME, 1.0
    none = np.zeros((6, 6))
    return Plan.of(
        MODEL,
        time=TIME,
        configuration=q,
        velocity=none,
        inputs=np.zeros((5, 4)),
        progress=0 * TIME,
        interpolation="hold",
    )


def flight(beside: float = 0.0) -> Replay:
    """Beside the plan by this in y; its quaternion is off, and its roll rate no speed."""
    q, v = np.zeros((11, 7)), np.zeros((11, 6))
    q[:, 0], q[:, 1], q[:, 3] = 2 * DENSE, beside, 0.5
    v[:, 0], v[:, 3] = 2.0, 9.0
    return Replay(DENSE, q, v, NODES, (2, 4), None)


def evidence(*track: Any, flown: Replay | None = None, **changes: Any) -> GateEvidence:
    given = {
        "name": "line",
        "start": {"z": 0.0},
        "end": {"x": 10.0},
        "track": list(track) or [[4.0, 0.0, 0.0]],
    }
    race, flown, plan = Race(**(given | changes)), flown or flight(), line()
    none = Limited((), (), np.zeros((0, 0)), np.zeros(0), np.zeros(0))
    return GateEvidence(
        plan=plan, model=MODEL, limits=LIMITS, residuals=None, scenario=race, plant=MODEL.plant(),
        missed=Defects(np.zeros((5, 7)), np.zeros((5, 6))), flight=flown, planned={}, room=none, rates=none,
        passes=passes(flown.time, flown.configuration[:, :3], race.goals, LIMITS.gate_position),
    )  # fmt: skip


def gate(x: float, y: float = 0.0, **asked: Any) -> dict[str, Any]:
    return {"x": x, "y": y, "z": 0.0, **asked}


def test_gates_that_are_passed_as_they_ask() -> None:
    """Through the middle of both and the end, with the nose ahead."""
    found = list(gates(evidence(gate(4.0, speed=[1.9, 2.1], heading=0.05), gate(8.0, 0.1))))
    asked = [(check.name, check.value, check.limit, check.unit) for check in found]
    assert asked == close(
        ("gate", -0.3, 0.01, "m"), ("gate_speed", 0.0, 0.05, "m/s"), ("gate_heading", 0.0, 0.01, "rad"),
        ("gate", -0.2, 0.01, "m"), ("gate", -0.3, 0.01, "m"),
    )  # fmt: skip
    assert {(check.ok, check.reason, check.advice) for check in found} == {(True, "", GATE)}


MISSED = [
    (gate(4.0, 0.5), ("gate", 0.2, 0.01, "m", "gate 1 is passed at 0.5 m on the replay at t=2.000 s, allowed 0.31 m", GATE)),
    (gate(5.0, 0.5, radius=0.25), (
        "gate", 0.25, 0.01, "m", "gate 1 is passed at 0.5 m on the replay at t=2.500 s, allowed 0.26 m", GATE)),
    (gate(4.0, 0.75, width=1.0, height=1.0, normal=[1.0, 0.0, 0.0]), (
        "gate", 0.25, 0.01, "m",
        "gate 1 is crossed 0.25 m beyond the edge of its opening on the replay at t=2.000 s, allowed 0.01 m", GATE)),
    (gate(4.0, width=1.0, height=1.0, normal=[-1.0, 0.0, 0.0]), (
        "gate", np.inf, 0.01, "m", "gate 1 is not crossed in its direction on the replay, after the gates before it", GATE)),
    (gate(4.0, speed=[2.5, 3.0]), (
        "gate_speed", 0.5, 0.05, "m/s",
        "the speed at gate 1 is off its limits and reaches 0.5 m/s on the replay at t=2.000 s, allowed 0.05 m/s", GATE)),
    (gate(4.0, speed=[0.5, 1.75]), (
        "gate_speed", 0.25, 0.05, "m/s",
        "the speed at gate 1 is off its limits and reaches 0.25 m/s on the replay at t=2.000 s, allowed 0.05 m/s", GATE)),
]  # fmt: skip


@pytest.mark.parametrize(("asked", "expected"), MISSED)
def test_what_is_said_of_a_gate(asked: dict[str, Any], expected: tuple[Any, ...]) -> None:
    first, *after = told(gates(evidence(asked)))
    assert [first] == close(expected)
    spoiled = ("gate", -0.3, 0.01, "m", "the end is not passed after the gates before it", GATE)
    assert after == (close(spoiled) if expected[0] == "gate" else [])


def test_a_gate_that_is_not_passed_is_asked_nothing_else_but_the_next_is() -> None:
    found = list(gates(evidence(gate(4.0, 0.5, speed=[5.0, 6.0]), gate(6.0, speed=[5.0, 6.0]))))
    assert [check.name for check in found] == ["gate", "gate", "gate"]
    fast = told(gates(evidence(gate(4.0), gate(6.0, speed=[5.0, 6.0]))))
    assert [entry[0] for entry in fast] == ["gate_speed"] and "at gate 2 is" in fast[0][4]


def test_a_heading_is_asked_of_the_nose() -> None:
    """A quarter turn to the left; gates allow a heading of some degrees by themselves."""
    turned = flight()
    turned.configuration[:, 3:] = np.sqrt(0.5), 0, 0, np.sqrt(0.5)
    assert told(gates(evidence(gate(4.0, heading=np.pi / 2), flown=turned))) == []
    ((name, value, limit, unit, reason, advice),) = told(
        gates(evidence(gate(4.0, heading=0.0), flown=turned))
    )
    assert (name, limit, unit, advice) == ("gate_heading", 0.01, "rad", GATE) and 1.4 < value < np.pi / 2
    assert reason == (
        f"the heading at gate 1 is off its limits and reaches {value:.6g} rad on the replay at t=2.000 s, allowed 0.01 rad"
    )


def test_a_segment_ends_at_each_restart_and_at_the_end() -> None:
    found = told(segments(evidence(flown=flight(0.125))))
    assert found == close(*(
        ("segment", 0.125, 0.01, "m",
         f"error of the replay since the gate before reaches 0.125 m at node {k} (t={k:.3f} s), allowed 0.01 m", FINER)
        for k in (2, 4, 5)
    ))  # fmt: skip
    assert told(segments(evidence())) == []


ENDS: list[tuple[dict[str, Any], list[tuple[Any, ...]]]] = [
    ({}, []),
    ({"end": {"x": 10.0, "y": 0.5}, "end_radius": 0.25}, [
        ("replay_end", 0.5, 0.26, "m", "distance from the end on the replay reaches 0.5 m, allowed 0.26 m", FINER)]),
    ({"end_velocity": "rest"}, [
        ("replay_end_velocity", 2.0, 0.05, "m/s",
         "velocity at the end on the replay is off and reaches 2 m/s, allowed 0.05 m/s", FINER)]),
    ({"end": {"x": 10.0, "y": 0.025}, "end_velocity": "rest"}, [
        ("replay_end", 0.025, 0.02, "m", "distance from the end on the replay reaches 0.025 m, allowed 0.02 m", FINER),
        ("replay_end_velocity", 2.0, 0.05, "m/s",
         "velocity at the end on the replay is off and reaches 2 m/s, allowed 0.05 m/s", FINER)]),
    ({"end_velocity": [2.0, 0.0, 0.0]}, []),
    ({"end_velocity": [2.0, -0.125, 0.0]}, [
        ("replay_end_velocity", 0.125, 0.05, "m/s",
         "velocity at the end on the replay is off and reaches 0.125 m/s, allowed 0.05 m/s", FINER)]),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "expected"), ENDS)
def test_how_a_race_ends(changes: dict[str, Any], expected: list[tuple[Any, ...]]) -> None:
    assert told(race_end(evidence(**changes))) == close(*expected)


def test_only_a_free_end_is_asked_for_no_velocity() -> None:
    for velocity, names in (
        ("free", ["replay_end"]),
        ([2.0, 0.0, 0.0], ["replay_end", "replay_end_velocity"]),
    ):
        assert [check.name for check in race_end(evidence(end_velocity=velocity))] == names


def test_where_a_gate_is_missed_by_exactly_what_is_allowed_it_counts() -> None:
    """At 0.31 m of a ball of 0.3 m, but after the gate that comes next."""
    found = evidence(gate(4.0))
    late = replace(found.passes[0], beyond=LIMITS.gate_position, inside=False)
    missed = replace(found, passes=(late, *found.passes[1:]))
    assert told(gates(missed)) == [
        ("gate", LIMITS.gate_position, 0.01, "m", "gate 1 is not passed after the gates before it", GATE)
    ]
