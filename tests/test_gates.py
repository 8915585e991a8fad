"""Gates of all kinds: what the planner makes of them, and the certificate's own geometry."""

from __future__ import annotations

import math
from functools import cache

import casadi as ca
import composing
import numpy as np
import pytest

from benchbench.certificate.certificate import Certificate
from benchbench.certificate.certify import certify
from benchbench.formulation.gate_conditions import conditions
from benchbench.ground.arrays import Array
from benchbench.ocp.gates import manner, passes
from benchbench.ocp.track import Gate, Opening
from benchbench.ocp.track_file import read
from benchbench.run import pipeline

FRAME = {"x": -1.1, "y": -1.6, "z": 3.6, "width": 1.2, "height": 0.8, "yaw": 0.0}
SLOW = {"x": 9.2, "y": 6.6, "z": 1.0, "speed": [2, 6], "heading": -0.3}
BOX = ("scenario.gates=2", "scenario.nodes_per_gate=36")


@cache
def planned() -> pipeline.Run:
    track = "scenario.track=[{x:-1.1,y:-1.6,z:3.6,width:1.2,height:0.8,yaw:0.0},{x:9.2,y:6.6,z:1.0,speed:[2,6],heading:-0.3}]"
    return pipeline.run(composing.case_of("+scenario=race", track, *BOX))


def judged(*lap: dict[str, object]) -> Certificate:
    done = planned()
    told = [str(gate).replace("'", "").replace(" ", "") for gate in lap]
    case = composing.case_of("+scenario=race", f"scenario.track=[{','.join(told)}]", *BOX)
    return certify(done.result.plan, case.scenario, case.model, case.limits)


def broken(certificate: Certificate) -> set[str]:
    return {check.name for check in certificate.checks if not check.ok}


def test_a_rectangle_is_flown_through_and_speed_and_heading_are_kept() -> None:
    done = planned()
    assert done.certificate.certified, done.certificate.reasons
    flight = done.certificate.flight
    assert flight is not None
    x, y, z = flight.configuration[:, :3].T
    (k,) = np.flatnonzero((x[:-1] < -1.1) & (x[1:] >= -1.1))[:1]  # the plane of the frame, by hand
    assert abs(y[k] + 1.6) < 0.65 and abs(z[k] - 3.6) < 0.45
    plan = done.result.plan
    assert 1.99 < np.linalg.norm(plan.velocity[72, :3]) < 6.01
    w, i, j, n = plan.configuration[72, 3:]
    heading = math.atan2(2 * (w * n + i * j), 1 - 2 * (j * j + n * n))
    assert abs(heading + 0.3) < 0.101


@pytest.mark.parametrize(
    ("first", "second", "check"),
    [
        (FRAME, SLOW, None),
        (FRAME | {"direction": "against"}, SLOW, "gate"),
        (FRAME | {"direction": "either"}, SLOW, None),
        (FRAME | {"yaw": math.pi}, SLOW, "gate"),
        (FRAME | {"yaw": math.pi, "direction": "against"}, SLOW, None),
        (FRAME | {"width": 0.2}, SLOW, "gate"),
        (FRAME, SLOW | {"speed": [7, 9]}, "gate_speed"),
        (FRAME, SLOW | {"speed": [0, 0.5]}, "gate_speed"),  # it turns in that ball, at 0.7 m/s at its slowest
        (FRAME, SLOW | {"heading": 0.3}, "gate_heading"),
    ],
)
def test_the_certificate_sees_what_the_gate_asks(
    first: dict[str, object], second: dict[str, object], check: str | None
) -> None:
    found = broken(judged(first, second))
    assert (check in found) if check else not found
    beside = {"gate_speed", "gate_heading"}  # what is judged where the one is best may break the other
    if check == "gate":
        beside.add("segment")  # the replay starts again at a gate that is passed only
    assert found - {check} <= beside


