"""What the certificate says of a vehicle that hovers while a target passes its tool: everything can be written down.

The target goes through the tool at t = 2 s, at a constant velocity; the plan has 10 intervals of 0.4 s.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from flights import REST, Polynomial, plan_of, table_one
from test_certificate import LIMITS, SOLVED
from test_race_certificate import broken, only

from benchbench.certificate import advice
from benchbench.certificate.audit import claimed
from benchbench.certificate.certificate import Certificate
from benchbench.certificate.certify import certify
from benchbench.certificate.limits import Limits
from benchbench.mpcc.residuals import Residuals
from benchbench.ocp.handover import Handover
from benchbench.ocp.plan import Plan
from benchbench_plugins.contacts.floor import Floor
from benchbench_plugins.contacts.heading import Heading
from benchbench_plugins.contacts.position import Position
from benchbench_plugins.contacts.velocity import Velocity

MODEL = table_one()
TIP = REST[:3] - [0.0, 0.0, 0.05 + 0.182]
N, STEP = 10, 0.4
TIME = STEP * np.arange(N + 1)
SLOW = (0.008, 0.0, 0.0)
ALL = {"position": Position(0.02), "velocity": Velocity(0.01), "heading": Heading(0.1)}
NEAR = {"position": Position(0.02)}


def hover(*nodes: int, progress: float = 1.0) -> Plan:
    """At rest; claims contact at these nodes."""
    still = np.zeros((N + 1, 7))
    plan = plan_of(MODEL, TIME, np.tile(REST, (N + 1, 1)), still, np.tile(MODEL.hover(), (N, 1)))
    plan.progress[list(nodes)] = progress
    return plan


def passing(velocity: Sequence[float], at: float = 2.0) -> Polynomial:
    return Polynomial(at, np.array([TIP, velocity]))


def task(velocity: Sequence[float] = SLOW, **changes: Any) -> Handover:
    here = dict(zip(MODEL.configuration.names, REST, strict=True))
    fields: dict[str, Any] = {"name": "hover", "start": here, "end": here, "contacts": ALL}
    if "stops" not in changes:
        fields["target"] = passing(velocity)
    return Handover(**(fields | changes))


def judged(
    plan: Plan, velocity: Sequence[float] = SLOW, limits: Limits = LIMITS, residuals: Residuals | None = None, **changes: Any
) -> Certificate:  # fmt: skip
    return certify(plan, task(velocity, **changes), MODEL, limits, residuals)


CHECKS = {
    **{f"finite_{name}": (0.0, "1", advice.RESTART) for name in ("time", "configuration", "velocity", "inputs", "progress")},
    "time": (0.0, "s", advice.RESTART),
    "finite_cost": (0.0, "1", advice.SOLVE), "residual": (1e-6, "1", advice.SOLVE), "complementarity": (1e-6, "1", advice.SHARPEN),
    "complementarity_sign": (1e-6, "1", advice.SHARPEN), "complementarity_product": (1e-5, "1", advice.SHARPEN),
    "planned_start": (1e-6, "m", advice.ACCURACY), "planned_start_rest": (1e-6, "m/s", advice.ACCURACY),
    "planned_end": (1e-6, "m", advice.ACCURACY), "planned_end_rest": (1e-6, "m/s", advice.ACCURACY),
    "planned_configuration": (1e-6, "m", advice.ACCURACY), "planned_velocity": (1e-6, "m/s", advice.ACCURACY),
    "planned_input": (1e-6, "N", advice.ACCURACY),
    "defect_position": (0.005, "m", advice.FINER), "defect_angle": (0.02, "rad", advice.FINER),
    "defect_velocity": (0.01, "m/s", advice.FINER), "defect_rate": (0.05, "rad/s", advice.FINER),
    "contact_node_position": (0.020001, "m", advice.SHARPEN_OR_GUESS),
    "contact_node_velocity": (0.010001, "m/s", advice.SHARPEN_OR_GUESS),
    "contact_node_heading": (0.100001, "rad", advice.SHARPEN_OR_GUESS),
    "contact_steps": (2.0, "nodes", advice.PHASES_OR_SHARPEN), "contact_progress": (2.0, "1", advice.PHASES_OR_RELAXATION),
    "contact_seconds": (0.4, "s", advice.SECONDS),
    "replay_position": (0.005, "m", advice.FINER), "replay_angle": (0.02, "rad", advice.FINER),
    "replay_rate": (1.05, "times its limit", advice.RATE),
    "replay_end": (0.02, "m", advice.FINER), "replay_end_angle": (0.05, "rad", advice.FINER),
    "replay_end_rest": (0.05, "times its limit", advice.FINER),
    "contact_position": (0.020001, "m", advice.CONTACT), "contact_velocity": (0.015, "m/s", advice.CONTACT),
    "contact_heading": (0.101, "rad", advice.CONTACT),
}  # fmt: skip
"""All that a handover is asked, in order: limit, unit, what helps."""


def test_all_that_is_asked() -> None:
    """Contact at 1.6 s and 2 s; the target is 3.2 mm away at the first and goes 8 mm/s."""
    product = LIMITS.model_copy(update={"product": 1e-5})
    found = judged(hover(4, 5), limits=product, residuals=SOLVED, contact_seconds=0.4)
    assert found.reasons == ()
    told = {check.name: (pytest.approx(check.limit), check.unit, check.advice) for check in found.checks}
    assert told == CHECKS
    assert [check.name for check in found.checks] == list(CHECKS)
    values = {check.name: check.value for check in found.checks}
    expected = {
        "time": 0.4, "residual": 1e-9, "complementarity": 1e-9, "complementarity_product": 1e-9,
        "contact_node_position": 0.0032, "contact_node_velocity": 0.008, "contact_steps": 2, "contact_progress": 2,
        "contact_seconds": 0.4, "contact_position": 0.0032, "contact_velocity": 0.008,
    }  # fmt: skip
    assert values == pytest.approx({name: expected.get(name, 0.0) for name in values}, abs=1e-8)


def test_passage_through_the_ball_is_told() -> None:
    """The target sinks from 16 mm above the end effector, which is so deep in the ball below it."""
    assert judged(hover(4, 5), (0, 0, -0.008)).record()["passage_m"] == pytest.approx(0.016)
    assert judged(hover(4, 5), (0, 0, -0.008), ball_radius=0.008).record()["passage_m"] == pytest.approx(
        0.008
    )
    far = judged(hover(4, 5), magnet_reach=1e-3).record()
    reached = 2.0 - np.sqrt(31**2 - 30**2) / 8  # where the centre of the ball is 31 mm away, at 8 mm/s
    assert far["touch_before_s"] == pytest.approx(1.6 - reached, abs=0.03)  # samples are 25 ms apart


def test_the_numbers_of_the_record() -> None:
    found = judged(hover(4, 5, 6, 7), residuals=SOLVED).record()
    expected = {
        "certified": True, "reasons": (), "advice": "", "max_violation": 1e-9, "max_complementarity": 1e-9,
        "max_product": 1e-9, "contact_start_s": 1.6, "contact_end_s": 2.8, "contact_duration_s": 1.2, "contact_steps": 4,
        "contact_gaps": {"position": pytest.approx(0.0064), "velocity": pytest.approx(0.008), "heading": 0.0},
        "replay_defect_position_m": 0.0, "replay_defect_angle_rad": 0.0, "replay_drift_position_m": 0.0,
        "replay_end_error_m": 0.0, "max_rate_ratio": 0.0, "stops": ("target 1.600 to 2.800 s",), "reward_s": 0.0,
        "gate_worst_miss_m": None, "gates": None, "gates_passed": None, "costs": None,
        "touch_speed_mps": pytest.approx(0.008), "touch_before_s": pytest.approx(1.6), "passage_m": 0.0,
    }  # fmt: skip
    (distance, speed, _) = found.pop("contact_gaps_said")
    assert "6.4" in distance and "8" in speed
    used, said = found.pop("limits_used"), found.pop("limits_used_said")
    assert used["contact_position"] == pytest.approx(0.0064 / 0.020001) and used["residual"] == pytest.approx(
        1e-3
    )
    assert used["contact_velocity"] == pytest.approx(0.008 / 0.015)  # 0.01 m/s, and 0.005 m/s are granted
    assert said == ("relative speed in contact 0.008 of 0.015 m/s",)
    assert found.keys() == expected.keys()
    numbers = {k: v for k, v in expected.items() if isinstance(v, float)}
    assert {k: found[k] for k in numbers} == pytest.approx(numbers, abs=1e-8)
    assert {k: found[k] for k in expected.keys() - numbers.keys()} == {
        k: v for k, v in expected.items() if k not in numbers
    }
    idle = judged(hover()).record()
    assert (idle["contact_steps"], idle["stops"], idle["reward_s"], idle["contact_start_s"]) == (
        0,
        (),
        0.0,
        None,
    )
    assert idle["contact_gaps"] is None and idle["certified"] is False


PLANNED: tuple[tuple[Plan, dict[str, Any], dict[str, float], tuple[str, ...]], ...] = (
    (hover(4, 5), {"velocity": (0.012, 0, 0)}, {"contact_node_velocity": 0.012, "contact_steps": 0, "contact_progress": 0, "contact_seconds": 0},
     ("node 4 claims contact with epsilon 1 ", "relative speed is 0.012 m/s, allowed 0.01 m/s", "only 0 nodes, required 2 nodes",
      "only 0, required 2")),
    (hover(4, 5), {"velocity": (0.008 * np.cos(0.2), 0.008 * np.sin(0.2), 0)},
     {"contact_node_heading": 0.2, "contact_steps": 0, "contact_progress": 0, "contact_seconds": 0}, ("heading error is 0.2 rad, allowed 0.1 rad",)),
    (hover(3, 4, 5, 6, 8), {"velocity": (0.05, 0, 0), "contacts": NEAR}, {"contact_node_position": 0.06},
     ("node 8 claims contact with epsilon 1 ", "distance is 0.06 m, allowed 0.02 m")),
    (hover(4, 5, progress=0.7), {}, {"contact_progress": 1.4}, ("only 1.4, required 2",)),
    (hover(4, 5, 6, progress=0.7), {}, {}, ()),
    (hover(4, 5), {"contact_seconds": 0.41}, {"contact_seconds": 0.4}, ("only 0.4 s, required 0.41 s",)),
    (hover(), {"contact_seconds": 0.1}, {"contact_steps": 0, "contact_progress": 0, "contact_seconds": 0.0}, ("only 0 s",)),
    (hover(4), {}, {"contact_steps": 1, "contact_progress": 1, "contact_seconds": 0}, ("only 1 nodes", "only 0 s, required 0.04 s")),
    (hover(4, 5), {"kappa_init": 3}, {"contact_steps": 2, "contact_progress": 2}, ("required 3 nodes", "required 3")),
    # nodes of a grid of ten intervals of 0.4 s: as many steps of this one, or half as many of a coarser one, that last as long
    (hover(4, 5), {"kappa_init": 3, "intervals": 10},
     {"contact_steps": 2, "contact_progress": 2, "contact_seconds": 0.4}, ("only 0.4 s, required 0.8 s",)),
    (hover(4, 5), {"kappa_init": 2, "intervals": 10, "kappa_grid": 5},
     {"contact_steps": 2, "contact_progress": 2, "contact_seconds": 0.4}, ("required 3 nodes", "only 0.4 s, required 0.8 s")),
    (hover(4, 5, 6), {"kappa_init": 2, "intervals": 10, "kappa_grid": 5}, {}, ()),
    (hover(4), {"kappa_init": 1}, {}, ()),
)  # fmt: skip


@pytest.mark.parametrize(("plan", "changes", "expected", "words"), PLANNED)
def test_what_is_said_of_contacts_at_the_nodes(
    plan: Plan, changes: dict[str, Any], expected: dict[str, float], words: tuple[str, ...]
) -> None:
    found = judged(plan, **changes)
    assert {check.name: check.value for check in found.broken} == pytest.approx(expected, abs=1e-7)
    assert all(word in " ".join(found.reasons) for word in words), found.reasons


def test_the_window_is_where_every_condition_holds() -> None:
    """At 50 mm/s the target is within 20 mm from 1.6 s to 2.4 s: three of five claimed nodes, and the replay between."""
    found = judged(hover(3, 4, 5, 6, 7), (0.05, 0, 0), contacts=NEAR)
    assert {c.name: c.value for c in found.broken} == pytest.approx({"contact_node_position": 0.04})
    assert "node 3 claims" in found.reasons[0] and "0.04 m" in found.reasons[0]
    assert (only(found, "contact_steps").value, only(found, "contact_progress").value) == (3, 3)
    assert only(found, "contact_position").value == pytest.approx(0.02)
    assert (found.measures.contact_start_s, found.measures.contact_end_s) == pytest.approx((1.6, 2.4))


@pytest.mark.parametrize(("height", "broken_at"), [(0.019, None), (0.021, 2.2)])
def test_contact_is_asked_for_between_the_nodes(height: float, broken_at: float | None) -> None:
    """A bump of the target between 2.0 s and 2.4 s, flat at both."""
    bump = np.zeros((5, 3))
    bump[2:, 2] = 16 * height * np.array([1 / 0.4**2, -2 / 0.4**3, 1 / 0.4**4])
    bump[0] = TIP
    found = judged(hover(5, 6), target=Polynomial(2.0, bump), contacts=NEAR)
    assert only(found, "contact_node_position").value == pytest.approx(0.0, abs=1e-9)
    assert only(found, "contact_position").value == pytest.approx(height, rel=1e-6)
    assert broken(found) == (set() if broken_at is None else {"contact_position"})
    if broken_at is not None:
        assert f"0.021 m on the replay at t={broken_at:.3f} s, allowed 0.020001 m" in found.reasons[0]


def two(**changes: Any) -> dict[str, Any]:
    """Stops a and b at one place, passed at 1 s and 3 s with 6 mm/s."""
    rewards = changes.pop("rewards", {})
    stops = {
        n: {"target": passing((0.006, 0, 0), t), "reward": rewards.get(n)}
        for n, t in (("a", 1.0), ("b", 3.0))
    }
    return {"stops": stops, **changes}


def visiting(a: Sequence[int], b: Sequence[int]) -> Plan:
    progress = np.zeros((N + 1, 2))
    progress[list(a), 0] = progress[list(b), 1] = 1.0
    return replace(hover(), progress=progress, stop_names=("a", "b"))


def test_two_stops_in_the_order_of_time() -> None:
    found = judged(visiting([6, 7, 8], [1, 2]), **two(order="free"))
    assert found.certified
    record = found.record()
    assert record["stops"] == ("b 0.400 to 0.800 s", "a 2.400 to 3.200 s")
    assert (record["contact_start_s"], record["contact_end_s"]) == pytest.approx((0.4, 3.2))
    assert record["contact_duration_s"] == pytest.approx(0.4) and record["contact_steps"] == 2
    # a is passed at 1 s and b at 3 s: 2.2 s and 2.6 s away at worst
    assert record["contact_gaps"]["position"] == pytest.approx(0.006 * 2.6)
    fixed = judged(visiting([6, 7, 8], [1, 2]), **two())
    (order,) = (check for check in fixed.checks if check.name == "stop_order")
    assert (order.value, order.limit, order.unit, order.ok) == (
        pytest.approx(0.4),
        pytest.approx(3.2),
        "s",
        False,
    )
    assert "'b' is made from t=0.400 s on, before 'a' is over at t=3.200 s" in order.reason


@pytest.mark.parametrize(
    ("a", "b", "ok"), [((1, 2), (3, 4), True), ((1, 2), (2, 3), False), ((3, 4), (1, 2), False)]
)
def test_stops_of_a_fixed_order_share_no_node(a: tuple[int, int], b: tuple[int, int], ok: bool) -> None:
    found = judged(visiting(a, b), **two())
    assert broken(found) == (set() if ok else {"stop_order"})
    order = only(found, "stop_order")
    assert (order.value, order.limit) == pytest.approx((STEP * b[0], STEP * a[1]))
    assert (order.reason == "") == ok


@pytest.mark.parametrize(
    ("a", "b", "value", "named"),
    [((1, 2), (), 1, ""), ((), (4, 5), 1, ""), ((), (), 0, "none"), ((1, 2), (4, 5), 2, "a, b")],
)
def test_one_stop_of_several(a: tuple[int, ...], b: tuple[int, ...], value: int, named: str) -> None:
    found = judged(visiting(a, b), **two(visit="one"))
    choice = only(found, "stop_choice")
    assert (choice.value, choice.limit, choice.unit, choice.ok) == (value, 1, "stops", value == 1)
    assert choice.reason.endswith(named) and bool(choice.reason) == bool(named)
    assert found.certified == (value == 1)


def test_rewards_are_added_up() -> None:
    both = two(visit="optional", rewards={"a": 0.5, "b": 0.25}, order="free")
    for a, b, reward in (((1, 2), (4, 5), 0.75), ((1, 2), (), 0.5), ((), (4, 5), 0.25), ((), (), 0.0)):
        found = judged(visiting(a, b), **both)
        assert found.certified and found.measures.reward_s == reward
        assert isinstance(found.measures.reward_s, float)
        assert found.measures.contact_steps == (2 if reward else 0)


def test_a_plan_without_numbers_is_asked_nothing_else_of_its_flight() -> None:
    plan = hover(4, 5)
    broken = plan.velocity.copy()
    broken[3, 1] = np.inf
    found = judged(replace(plan, velocity=broken), residuals=SOLVED)
    assert [check.name for check in found.broken] == ["finite_velocity"]
    assert [check.name for check in found.checks] == list(CHECKS)[:10]
    assert found.flight is None
    record = found.record()
    assert (record["max_violation"], record["max_product"]) == (1e-9, 1e-9)
    assert record["replay_end_error_m"] is None and record["max_rate_ratio"] is None


def test_how_far_the_flight_ends_from_its_end() -> None:
    """One per cent less thrust for the last 0.8 s: a fall of 3.14 cm, most of it at the very end."""
    plan = hover(4, 5)
    weak = plan.inputs.copy()
    weak[-2:, :4] *= 0.99
    found = judged(replace(plan, inputs=weak))
    assert found.record()["replay_end_error_m"] == pytest.approx(0.01 * 9.8066 * 0.8**2 / 2, rel=1e-3)
    assert only(found, "replay_end").value == found.record()["replay_end_error_m"]


def test_after_a_breakdown_the_flight_is_asked_for_nothing() -> None:
    """In the last interval the motors push with 10 km/s^2: the contact at 1.6 s and 2 s was flown, the end was not."""
    plan = hover(4, 5)
    pushed = plan.inputs.copy()
    pushed[-1, :4] *= 1000
    contacts = {"floor": Floor(), **NEAR}
    found = judged(replace(plan, inputs=pushed), contacts=contacts, residuals=SOLVED)
    names = [check.name for check in found.checks]
    assert names[-1] == "replay_complete" and not {"replay_end", "replay_rate", "contact_position"} & set(
        names
    )
    (said,) = (check for check in found.broken if check.name == "replay_complete")
    assert 3.6 < said.value <= 4.0 and f"at t={said.value:.3f} s" in said.reason
    assert found.flight is not None and found.flight.broken_at == said.value
    record = found.record()
    assert record["contact_gaps"] == {"floor": None, "position": pytest.approx(0.0032)}
    assert record["contact_gaps_said"] == ("3.2 mm apart",)
    assert record["replay_end_error_m"] is None and record["replay_defect_position_m"] is None


# --- claims for plans that make none --------------------------------------------------------------------------


def test_a_plan_without_claims_claims_what_it_holds() -> None:
    """At 50 mm/s nodes 4, 5, 6 are within 20 mm; each stop has its own."""
    plan, plant = hover(*range(N + 1), progress=np.nan), MODEL.plant()
    one = claimed(plan, task((0.05, 0, 0), contacts=NEAR).itinerary, plant, LIMITS)
    np.testing.assert_array_equal(one.progress, np.isin(np.arange(N + 1), [4, 5, 6]))
    assert one.stop_names == ("target",)
    fast = {n: {"target": passing((0.05, 0, 0), t)} for n, t in (("a", 1.2), ("b", 3.2), ("c", 9.0))}
    several = claimed(plan, task(stops=fast, contacts=NEAR).itinerary, plant, LIMITS)
    expected = np.zeros((N + 1, 3))
    expected[2:5, 0] = expected[7:10, 1] = 1.0
    np.testing.assert_array_equal(several.progress, expected)
    assert several.stop_names == ("a", "b", "c")


def test_claims_are_left_alone() -> None:
    plant = MODEL.plant()
    for plan in (hover(1), hover()):
        assert claimed(plan, task(contacts=NEAR).itinerary, plant, LIMITS) is plan


def test_a_plan_for_another_vehicle_is_refused() -> None:
    plan = hover(4, 5)
    for changes in ({"coordinate_names": tuple("abcdefg")}, {"input_names": tuple("abcde")}):
        with pytest.raises(ValueError, match="the plan moves"):
            judged(replace(plan, **changes))  # type: ignore[arg-type]
