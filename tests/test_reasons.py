"""Every check on evidence that is written down: nothing is flown, one number at a time is off.

Four nodes, two samples of the replay per interval; each case says what is off, and the whole verdict on it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from flights import REST, Polynomial, plan_of, table_one
from test_audit import Told
from test_certificate import LIMITS, SOLVED
from test_handover_certificate import task

from benchbench.certificate.advice import (
    ACCURACY,
    CONTACT,
    FINER,
    PATH,
    PHASES_OR_RELAXATION,
    PHASES_OR_SHARPEN,
    RATE,
    RESTART,
    SECONDS,
    SHARPEN,
    SHARPEN_OR_GUESS,
    SOLVE,
)
from benchbench.certificate.audit import Audit, ContactEvidence
from benchbench.certificate.certificate import Certificate, Measures
from benchbench.certificate.check import Check, Checks, at_least, at_most, worst
from benchbench.certificate.checks.contacts import contact_flown, contact_planned
from benchbench.certificate.checks.intervals import (
    defect_angle,
    defect_position,
    defect_rate,
    defect_velocity,
)
from benchbench.certificate.checks.nodes import (
    planned_end,
    planned_limits,
    planned_quaternion,
    planned_start,
)
from benchbench.certificate.checks.problem import original_problem
from benchbench.certificate.checks.replay import (
    breakdown,
    replay_angle,
    replay_end,
    replay_position,
    replay_rate,
)
from benchbench.certificate.checks.soundness import finite, increasing
from benchbench.certificate.checks.stops import stop_choice, stop_order
from benchbench.certificate.limited import Limited
from benchbench.certificate.limits import Limits
from benchbench.certificate.numbers import flown
from benchbench.certificate.replay import Defects, Replay
from benchbench.ground.arrays import Array
from benchbench.mpcc.residuals import PairResidual
from benchbench.ocp.plan import Plan
from benchbench.ocp.stop import Stop

MODEL = table_one()
TIME = np.array([0.0, 0.5, 1.5, 2.0])
DENSE = np.array([0.0, 0.25, 0.5, 1.0, 1.5, 1.75, 2.0])
NODES = np.array([0, 2, 4, 6])
X, Y, Z, PITCH, YAW, ARM = 0, 1, 2, 4, 5, 6


def resting() -> Plan:
    return plan_of(MODEL, TIME, np.tile(REST, (4, 1)), np.zeros((4, 7)), np.tile(MODEL.hover(), (3, 1)))


def off(values: Array, row: int, column: int, by: float) -> Array:
    changed = values.copy()
    changed[row, column] += by
    return changed


def evidence(plan: Plan | None = None, flight: Replay | None = None, **changes: Any) -> ContactEvidence:
    """At rest at the start, which is also the end; nothing misses anything."""
    plan = plan or resting()
    still = Replay(DENSE, np.tile(REST, (7, 1)), np.zeros((7, 7)), NODES, (), None)
    flight = flight or still
    fields: dict[str, Any] = {
        "model": MODEL, "limits": LIMITS, "residuals": None, "scenario": task(), "plant": MODEL.plant(),
        "missed": Defects(np.zeros((3, 7)), np.zeros((3, 7))), "audits": (),
        "planned": {
            "configuration": Limited.of(MODEL.configuration, plan.configuration),
            "velocity": Limited.of(MODEL.velocity, plan.velocity), "input": Limited.of(MODEL.inputs, plan.inputs),
            "output": Limited((), (), np.zeros((4, 0)), np.zeros(0), np.zeros(0)),
        },
        "room": Limited.of(MODEL.configuration, flight.configuration),
        "rates": Limited.of(MODEL.velocity, flight.velocity),
    }  # fmt: skip
    return ContactEvidence(plan=plan, flight=flight, **(fields | changes))


def told(found: Checks) -> list[tuple[str, float, float, str, str, str]]:
    """Name, value, limit, unit, sentence and advice of each check that failed; what passes says nothing."""
    checks = list(found)
    assert all(check.reason == "" for check in checks if check.ok)
    return [(c.name, c.value, c.limit, c.unit, c.reason, c.advice) for c in checks if not c.ok]


def close(*expected: Any) -> list[Any]:
    return [
        tuple(pytest.approx(item, abs=1e-9) if isinstance(item, float) else item for item in one)
        for one in expected
    ]


# --- intervals -----------------------------------------------------------------------------------------------


def missing(row: int, **by: float) -> Defects:
    """Off in one interval by this, q_ in coordinates and v_ in velocities."""
    found = Defects(np.zeros((3, 7)), np.zeros((3, 7)))
    for key, value in by.items():
        kind, _, name = key.partition("_")
        array = found.configuration if kind == "q" else found.velocity
        array[row, MODEL.configuration.names.index(name)] = value
    return found


INTERVALS: list[tuple[Callable[[Any], Checks], Defects, tuple[Any, ...]]] = [
    (defect_position, missing(1, q_x=0.03, q_z=-0.04, q_arm=9.0), (
        "defect_position", 0.05, 0.005, "m",
        "position defect of one interval reaches 0.05 m in interval 1 (t=0.500 s), allowed 0.005 m", FINER)),
    (defect_angle, missing(2, q_pitch=0.1, q_arm=-0.2, q_x=9.0), (
        "defect_angle", 0.2, 0.02, "rad",
        "angle defect of one interval reaches 0.2 rad in interval 2 (t=1.500 s), allowed 0.02 rad", FINER)),
    (defect_velocity, missing(1, v_y=0.03, v_z=0.04, v_yaw=9.0), (
        "defect_velocity", 0.05, 0.01, "m/s",
        "jump of the planned velocity beside what its inputs fly reaches 0.05 m/s at the end of interval 1 "
        "(t=1.500 s), allowed 0.01 m/s", FINER)),
    (defect_rate, missing(0, v_pitch=0.3, v_yaw=-0.4, v_x=9.0), (
        "defect_rate", 0.4, 0.05, "rad/s",
        "jump of the planned rate of 'yaw' beside what its inputs fly reaches 0.4 rad/s at the end of interval 0 "
        "(t=0.500 s), allowed 0.05 rad/s", FINER)),
]  # fmt: skip


@pytest.mark.parametrize(("check", "missed", "expected"), INTERVALS)
def test_what_an_interval_misses(
    check: Callable[[Any], Checks], missed: Defects, expected: tuple[Any, ...]
) -> None:
    assert told(check(evidence())) == []
    assert told(check(evidence(missed=missed))) == close(expected)


def test_a_vehicle_without_rates_misses_none() -> None:
    """Two coordinates in metres: no angle, no rate."""
    cart = Plan(
        TIME, np.zeros((4, 2)), np.zeros((4, 2)), np.zeros((3, 1)), np.zeros(4), "hold", ("x", "y"), ("m", "m"), ("u",), ("N",)
    )  # fmt: skip
    missed = Defects(np.full((3, 2), 0.3), np.full((3, 2), 0.4))
    found = [
        *defect_rate(evidence(cart, missed=missed, planned={})),
        *defect_angle(evidence(cart, missed=missed, planned={})),
    ]
    assert [(check.name, check.value, check.ok) for check in found] == [
        ("defect_rate", 0.0, True),
        ("defect_angle", 0.0, True),
    ]


# --- nodes ---------------------------------------------------------------------------------------------------


def bent(name: str, row: int, column: int, by: float) -> Plan:
    plan = resting()
    return replace(plan, **{name: off(getattr(plan, name), row, column, by)})  # type: ignore[arg-type]


AT_NODES: list[tuple[Callable[[Any], Checks], Plan, tuple[Any, ...]]] = [
    (planned_start, bent("configuration", 0, Y, -0.1), (
        "planned_start", 0.1, 1e-6, "m", "distance of planned 'y' from the start reaches 0.1 m, allowed 1e-06 m", ACCURACY)),
    (planned_start, bent("velocity", 0, PITCH, -0.2), (
        "planned_start_rest", 0.2, 1e-6, "rad/s", "planned rate of 'pitch' at the start reaches 0.2 rad/s, allowed 1e-06 rad/s",
        ACCURACY)),
    (planned_end, bent("configuration", 3, ARM, 0.1), (
        "planned_end", 0.1, 1e-6, "rad", "distance of planned 'arm' from the end reaches 0.1 rad, allowed 1e-06 rad", ACCURACY)),
    (planned_end, bent("velocity", 3, Z, 0.2), (
        "planned_end_rest", 0.2, 1e-6, "m/s", "planned rate of 'z' at the end reaches 0.2 m/s, allowed 1e-06 m/s", ACCURACY)),
    (planned_limits, bent("configuration", 1, ARM, 0.6), (
        "planned_configuration", np.pi / 2 + 0.6 - 2 * np.pi / 3, 1e-6, "rad",
        "planned configuration 'arm' exceeds its limits by 0.0764012 rad at node 1, allowed 1e-06 rad", ACCURACY)),
    (planned_limits, bent("velocity", 2, X, -1.5), (
        "planned_velocity", 0.2, 1e-6, "m/s", "planned velocity 'x' exceeds its limits by 0.2 m/s at node 2, allowed 1e-06 m/s",
        ACCURACY)),
    (planned_limits, bent("inputs", 2, 4, 2.5), (
        "planned_input", 0.5, 1e-6, "N m", "planned input 'servo' exceeds its limits by 0.5 N m in row 2, allowed 1e-06 N m",
        ACCURACY)),
]  # fmt: skip


@pytest.mark.parametrize(("check", "plan", "expected"), AT_NODES)
def test_what_is_wrong_at_a_node(
    check: Callable[[Any], Checks], plan: Plan, expected: tuple[Any, ...]
) -> None:
    assert told(check(evidence())) == []
    assert told(check(evidence(plan))) == close(expected)


def test_a_start_in_flight_is_told_from_one_at_rest() -> None:
    moving = task(start_velocity={"x": 0.25})
    assert told(planned_start(evidence(bent("velocity", 0, X, 0.25), scenario=moving))) == []
    expected = "planned rate of 'x' at the start beside the given one reaches 0.25 m/s, allowed 1e-06 m/s"
    (found,) = told(planned_start(evidence(scenario=moving)))
    assert found[:5] == ("planned_start_rest", 0.25, 1e-6, "m/s", expected)


def test_only_quaternions_are_asked_for_their_length() -> None:
    assert list(planned_quaternion(evidence())) == []
    names = ("qz", "x", "qw", "qx", "qy")
    turned = np.array(
        [[0.6, 9.0, 0.8, 0, 0], [0, 9.0, 0, 1, 0], [0.5, 9.0, 0.5, 0.5, -0.5], [0, 9.0, 0, 0, 1.25]]
    )
    plan = Plan(
        TIME, turned, np.zeros((4, 1)), np.zeros((3, 1)), np.zeros(4), "hold", names, ("1", "m", "1", "1", "1"), ("u",), ("N",),
        ("x",), ("m/s",),
    )  # fmt: skip
    assert told(planned_quaternion(evidence(plan, planned={}))) == close(
        (
            "planned_quaternion",
            0.25,
            1e-6,
            "1",
            "error of a quaternion's length reaches 0.25 at node 3, allowed 1e-06",
            ACCURACY,
        )
    )
    unit = replace(plan, configuration=turned / [[1], [1], [1], [1.25]] * [[1, 0, 1, 1, 1]])
    assert told(planned_quaternion(evidence(unit, planned={}))) == []


# --- the replay ----------------------------------------------------------------------------------------------


def flying(name: str, row: int, column: int, by: float) -> Replay:
    flight = evidence().flight
    return replace(flight, **{name: off(getattr(flight, name), row, column, by)})


def test_a_replay_that_breaks_down_says_when() -> None:
    broken = replace(evidence().flight, broken_at=1.25)
    found = breakdown(evidence(flight=broken))
    reason = "the replay diverges or cannot be integrated any further at t=1.250 s"
    assert found == Check("replay_complete", 1.25, np.inf, "s", False, reason, FINER)
    assert breakdown(evidence(flight=replace(broken, broken_at=0.0))).value == 0.0


def test_what_leaves_its_limits_on_the_replay() -> None:
    room = {
        "room": Limited.of(
            task(workspace={"x": (-1.0, 1.0)}).limits(MODEL),
            flying("configuration", 3, X, -1.01).configuration,
        )
    }
    assert told(replay_position(evidence(**room))) == close(
        (
            "replay_position",
            0.01,
            0.005,
            "m",
            "'x' exceeds its limits by 0.01 m on the replay at t=1.000 s, allowed 0.005 m",
            FINER,
        )
    )
    assert told(replay_angle(evidence(**room))) == []
    tilted = evidence(flight=flying("configuration", 5, PITCH, np.pi / 4 + 0.03))
    assert told(replay_angle(tilted)) == close(
        ("replay_angle", 0.03, 0.02, "rad", "'pitch' exceeds its limits by 0.03 rad on the replay at t=1.750 s, allowed 0.02 rad",
         FINER)
    )  # fmt: skip
    assert told(replay_position(tilted)) == []
    fast = evidence(flight=flying("velocity", 1, YAW, -2.2))
    assert told(replay_rate(fast)) == close(
        ("replay_rate", 1.1, 1.05, "times its limit",
         "rate of 'yaw' reaches 1.1 times its limit on the replay at t=0.250 s, allowed 1.05 times its limit", RATE)
    )  # fmt: skip


def test_a_room_without_angles_is_asked_for_none() -> None:
    flat = Limited(("x",), ("m",), np.zeros((7, 1)), np.zeros(1), np.zeros(1))
    assert list(replay_angle(evidence(room=flat))) == []
    assert [check.ok for check in replay_position(evidence(room=flat))] == [True]


ENDS: list[tuple[str, int, float, tuple[Any, ...]]] = [
    ("configuration", Y, 0.03, ("replay_end", 0.03, 0.02, "m",
     "distance from the end on the replay reaches 0.03 m, allowed 0.02 m", FINER)),
    ("configuration", YAW, -0.06, ("replay_end_angle", 0.06, 0.05, "rad",
     "angle from the end on the replay reaches 0.06 rad, allowed 0.05 rad", FINER)),
    ("velocity", YAW, 0.2, ("replay_end_rest", 0.1, 0.05, "times its limit",
     "rate of 'yaw' at the end of the replay reaches 0.1 times its limit, allowed 0.05 times its limit", FINER)),
]  # fmt: skip


@pytest.mark.parametrize(("name", "column", "by", "expected"), ENDS)
def test_how_the_replay_ends(name: str, column: int, by: float, expected: tuple[Any, ...]) -> None:
    assert told(replay_end(evidence())) == []
    assert told(replay_end(evidence(flight=flying(name, 6, column, by)))) == close(expected)
    assert told(replay_end(evidence(flight=flying(name, 5, column, by)))) == []


def test_numbers_of_the_record_are_the_worst_of_the_flight() -> None:
    flight = replace(flying("configuration", 2, Z, -0.5), velocity=off(np.zeros((7, 7)), 3, X, -0.65))
    flight = replace(
        flight, configuration=off(flight.configuration, 3, Z, 9.0)
    )  # between nodes there is no plan
    missed = missing(1, q_x=0.3, q_y=0.4, q_yaw=0.2, q_arm=-0.3)
    assert flown(evidence(flight=flight, missed=missed)) == pytest.approx(
        {
            "replay_defect_position_m": 0.5,
            "replay_defect_angle_rad": 0.3,
            "replay_drift_position_m": 0.5,
            "max_rate_ratio": 0.5,
        }
    )


# --- soundness and the problem -------------------------------------------------------------------------------


@pytest.mark.parametrize("field", ["time", "configuration", "velocity", "inputs", "progress"])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_numbers_that_are_none(field: str, bad: float) -> None:
    broken = getattr(resting(), field).copy()
    broken[2] = bad
    found = list(finite(replace(resting(), **{field: broken})))
    assert [check.name for check in found] == [
        f"finite_{name}" for name in ("time", "configuration", "velocity", "inputs", "progress")
    ]
    count = float(broken[2].size)
    assert told(iter(found)) == [
        (f"finite_{field}", count, 0.0, "1", f"the plan's {field} is not a number in row 2", RESTART)
    ]
    assert all(check.value == 0.0 and check.advice == RESTART for check in found if check.ok)


@pytest.mark.parametrize(
    ("time", "step"),
    [((0, 1, 1, 2), 0.0), ((0, 1, 0.75, 2), -0.25), ((0.5, 1, 2, 3), 0.5), ((-1, 0, 1, 1.5), 0.5)],
)
def test_time_starts_at_zero_and_increases(time: tuple[float, ...], step: float) -> None:
    expected = f"time must start at 0 and increase, but its smallest step is {step:g} s"
    assert told(increasing(replace(resting(), time=np.array(time)))) == [
        ("time", step, 0.0, "s", expected, RESTART)
    ]
    (fine,) = increasing(resting())
    assert fine == Check("time", 0.5, 0.0, "s", True, "", RESTART)


PROBLEMS: list[tuple[dict[str, Any], tuple[Any, ...]]] = [
    ({"cost": np.inf}, ("finite_cost", np.inf, 0.0, "1", "the cost at this point is inf, which is no finite number", SOLVE)),
    ({"constraints": {"a": 1e-9, "b": 0.5}}, (
        "residual", 0.5, 1e-6, "1", "violation of the original problem (worst in 'b') reaches 0.5, allowed 1e-06", SOLVE)),
    ({"pairs": {"p": PairResidual(0.0, 0.25, 1e-9)}}, (
        "complementarity", 0.25, 0.2, "1", "violation of the complementarity pairs reaches 0.25, allowed 0.2", SHARPEN)),
    ({"pairs": {"p": PairResidual(0.125, 0.0, 1e-9)}}, (
        "complementarity_sign", 0.125, 1e-6, "1",
        "violation of the signs of the complementarity pairs reaches 0.125, allowed 1e-06", SHARPEN)),
    ({"pairs": {"p": PairResidual(0.0, 1e-9, 2.0)}}, (
        "complementarity_product", 2.0, 1e-5, "1", "product of a complementarity pair reaches 2, allowed 1e-05", SHARPEN)),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "expected"), PROBLEMS)
def test_what_is_said_of_the_original_problem(changes: dict[str, Any], expected: tuple[Any, ...]) -> None:
    limits = LIMITS.model_copy(update={"product": 1e-5, "complementarity": 0.2})
    assert told(original_problem(SOLVED, limits)) == []
    assert told(original_problem(replace(SOLVED, **changes), limits)) == [expected]


# --- contacts ------------------------------------------------------------------------------------------------


def stop(name: str = "a", prefix: str = "a_", **fields: Any) -> Stop:
    """Of x at the event and of y all the time; two nodes of a grid of four intervals of half a second."""
    contacts = fields.pop("contacts", {"x": Told(0), "path": Told(1, 0.25, kept="always")})
    fields = {"counted": (1, 4)} | fields
    return Stop(
        name,
        Polynomial(0.0, np.zeros((1, 3))),
        contacts,
        fields.pop("kappa_init", 2),
        prefix=prefix,
        **fields,
    )


def found_at(of: Stop, window: tuple[int, int] | None = (1, 2), **changes: Any) -> Audit:
    """Gaps of 0.125 everywhere, contact claimed and made at nodes 1 and 2."""
    dense = np.zeros(7, bool)
    if window is not None:
        dense[NODES[window[0]] : NODES[window[1]] + 1] = True
    progress = np.array([0.0, 1.0, 1.0, 0.0])
    fields: dict[str, Any] = {
        "planned": {name: np.full(4, 0.125) for name in of.contacts},
        "replayed": {name: np.full(7, 0.125) for name in of.contacts},
        "progress": progress, "claims": progress > 0, "dense": dense,
    }  # fmt: skip
    return Audit(of, window=window, **(fields | changes))


def gaps(count: int, at: int, gap: float, **others: float) -> dict[str, Array]:
    """Of both conditions, that of x larger at one place."""
    x = np.full(count, 0.125)
    x[at] = gap
    return {"x": x, "path": np.full(count, 0.125)}


def along(count: int, at: int, gap: float) -> dict[str, Array]:
    return {"x": np.full(count, 0.125), "path": gaps(count, at, gap)["x"]}


CONTACTS: list[tuple[Callable[[Any], Checks], Audit, tuple[Any, ...]]] = [
    (contact_planned, found_at(stop(), planned=gaps(4, 2, 0.75), progress=np.array([0, 1, 0.25, 0]) + 0.875), (
        ("contact_node_x", 0.75, 0.500001, "m",
         "node 2 claims contact of 'a' with epsilon 1.12 but its gap is 0.75 m, allowed 0.5 m", SHARPEN_OR_GUESS),)),
    (contact_planned, found_at(stop(), planned=along(4, 3, 0.75)), (
        ("path_path", 0.75, 0.250001, "m", "gap of 'a' reaches 0.75 m at node 3, allowed 0.250001 m", PATH),)),
    (contact_planned, found_at(stop(kappa_init=3), progress=np.array([1.0, 1.5, 1.5, 1.0])), (
        ("contact_steps", 2.0, 3, "nodes",
         "the longest contact of 'a' that holds every condition is only 2 nodes, required 3 nodes", PHASES_OR_SHARPEN),)),
    (contact_planned, found_at(stop(), progress=np.array([1.0, 0.5, 1.0, 1.0])), (
        ("contact_progress", 1.5, 2, "1", "the progress made in that contact of 'a' is only 1.5, required 2",
         PHASES_OR_RELAXATION),)),
    (contact_planned, found_at(stop(contact_seconds=1.25)), (
        ("contact_seconds", 1.0, 1.25, "s", "the longest contact of 'a' that holds every condition is only 1 s, required 1.25 s",
         SECONDS),)),
    (contact_planned, found_at(stop(counted=None), (2, 3), progress=np.array([0.0, 0.0, 1.0, 1.0])), (
        ("contact_seconds", 0.5, 2 / 3, "s",
         "the longest contact of 'a' that holds every condition is only 0.5 s, required 0.666667 s", SECONDS),)),
    (contact_planned, found_at(stop("target", "", kappa_init=1, contact_seconds=0.5), None, progress=np.full(4, 0.5)), (
        ("contact_steps", 0.0, 1, "nodes",
         "the longest contact that holds every condition is only 0 nodes, required 1 nodes", PHASES_OR_SHARPEN),
        ("contact_progress", 0.0, 1, "1", "the progress made in that contact is only 0, required 1", PHASES_OR_RELAXATION),
        ("contact_seconds", 0.0, 0.5, "s", "the longest contact that holds every condition is only 0 s, required 0.5 s",
         SECONDS))),
    (contact_flown, found_at(stop(), replayed=gaps(7, 3, 0.75)), (
        ("contact_x", 0.75, 0.500001, "m",
         "gap in contact of 'a' reaches 0.75 m on the replay at t=1.000 s, allowed 0.500001 m", CONTACT),)),
    (contact_flown, found_at(stop(), replayed=along(7, 6, 0.75)), (
        ("replay_path_path", 0.75, 0.250001, "m",
         "gap of 'a' reaches 0.75 m on the replay at t=2.000 s, allowed 0.250001 m", FINER),)),
]  # fmt: skip


def asked(
    audits: tuple[Audit, ...], limits: Limits = LIMITS, plan: Plan | None = None, **scenario: Any
) -> ContactEvidence:
    stops = {one.stop.name: {"target": one.stop.target} for one in audits} or {"a": {"target": stop().target}}
    return evidence(plan, audits=audits, limits=limits, scenario=task(stops=stops, **scenario))


@pytest.mark.parametrize(("check", "audit", "expected"), CONTACTS)
def test_what_is_said_of_one_contact(
    check: Callable[[Any], Checks], audit: Audit, expected: tuple[Any, ...]
) -> None:
    assert told(check(asked((found_at(stop()),)))) == []
    assert told(check(asked((audit,)))) == close(*expected)


@pytest.mark.parametrize(("more", "enough"), [(5e-7, True), (2e-6, False)])
def test_what_is_missing_by_rounding_is_forgiven(more: float, enough: bool) -> None:
    """Of the progress as much as four nodes may hide besides; a second lies between the nodes of the contact."""
    hidden = 4 * LIMITS.contact_claim + more
    audit = found_at(stop(), progress=np.array([0.0, 1.0, 1.0 - hidden, 0.0]))
    assert (told(contact_planned(asked((audit,)))) == []) == enough
    lasting = found_at(stop(contact_seconds=1.0 + more))
    assert (told(contact_planned(asked((lasting,)))) == []) == enough


def test_gaps_count_where_contact_is_claimed_or_made() -> None:
    """A gap at a node that claims nothing, and on the replay outside the window."""
    here = found_at(stop(), planned=gaps(4, 0, 0.75), replayed=gaps(7, 1, 0.75))
    assert told(contact_planned(asked((here,)))) == told(contact_flown(asked((here,)))) == []


def test_a_gap_as_large_as_its_limit_holds() -> None:
    edge = {"x": np.full(4, 0.5 + LIMITS.node), "path": np.full(4, 0.25 + LIMITS.node)}
    assert told(contact_planned(asked((found_at(stop(), planned=edge),)))) == []
    dense = {name: np.full(7, gap[0]) for name, gap in edge.items()}
    assert told(contact_flown(asked((found_at(stop(), replayed=dense),)))) == []


def test_what_the_limits_allow_more_on_the_replay() -> None:
    allowing = LIMITS.model_copy(update={"contact_allowance": {"x": 0.25, "path": 0.5}})
    audits = (found_at(stop(), replayed={"x": np.full(7, 0.75), "path": np.full(7, 0.75)}),)
    assert told(contact_flown(asked(audits, allowing))) == []
    assert [check.limit for check in contact_flown(asked(audits, allowing))] == [0.75, 0.75]
    assert len(told(contact_flown(asked(audits)))) == 2


def test_stops_that_need_not_be_made_are_not_asked_for_length() -> None:
    """Optional and not claimed: its path condition still holds all the time."""
    silent = found_at(stop(reward=1.0), None, progress=np.zeros(4), claims=np.zeros(4, bool))
    names = [check.name for check in contact_planned(optional(silent))]
    assert names == ["path_path"]
    assert [check.name for check in contact_flown(optional(silent))] == ["replay_path_path"]
    short = found_at(stop(reward=1.0), (1, 1))
    assert [entry[0] for entry in told(contact_planned(optional(short)))] == [
        "contact_steps",
        "contact_progress",
        "contact_seconds",
    ]
    only_path = found_at(stop(contacts={"path": Told(1, kept="always")}))
    assert [check.name for check in contact_planned(asked((only_path,)))] == ["path_path"]


def optional(*audits: Audit) -> ContactEvidence:
    stops = {one.stop.name: {"target": one.stop.target, "reward": 1.0} for one in audits}
    return evidence(audits=audits, scenario=task(stops=stops, visit="optional"))


# --- stops ---------------------------------------------------------------------------------------------------


def two(first: tuple[int, int] | None, second: tuple[int, int] | None) -> tuple[Audit, Audit]:
    none = {"progress": np.zeros(4), "claims": np.zeros(4, bool)}
    return tuple(  # type: ignore[return-value]
        found_at(stop(name), window, **({} if window else none))
        for name, window in (("a", first), ("b", second))
    )


def test_exactly_one_stop_where_that_is_asked() -> None:
    for windows, names, count in (((None, None), "none", 0), (((0, 1), (2, 3)), "a, b", 2)):
        reason = f"exactly one stop is asked for, but the plan claims {names}"
        assert told(stop_choice(asked(two(*windows), visit="one"))) == [
            ("stop_choice", count, 1, "stops", reason, "")
        ]
    for windows in (((0, 1), None), (None, (2, 3))):
        assert list(stop_choice(asked(two(*windows), visit="one"))) == [
            Check("stop_choice", 1, 1, "stops", True)
        ]
    assert list(stop_choice(asked(two((0, 1), (2, 3))))) == []


def test_stops_of_a_fixed_order_follow_each_other() -> None:
    reason = "'b' is made from t=0.500 s on, before 'a' is over at t=1.500 s, but the order is fixed"
    late = two((1, 2), (1, 3))
    assert told(stop_order(asked(late))) == [("stop_order", 0.5, 1.5, "s", reason, "")]
    assert list(stop_order(asked(late, order="free"))) == []
    (same,) = told(stop_order(asked(two((0, 1), (1, 2)))))
    assert same[4].startswith("'b' is made from t=0.500 s on, before 'a' is over at t=0.500 s")
    assert list(stop_order(asked(two((0, 1), (2, 3))))) == [Check("stop_order", 1.5, 0.5, "s", True)]
    assert list(stop_order(asked(two(None, (1, 2))))) == []


# --- checks and records as such -----------------------------------------------------------------------------


def test_a_limit_from_above() -> None:
    assert at_most("a", "the way", 2.0, 2.0, "m", advice="x") == Check("a", 2.0, 2.0, "m", True, "", "x")
    reason = "the way grows to 2.5 m at noon, allowed 2 m"
    assert at_most("a", "the way", 2.5, 2.0, "m", " at noon", "grows to", advice="x") == Check(
        "a", 2.5, 2.0, "m", False, reason, "x"
    )
    assert at_most("a", "b", 5.0, 4.0, "").reason == "b reaches 5, allowed 4"
    short = "b reaches 0.123457, allowed 0"
    assert at_most("a", "b", 0.1234567, 0.0, "1") == Check("a", 0.1234567, 0.0, "1", False, short)
    assert Check("a", 0.0, 1.0, "1", True) == Check("a", 0.0, 1.0, "1", True, "", "")
    none = at_most("a", "the way", np.nan, 2.0, "m", " at noon", advice="x")
    assert (none.reason, none.ok, none.advice) == ("the way is not a number at noon", False, "x")
    assert (none.name, none.limit, none.unit) == ("a", 2.0, "m") and np.isnan(none.value)


def test_a_limit_from_below() -> None:
    assert at_least("a", "the way", 1.5, 2.0, "m", 0.5, advice="x") == Check(
        "a", 1.5, 2.0, "m", True, "", "x"
    )
    assert at_least("a", "the way", 2.0, 2.0, "m").ok and not at_least("a", "the way", 1.99, 2.0, "m").ok
    reason = "the way is only 1.25 m, required 2 m"
    assert at_least("a", "the way", 1.25, 2.0, "m", 0.5, advice="x") == Check(
        "a", 1.25, 2.0, "m", False, reason, "x"
    )
    assert not at_least("a", "b", np.nan, 0.0, "1").ok
    assert at_least("a", "b", 0.0, 1.0, "1") == Check("a", 0.0, 1.0, "1", False, "b is only 0, required 1")


def test_the_worst_value_and_its_place() -> None:
    assert worst(np.array([[1.0, 5.0], [7.0, 2.0]])) == (7.0, (1, 0))
    value, place = worst(np.array([1.0, np.nan, 9.0]))
    assert np.isnan(value) and place == (1,)


def test_what_is_not_finite_is_none_in_the_record() -> None:
    measures = Measures(
        max_violation=np.nan, max_product=2.0, contact_gaps={"a": np.inf, "b": 0.5}, gates=3, stops=("a",)
    )
    advised = tuple(
        Check(n, 1.0, 0.0, "1", n == "fine", f"{n} it is", a)
        for n, a in (("fine", "x"), ("bad", ""), ("worse", "y"))
    )
    found = Certificate(advised, measures, None)
    record = found.record()
    assert (record["certified"], record["reasons"], record["advice"]) == (
        False,
        ("bad it is", "worse it is"),
        "y",
    )
    assert (record["max_violation"], record["max_product"], record["contact_gaps"]) == (
        None,
        2.0,
        {"a": None, "b": 0.5},
    )
    assert (record["gates"], record["stops"], record["reward_s"]) == (3, ("a",), None)
    assert Certificate((), Measures(), None).record()["advice"] == ""