def test_the_edge_of_the_opening_grown_by_a_centimetre_decides() -> None:
    """The plan crosses the frame at its nearer edge: moved away by 9 mm it holds, by 12 mm it does not."""
    crossing = float(planned().result.plan.configuration[36, 1])
    edge = math.copysign(0.6, crossing + 1.6)
    for shift, holds in ((0.009, True), (0.012, False)):
        moved = crossing - edge - math.copysign(shift, edge)
        assert ("gate" not in broken(judged(FRAME | {"y": moved}, SLOW))) == holds


# Geometry

FLAT = Gate((2.0, 0.0, 1.0), 1.0, Opening((1.0, 0.0, 0.0), 1.0, 0.5))


def line(*corners: tuple[float, float, float]) -> tuple[Array, Array]:
    return np.arange(float(len(corners))), np.array(corners)


@pytest.mark.parametrize(
    ("corners", "inside", "beyond"),
    [
        (((0, 0, 1), (4, 0, 1)), True, -0.25),
        (((0, 0.505, 1), (4, 0.505, 1)), True, 0.005),
        (((0, 0.52, 1), (4, 0.52, 1)), False, 0.02),
        (((0, 0, 1.3), (4, 0, 1.3)), False, 0.05),
        (((4, 0, 1), (0, 0, 1)), False, math.inf),
        (((0, 0, 1), (1.9, 0, 1)), False, math.inf),
        (((0, 3, 1), (4, 3, 1), (4, 0, 1), (0, 0, 1), (4, 0, 1)), True, -0.25),
    ],
)
def test_crossings(corners: tuple[tuple[float, float, float], ...], inside: bool, beyond: float) -> None:
    (found,) = passes(*line(*corners), (FLAT,), 0.01)
    assert found.inside == inside
    assert found.beyond == pytest.approx(beyond)


def test_order_within_one_piece() -> None:
    later = Gate((3.0, 0.0, 1.0), 1.0, FLAT.opening)
    assert [one.inside for one in passes(*line((0, 0, 1), (4, 0, 1)), (FLAT, later), 0.0)] == [True, True]
    assert [one.inside for one in passes(*line((0, 0, 1), (4, 0, 1)), (later, FLAT), 0.0)] == [True, False]


def test_the_best_instant_inside_a_ball_counts() -> None:
    """Speed falls from 4 to 1 m/s through a ball: 2 m/s occurs inside, 5 m/s does not."""
    time, position = line(*((x / 10, 0, 0) for x in range(11)))
    velocity = np.column_stack([np.linspace(4, 1, 11), np.zeros(11), np.zeros(11)])
    nose = np.tile([0.0, 1.0, 0.0], (11, 1))
    for speed, heading, off in (
        ((1.9, 2.0), None, (0.0, 0.0)),
        ((5.0, 6.0), None, (1.9, 0.0)),  # 3.1 m/s at x = 0.3, the first sample inside
        (None, math.pi / 2 - 0.15, (0.0, 0.05)),
        (None, -1.5 * math.pi, (0.0, 0.0)),
    ):
        gate = Gate((0.6, 0.0, 0.0), 0.3, None, speed, heading)
        (one,) = passes(time, position, (gate,), 0.001)
        found = manner(gate, one, time, position, velocity, nose, 0.001)
        assert (found.speed, found.heading) == pytest.approx(off, abs=1e-9)


