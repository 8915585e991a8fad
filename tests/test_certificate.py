"""Good flights must be accepted, and each planted fault rejected with the reason that names it."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from flights import HEIGHT, MOTOR, REST, SHIFT, Polynomial, along_tool, bounce, crossing, surge, table_one
from pydantic import ValidationError

from benchbench.certificate.audit import longest_run
from benchbench.certificate.bound import lower_bound
from benchbench.certificate.certificate import Certificate
from benchbench.certificate.certify import certify, certify_problem
from benchbench.certificate.limits import Limits, ProblemLimits
from benchbench.certificate.replay import defects, replay
from benchbench.certificate.speed_bound import sequence_bound
from benchbench.ground.arrays import Array
from benchbench.mpcc.residuals import PairResidual, Residuals
from benchbench.ocp.handover import Handover
from benchbench.ocp.plan import Plan
from benchbench_plugins.contacts.floor import Floor
from benchbench_plugins.contacts.heading import Heading
from benchbench_plugins.contacts.position import Position
from benchbench_plugins.contacts.velocity import Velocity

TASK = yaml.safe_load((Path(__file__).parents[1] / "conf/certificate/task.yaml").read_text())
LIMITS = Limits(**{key: value for key, value in TASK.items() if key != "_target_"})
MODEL = table_one()
FIRST, LAST = 9, 10
SOLVED = Residuals(0.0, {"dynamics": 1e-9}, {"pair": PairResidual(0.0, 1e-9, 1e-9)})


def claimed(plan: Plan, *nodes: int, progress: float = 1.0) -> Plan:
    index = np.zeros(len(plan.time))
    index[list(nodes)] = progress
    return replace(plan, progress=index)


def task(plan: Plan, **changes: Any) -> Handover:
    """Meet a target that moves with the end effector around the middle of the flight."""
    names = MODEL.configuration.names
    fields: dict[str, Any] = {
        "name": "synthetic",
        "start": dict(zip(names, plan.configuration[0], strict=True)),
        "end": dict(zip(names, REST + SHIFT, strict=True)),
        "contacts": {"position": Position(), "velocity": Velocity(), "heading": Heading()},
    }
    if "target" not in changes:
        fields["target"] = along_tool(plan, MODEL.plant(), FIRST, LAST)
    return Handover(**(fields | changes))


def alone(plan: Plan, **changes: Any) -> Handover:
    """The flight without any contact, ending where the plan does."""
    end = dict(zip(MODEL.configuration.names, plan.configuration[-1], strict=True))
    nowhere = Polynomial(0.0, np.zeros((1, 3)))
    return task(plan, contacts={}, end=end, target=nowhere, **changes)


_CROSSING: list[Plan] = []


def crossing_plan() -> Plan:
    if not _CROSSING:
        _CROSSING.append(claimed(crossing(MODEL), FIRST, LAST))
    return _CROSSING[0]


@pytest.fixture
def good() -> Plan:
    return crossing_plan()


def only_reason(certificate: Certificate) -> str:
    assert not certificate.certified
    assert len(certificate.reasons) == 1, certificate.reasons
    return certificate.reasons[0]


def assert_mentions(certificate: Certificate, *words: str) -> None:
    assert not certificate.certified
    assert any(all(word in reason for word in words) for reason in certificate.reasons), certificate.reasons


def test_a_good_flight_is_certified(good: Plan) -> None:
    certificate = certify(good, task(good), MODEL, LIMITS, SOLVED)
    assert certificate.reasons == ()
    record = certificate.record()
    assert record["certified"] is True
    assert record["contact_steps"] == 2
    assert record["contact_duration_s"] == pytest.approx(0.08)
    assert record["contact_gaps"]["position"] < 1e-3
    assert 0 < record["contact_gaps"]["velocity"] < 0.015
    assert record["replay_defect_position_m"] < 1e-6
    assert record["replay_end_error_m"] < 1e-4
    assert certificate.flight is not None
    assert len(certificate.flight.time) == 201


def test_a_good_flight_without_contact_is_certified() -> None:
    for plan in (bounce(MODEL), surge(MODEL)):
        certificate = certify(plan, alone(plan), MODEL, LIMITS)
        assert certificate.reasons == ()
        assert certificate.record()["contact_start_s"] is None
        assert certificate.record()["max_violation"] is None


def test_replay_equals_the_solution_by_hand() -> None:
    flight = replay(bounce(MODEL, thrust=1.2, h=0.2), MODEL.plant())
    assert flight.configuration[15, 2] == pytest.approx(HEIGHT + 1.2 * 0.2**2, abs=1e-9)
    flight = replay(surge(MODEL, thrust=2.0, h=0.2), MODEL.plant())
    assert flight.velocity[5, 2] == pytest.approx(2.0 * 0.2 / 2, abs=1e-9)
    assert flight.time[5] == pytest.approx(0.2)


def test_a_linear_plan_is_not_flown_with_held_inputs() -> None:
    plan = surge(MODEL)
    held = replace(plan, inputs=plan.inputs[:-1], interpolation="hold")
    assert_mentions(certify(held, alone(plan), MODEL, LIMITS), "position defect of one interval")


def test_a_position_limit_broken_between_nodes() -> None:
    plan = bounce(MODEL, thrust=1.2, h=0.2)
    room = {"z": (0.0, HEIGHT + 0.030)}
    reason = only_reason(certify(plan, alone(plan, workspace=room), MODEL, LIMITS))
    assert reason == "'z' exceeds its limits by 0.018 m on the replay at t=0.400 s, allowed 0.005 m"


def test_a_speed_limit_broken_between_nodes() -> None:
    plan = surge(MODEL, thrust=2.0, h=0.2)
    slow = table_one(speed=(1.3, 1.3, 0.18))
    reason = only_reason(certify(plan, alone(plan), slow, LIMITS))
    assert "rate of 'z' reaches 1.11111 times its limit on the replay" in reason
    assert certify(plan, alone(plan), table_one(speed=(1.3, 1.3, 0.192)), LIMITS).certified


def test_limits_at_the_nodes_have_no_such_allowance(good: Plan) -> None:
    top = np.max(np.abs(good.velocity[:, 6]))
    slow = table_one(arm_rate=top - 1e-4)
    assert "planned velocity 'arm' exceeds its limits by" in only_reason(
        certify(good, task(good), slow, LIMITS)
    )
    narrow = table_one(tilt=float(np.max(np.abs(good.configuration[:, 4]))) - 1e-4)
    assert "planned configuration 'pitch' exceeds" in only_reason(certify(good, task(good), narrow, LIMITS))


def test_an_input_over_its_limit(good: Plan) -> None:
    weak = table_one(motor_force=(0.5 * MOTOR, good.inputs.max() - 1e-3))
    reason = only_reason(certify(good, task(good), weak, LIMITS))
    assert "planned input 'motor_" in reason
    assert "0.001 N" in reason


def test_contact_at_speed(good: Plan) -> None:
    tip = MODEL.plant().tool(good.configuration, good.velocity)
    k = 10
    standing = Polynomial(0.0, tip[0][k][None])
    plan = claimed(good, k)
    certificate = certify(plan, task(good, target=standing, kappa_init=1), MODEL, LIMITS)
    assert_mentions(certificate, f"node {k} claims contact", "relative speed is 0.41", "allowed 0.01 m/s")


def test_a_fraction_of_contact_buys_nothing(good: Plan) -> None:
    plan = claimed(good, FIRST, LAST)
    plan.progress[12] = 0.02
    certificate = certify(plan, task(good), MODEL, LIMITS)
    assert_mentions(certificate, "node 12 claims contact with epsilon 0.02 but its relative speed is")
    spread = claimed(good, *range(5, 15), progress=0.2)
    assert_mentions(certify(spread, task(good), MODEL, LIMITS), "progress made in that contact", "0.4")


def test_noise_in_the_progress_is_no_claim(good: Plan) -> None:
    noisy = replace(good, progress=np.clip(good.progress + 1e-5, 0, 1))
    assert certify(noisy, task(good), MODEL, LIMITS).certified


def test_contact_too_short(good: Plan) -> None:
    reasons = certify(claimed(good, FIRST), task(good), MODEL, LIMITS).reasons
    assert "the longest contact that holds every condition is only 1 nodes, required 2 nodes" in reasons
    reason = only_reason(certify(good, task(good, contact_seconds=0.1), MODEL, LIMITS))
    assert reason == "the longest contact that holds every condition is only 0.08 s, required 0.1 s"
    assert certify(good, task(good, contact_seconds=0.08), MODEL, LIMITS).certified


def test_no_contact_at_all(good: Plan) -> None:
    idle = claimed(good)
    assert_mentions(certify(idle, task(good), MODEL, LIMITS), "only 0 nodes")


def test_flying_backwards(good: Plan) -> None:
    """Mirrored target velocity: the nose points the wrong way, which the printed cross product accepts."""
    target = along_tool(good, MODEL.plant(), FIRST, LAST)
    turned = Polynomial(target.start, target.coefficients * np.array([[1.0], [-1.0], [0.0], [0.0]]))
    lone = {"heading": Heading(form="cross", limit=0.3)}
    certificate = certify(good, task(good, target=turned, contacts=lone), MODEL, LIMITS)
    assert_mentions(certificate, "heading error is 3.")


def test_a_target_that_leaves_between_the_nodes(good: Plan) -> None:
    """Bump of 30 mm with zero value and slope at both nodes: only the dense replay sees it."""
    target = along_tool(good, MODEL.plant(), FIRST, LAST)
    h = float(good.time[LAST] - good.time[FIRST])
    bump = np.zeros((5, 3))
    bump[2:, 2] = 16 * 0.03 * np.array([1 / h**2, -2 / h**3, 1 / h**4])
    bump[:4] += target.coefficients
    reasons = certify(good, task(good, target=Polynomial(target.start, bump)), MODEL, LIMITS).reasons
    assert len(reasons) == 2
    assert "distance in contact reaches 0.03" in reasons[0]
    assert "on the replay at t=0.760 s, allowed 0.020001 m" in reasons[0]
    assert "relative speed in contact" in reasons[1]


def test_a_path_condition_holds_all_the_time(good: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Floor, "kept", "always", raising=False)
    high = Polynomial(0.0, np.array([[0.0, 0.0, 0.45]]))
    certificate = certify(good, task(good, target=high, contacts={"floor": Floor()}), MODEL, LIMITS)
    assert_mentions(certificate, "floor reaches 0.032", "at node 0")
    assert not any("nodes" in reason for reason in certificate.reasons)


def test_arm_with_the_wrong_sign() -> None:
    """The planner measures the arm angle the other way round: it thinks the arm is at pi - alpha."""
    flip = np.array([1.0, 1, 1, 1, 1, 1, -1])
    offset = np.array([0.0, 0, 0, 0, 0, 0, np.pi])

    def mirrored(q: Array, v: Array, u: Array) -> Array:
        return flip * MODEL.plant().acceleration(offset + flip * q, flip * v, u * flip[2:])

    plan = claimed(crossing(MODEL, mirrored), FIRST, LAST)
    certificate = certify(plan, task(plan, contacts={"position": Position()}), MODEL, LIMITS)
    assert_mentions(certificate, "distance from the end on the replay")
    assert_mentions(certificate, "distance in contact", "on the replay")


def test_servo_reaction_counted_twice() -> None:
    share = np.array([-1.0, 1, -1, 1]) / (4 * np.sqrt(2) / 4 * 0.33)

    def with_reaction(q: Array, v: Array, u: Array) -> Array:
        extra = np.concatenate([-u[..., 4:] * share, 0 * u[..., 4:]], axis=-1)
        return MODEL.plant().acceleration(q, v, u + extra)

    plan = claimed(crossing(MODEL, with_reaction), FIRST, LAST)
    certificate = certify(plan, task(plan), MODEL, LIMITS)
    assert_mentions(certificate, "distance from the end on the replay")


def test_wrong_end(good: Plan) -> None:
    end = dict(zip(MODEL.configuration.names, REST + SHIFT + [0, 0, 0.05, 0, 0, 0, 0], strict=True))
    certificate = certify(good, task(good, end=end), MODEL, LIMITS)
    assert_mentions(certificate, "distance of planned 'z' from the end reaches 0.05 m")
    assert_mentions(certificate, "distance from the end on the replay reaches 0.05")


def test_not_at_rest() -> None:
    plan = bounce(MODEL)
    cut = Plan(
        plan.time[:3], plan.configuration[:3], plan.velocity[:3], plan.inputs[:2], plan.progress[:3],
        "hold", plan.coordinate_names, plan.coordinate_units, plan.input_names, plan.input_units,
    )  # fmt: skip
    certificate = certify(cut, alone(cut), MODEL, LIMITS)
    assert_mentions(certificate, "planned rate of 'z' at the end reaches 0.24 m/s")
    assert_mentions(certificate, "rate of 'z' at the end of the replay reaches")


def test_a_relaxed_solution_is_not_a_solution(good: Plan) -> None:
    relaxed = replace(SOLVED, pairs={"pair": PairResidual(0.0, 1e-3, 1e-6)})
    reason = only_reason(certify(good, task(good), MODEL, LIMITS, relaxed))
    assert reason == "violation of the complementarity pairs reaches 0.001, allowed 1e-06"
    infeasible = replace(SOLVED, constraints={"dynamics": 1e-9, "speed": 2e-6})
    assert "worst in 'speed'" in only_reason(certify(good, task(good), MODEL, LIMITS, infeasible))
    unknown = replace(SOLVED, bounds=float("nan"))
    assert "is not a number" in only_reason(certify(good, task(good), MODEL, LIMITS, unknown))


@pytest.mark.parametrize("complementarity", [None, 1e-2])
@pytest.mark.parametrize("product", [None, 1e-2])
def test_signs_of_pairs_are_always_asked_for(complementarity: float | None, product: float | None) -> None:
    """G = -1e-3: within the other limits where they are asked for, but not within that of residuals."""
    limits = ProblemLimits(residual=1e-6, complementarity=complementarity, product=product)
    negative = replace(SOLVED, pairs={"pair": PairResidual(1e-3, 1e-3, 0.0)})
    expected = "violation of the signs of the complementarity pairs reaches 0.001, allowed 1e-06"
    judged = certify_problem(negative, limits)
    assert only_reason(judged) == expected
    assert (judged.measures.max_complementarity, judged.measures.max_violation) == (1e-3, 1e-9)
    assert judged.measures.max_product == 0.0 and judged.flight is None
    assert certify_problem(SOLVED, limits).certified


@pytest.mark.parametrize("field", ["time", "configuration", "velocity", "inputs", "progress"])
def test_nan_anywhere(good: Plan, field: str) -> None:
    broken = getattr(good, field).copy()
    broken[3] = np.nan
    certificate = certify(replace(good, **{field: broken}), task(good), MODEL, LIMITS, SOLVED)
    assert_mentions(certificate, f"the plan's {field} is not a number in row 3")
    assert certificate.record()["replay_end_error_m"] is None


def test_time_that_stands_still(good: Plan) -> None:
    stuck = good.time.copy()
    stuck[5] = stuck[4]
    reason = only_reason(certify(replace(good, time=stuck), task(good), MODEL, LIMITS))
    assert "time must start at 0 and increase" in reason


def test_one_wrong_node_is_a_defect(good: Plan) -> None:
    bent = good.configuration.copy()
    bent[4, 0] += 0.006
    certificate = certify(replace(good, configuration=bent), task(good), MODEL, LIMITS)
    assert "position defect of one interval reaches 0.006" in only_reason(certificate)
    assert certificate.record()["replay_end_error_m"] < 1e-4


def test_garbage_ends_in_time_and_in_failure(good: Plan) -> None:
    draw = np.random.default_rng(3)
    wild = replace(good, inputs=1e3 * draw.normal(size=(20, 5)), velocity=30 * draw.normal(size=(21, 7)))
    stretched = replace(good, time=good.time * 500)
    for plan in (wild, stretched):
        before = time.process_time()
        certificate = certify(plan, task(good), MODEL, LIMITS)
        assert time.process_time() - before < 10
        assert_mentions(certificate, "the replay diverges")


def test_restarts_forget_the_past(good: Plan) -> None:
    weak = good.inputs.copy()
    weak[0, :4] += 0.05
    plan = replace(good, inputs=weak)
    drift = [
        np.max(np.abs(f.configuration[f.nodes] - plan.configuration))
        for f in (replay(plan, MODEL.plant()), replay(plan, MODEL.plant(), restart_seconds=0.4))
    ]
    assert drift[1] < drift[0] / 2
    assert replay(plan, MODEL.plant(), restart_seconds=0.4).restarts == (5, 10, 15)


@pytest.mark.parametrize("node", [0, 7, 20])
def test_defects_belong_to_the_intervals_beside_a_wrong_node(good: Plan, node: int) -> None:
    """A node moved along x misses nothing else: the interval before ends short of it, the one after begins off it."""
    bent = good.configuration.copy()
    bent[node, 0] += 0.01
    missed = defects(replace(good, configuration=bent), MODEL.plant())
    expected = np.zeros((22, 7))
    expected[node : node + 2, 0] = -0.01, 0.01
    np.testing.assert_allclose(missed.configuration, expected[1:-1], atol=1e-6)
    np.testing.assert_allclose(missed.velocity, 0, atol=1e-6)


@pytest.mark.parametrize("interval", [0, 7, 19])
def test_every_interval_is_asked_for_its_defect(good: Plan, interval: int) -> None:
    """Three newtons more in one motor for one interval, which the planned nodes know nothing of."""
    pushed = good.inputs.copy()
    pushed[interval, 0] += 3.0
    certificate = certify(replace(good, inputs=pushed), task(good), MODEL, LIMITS)
    assert_mentions(certificate, "angle defect of one interval", f"in interval {interval} (")


@pytest.mark.parametrize(("share", "enough"), [(0.9, True), (1.1, False)])
def test_progress_hidden_below_the_claims_is_all_that_may_be_missing(
    good: Plan, share: float, enough: bool
) -> None:
    """Every node may keep as much as no node has to claim, 21 * 1e-3 here, and not more."""
    plan = claimed(good, FIRST, LAST)
    plan.progress[LAST] -= share * LIMITS.contact_claim * len(plan.time)
    certificate = certify(plan, task(good), MODEL, LIMITS)
    assert certificate.certified == enough
    if not enough:
        reason = only_reason(certificate)
        assert reason == "the progress made in that contact is only 1.9769, required 2"


def test_longest_run() -> None:
    assert longest_run(np.array([True, False, True, True, False, True, True])) == (2, 3)
    assert longest_run(np.zeros(4, bool)) is None
    assert longest_run(np.ones(4, bool)) == (0, 3)


def by_speed(scenario: Handover) -> float:
    found = sequence_bound(scenario, scenario.itinerary.stops, MODEL, MODEL.plant())
    assert found <= lower_bound(scenario, MODEL, MODEL.plant())
    return found


def test_the_bound_by_speed_of_the_static_handover() -> None:
    paper = Handover(
        name="static", start={"z": 0.65}, end={"x": 2.5, "z": 0.65}, contacts={"position": Position()},
        target=Polynomial(0.0, np.array([[1.0, 0.0, 0.4]])),
    )  # fmt: skip
    assert by_speed(paper) == pytest.approx(2.5 / 1.3, abs=1e-12)
    behind = paper.model_copy(update={"target": Polynomial(0.0, np.array([[-1.0, 0.0, 0.4]]))})
    assert by_speed(behind) == pytest.approx((4.5 - 2 * 0.252) / 1.3, abs=2e-3)
    coming = paper.model_copy(update={"target": Polynomial(0.0, np.array([[10.0, 0, 0.4], [-1.3, 0, 0]]))})
    meeting = (10 - 0.252) / (2 * 1.3)
    assert by_speed(coming) == pytest.approx(2 * meeting - 2.5 / 1.3, abs=2e-3)


def test_limits_refuse_what_they_do_not_know() -> None:
    with pytest.raises(ValidationError):
        Limits(**LIMITS.model_dump(), generous=True)
    with pytest.raises(ValidationError):
        Limits(**(LIMITS.model_dump() | {"end_position": float("nan")}))