def test_conditions_of_planners_agree_with_plain_geometry() -> None:
    """At random states, against inequalities written by hand."""
    (gate,) = read(
        [
            {
                "x": 1,
                "y": 2,
                "z": 3,
                "width": 2,
                "height": 1,
                "normal": [3, 0, 4],
                "speed": [2, 5],
                "heading": 1.0,
            }
        ],
        0.3,
    ).lap
    random = np.random.default_rng(0)
    n, side, up = np.array([0.6, 0, 0.8]), np.array([0, 1.0, 0]), np.array([-0.8, 0, 0.6])
    seen = set()
    for _ in range(400):
        p = np.array([1, 2, 3]) + random.normal(size=3) * random.choice([0.4, 1e-4])
        p -= n * (n @ (p - [1, 2, 3])) * random.choice([0, 1], p=[0.3, 0.7])
        v, nose = random.normal(size=3) * 2.5, random.normal(size=3) + np.array([0.5, 0.9, 0])
        nose[:2] *= random.choice([1, 0.05], p=[0.8, 0.2])
        nose /= np.linalg.norm(nose)
        d = p - [1, 2, 3]
        angle = math.remainder(math.atan2(nose[1], nose[0]) - 1.0, 2 * math.pi)
        by_hand = {
            "opening": abs(n @ d) <= 1e-4 and abs(side @ d) <= 1 and abs(up @ d) <= 0.5,
            "across": n @ v >= 1.0, "slowest": np.linalg.norm(v) >= 2, "fastest": np.linalg.norm(v) <= 5,
            "nose": abs(angle) <= 0.1, "not_vertical": abs(math.asin(nose[2])) <= math.acos(0.2),
        }  # fmt: skip
        state = {"position": p, "velocity": v, "attitude": nose}
        for condition, numbers in conditions(gate):
            h = condition.h(ca.SX(ca.DM(state[condition.reads])), ca.SX(ca.DM(numbers)))
            holds = bool(np.all(np.array(ca.evalf(h)) <= 0))
            assert holds == by_hand[condition.name], condition.name
            seen.add((condition.name, holds))
    assert len(seen) == 12


def test_a_heading_is_not_flown_with_the_nose_straight_up() -> None:
    """Where turning is slow and pitching is not: this flight stood on its tail at the gate, with any heading before and after."""
    gate = "{x: 0, y: 2, z: 2, radius: 0.3, heading: 3.0}"
    case = composing.case_of(
        "+scenario=race", f"scenario.track=[{gate}]", "scenario.gates=null", "scenario.nodes_per_gate=20",
        "scenario.start={x: -2, y: 0, z: 2}", "scenario.end={x: 2, y: 0, z: 2}",
    )  # fmt: skip
    done = pipeline.run(case)
    assert done.certificate.certified, done.certificate.reasons
    (k,) = np.flatnonzero(done.result.plan.progress > 0.5)[:1]
    w, x, y, z = done.result.plan.configuration[k, 3:7]
    assert math.hypot(w * w + x * x - y * y - z * z, 2 * (x * y + w * z)) >= 0.2 - 1e-6


@pytest.mark.parametrize("direction", ["along", "against", "either"])
def test_a_gate_to_turn_round_at_is_crossed(direction: str) -> None:
    """Start and end are on one side: a flight that only touches the plane, or grazes it, is shorter and no crossing."""
    gate = f"{{x: 0, y: 0, z: 2, width: 1, height: 1, yaw: 0, direction: {direction}}}"
    ends = ("scenario.start={x: -4, y: 0, z: 2}", "scenario.end={x: -4, y: 3, z: 2}")
    case = composing.case_of(
        "+scenario=race",
        f"scenario.track=[{gate}]",
        "scenario.gates=null",
        "scenario.nodes_per_gate=20",
        *ends,
    )
    done = pipeline.run(case)
    assert done.certificate.certified, done.certificate.reasons
    (k,) = np.flatnonzero(done.result.plan.progress > 0.5)[:1]
    across = done.result.plan.velocity[k, 0]
    assert {"along": across >= 0.999, "against": across <= -0.999, "either": abs(across) >= 0.999}[direction]


def test_a_slow_gate_asks_for_less_speed_across() -> None:
    gate = {"x": 0, "y": 0, "z": 2, "width": 1, "height": 1, "yaw": 0, "speed": [0.2, 0.6]}
    (one,) = read([gate], 0.3).lap
    asked = {condition.name: (condition, numbers) for condition, numbers in conditions(one)}
    condition, numbers = asked["across"]
    for speed, holds in ((0.31, True), (0.29, False)):
        h = condition.h(ca.SX(ca.DM([speed, 0, 0])), ca.SX(ca.DM(numbers)))
        assert (float(ca.evalf(h)) <= 0) == holds
