"""Lower bounds of handovers that know thrust, contact and yaw: never above what was flown, and near what is known exactly."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from flights import HEIGHT, REST, Polynomial, table_one

from benchbench.certificate.bound import bounded, lower_bound
from benchbench.certificate.contact_bound import Visit
from benchbench.certificate.handover_bound import Bound, handover_bound, level_bound
from benchbench.certificate.leg import Leg
from benchbench.certificate.speed_bound import sequence_bound
from benchbench.certificate.turning import ByRate, ByTorque
from benchbench.ground.arrays import Array
from benchbench.ocp.handover import Handover
from benchbench.run import config
from benchbench_plugins.contacts.heading import Heading
from benchbench_plugins.contacts.position import Position

MODEL = table_one()
SPEED = np.array([1.3, 1.3, 1.15])
TOUCH = 0.05 + 0.182 + 0.02
KNOWN = [
    one
    for one in yaml.safe_load((Path(__file__).parents[1] / "references" / "best_known.yaml").read_text())
    if "travel_time_s" in one
]
HOVERING = {"z": HEIGHT, "arm": math.pi / 2}


def task(target: Any, **changes: Any) -> Handover:
    """Back to where it began, past a target (coefficients, 3)."""
    fields: dict[str, Any] = {
        "name": "there and back", "start": HOVERING, "end": HOVERING, "contacts": {"position": Position()},
        "target": Polynomial(0.0, np.array(target, float)), "travel_time": (0.1, 12.0),
    }  # fmt: skip
    return Handover(**(fields | changes))


# --- the way from rest, against flights of the independent plant ----------------------------------------------------


def flown(inputs: Array, step: float) -> tuple[Array, Array]:
    """Configurations and velocities (flights, steps + 1, 7) from rest, inputs (flights, steps, 5) held; RK4."""
    plant, q = MODEL.plant(), np.tile(REST, (len(inputs), 1))
    v, found = np.zeros_like(q), []
    found.append((q, v))
    for k in range(inputs.shape[1]):
        u = inputs[:, k]
        a = plant.acceleration(q, v, u)
        b = plant.acceleration(q + step / 2 * v, v + step / 2 * a, u)
        c = plant.acceleration(q + step / 2 * v + step**2 / 4 * a, v + step / 2 * b, u)
        d = plant.acceleration(q + step * v + step**2 / 2 * b, v + step * c, u)
        q, v = q + step * v + step**2 / 6 * (a + b + c), v + step / 6 * (a + 2 * b + 2 * c + d)
        found.append((q, v))
    return np.stack([one for one, _ in found], axis=1), np.stack([one for _, one in found], axis=1)


def hard() -> Array:
    """Motors at either limit, held for 10 to 300 ms, the servo at any torque; and the hardest ways to go forward and aside."""
    draw, box = np.random.default_rng(3), MODEL.inputs
    steps = 320
    inputs = np.empty((300, steps, 5))
    for flight in inputs:
        begin = 0
        while begin < steps:
            end = begin + int(draw.integers(10, 300))
            motors = np.where(draw.random(4) < 0.5, box.lower[:4], box.upper[:4])
            flight[begin:end] = [*motors, draw.uniform(-0.5, 0.5)]
            begin = end
    low, high = box.lower[0], box.upper[0]
    tilting = {"forward": (low, high, low, high), "aside": (low, high, high, low)}
    for row, (_, motors) in zip((0, 1), tilting.items(), strict=True):
        inputs[row, :200] = [*motors, 0.0]
        inputs[row, 200:] = [high, high, high, high, 0.0]
    return inputs


def test_nothing_that_flies_comes_farther_than_the_way_from_rest() -> None:
    """Up to the instant at which a flight breaks a limit; forward and aside come at least 0.4 times as far in 0.25 s."""
    step = 1e-3
    with np.errstate(all="ignore"):  # what has broken its limits may fly to infinity
        q, v = flown(hard(), step)
    time = step * np.arange(q.shape[1])
    back, ahead = MODEL.way_from_rest(REST, time)
    box, rates = MODEL.configuration, MODEL.velocity
    inside = np.all((q >= box.lower) & (q <= box.upper) & (np.abs(v) <= rates.upper), axis=2)
    inside = np.logical_and.accumulate(inside, axis=1)[..., None]
    way = q[..., :3] - REST[:3]
    assert np.all(~inside | ((way <= ahead + 1e-9) & (way >= -back - 1e-9)))
    assert np.max(np.sum(inside, axis=1)) > 250, "and flights last"
    for axis in (0, 1):
        farthest = np.max(np.abs(way[:2, 250, axis]))
        assert 0.4 * ahead[250, axis] < farthest <= ahead[250, axis], "it is no empty bound"


def test_the_way_from_rest_is_the_same_in_quaternions_and_grows_with_time() -> None:
    time = np.linspace(0.0, 4.0, 81)
    turned = table_one(attitude="quaternion")
    q = np.array([0.0, 0.0, HEIGHT, 1.0, 0.0, 0.0, 0.0, math.pi / 2])
    for one, other in zip(MODEL.way_from_rest(REST, time), turned.way_from_rest(q, time), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-12)
        assert np.all(np.diff(one, axis=0) >= -1e-12) and np.all(one <= time[:, None] * SPEED + 1e-12)
        np.testing.assert_array_equal(one[0], 0.0)


def test_what_leans_already_is_ahead() -> None:
    """A start that is tilted accelerates at once; the bound grants it."""
    time = np.array([0.1, 0.2])
    leaning = REST.copy()
    leaning[4] = 0.5
    _, level = MODEL.way_from_rest(REST, time)
    _, ahead = MODEL.way_from_rest(leaning, time)
    assert np.all(ahead[:, 0] >= 9.8 * math.tan(0.5) * time**2 / 2) and np.all(ahead[:, 0] > level[:, 0])


# --- contact and yaw where the answer is known exactly --------------------------------------------------------------


def visit(made: Handover, rests: bool, **changes: Any) -> Visit:
    ends = [Leg(MODEL, REST, rests) for _ in range(2)]
    fields: dict[str, Any] = {"reach": TOUCH, "error": 0.1, "turning": None, "speed": SPEED} | changes
    return Visit(ends[0], ends[1], made.itinerary.stops[0], **fields)


@pytest.mark.parametrize("lasts", [0.001, 0.4, 1.0])
@pytest.mark.parametrize("metres", [1.0, 2.2])
def test_there_and_back_at_full_speed_and_the_contact_in_between(metres: float, lasts: float) -> None:
    made = task([[metres, 0.0, HEIGHT]], contact_seconds=lasts)
    exact = 2 * (metres - TOUCH) / SPEED[0] + lasts
    found = visit(made, rests=False).least(0.0, 12.0)
    assert exact - 0.02 <= found <= exact
    later = visit(made, rests=True).least(0.0, 12.0)
    assert found + 0.3 < later < found + 0.62, (
        "speeding up and slowing down take 0.31 s each where only pitch is free"
    )


def test_a_contact_in_shares_of_the_flight() -> None:
    """12 of 100 steps: T = legs + 0.12 T."""
    made = task([[2.2, 0.0, HEIGHT]], kappa_init=13)
    exact = 2 * (2.2 - TOUCH) / SPEED[0] / 0.88
    assert exact - 0.02 <= visit(made, rests=False).least(0.0, 12.0) <= exact


@pytest.mark.parametrize("angle", [0.5, 1.5, 3.0, -2.0])
def test_the_nose_turns_to_the_target_and_back(angle: float) -> None:
    """By rate alone 2 (angle - error) / rate; as a double integrator, out and back, 4 sqrt((angle - error) / acceleration)."""
    way = 1e-3 * np.array([math.cos(angle), math.sin(angle), 0.0])
    made = task(
        [[0.0, 0.0, HEIGHT - 0.1], way], contacts={"position": Position(), "heading": Heading()}, kappa_init=1
    )
    off = abs(angle) - 0.1
    for turning, exact in (
        (ByRate(0.5), 2 * off / 0.5),
        (ByTorque(9.0, 1.1), 4 * math.sqrt(off / 1.1)),
    ):
        found = visit(made, rests=False, turning=turning).least(0.0, 20.0)
        assert exact - 0.05 <= found <= exact


def test_a_target_that_turns_is_met_when_its_heading_suits() -> None:
    """It turns from -x towards +y while the nose turns half a radian a second; waiting and turning back are weighed."""
    curve = np.array([[0.0, 0.1, HEIGHT - 0.1], [-0.5, 0.0, 0.0], [0.0, 0.05, 0.0]])
    made = task(curve, contacts={"position": Position(), "heading": Heading()}, kappa_init=1)
    reach_all = visit(made, rests=False, reach=np.inf, turning=ByRate(0.5)).least(0.0, 30.0)
    course = np.linspace(0, 30, 30001)
    angle = np.arctan2(0.1 * course, -0.5)
    off = np.maximum(np.abs(angle) - 0.1, 0.0)
    exact = np.min(np.where(0.5 * course >= off, course + off / 0.5, np.inf))
    assert exact - 0.1 <= reach_all <= exact + 1e-9


def test_a_target_that_stands_asks_for_no_heading() -> None:
    made = task([[0.0, 0.0, HEIGHT - 0.1]], contacts={"position": Position(), "heading": Heading()})
    assert visit(made, rests=False, turning=ByRate(1e-3)).least(0.1, 12.0) == 0.1


# --- whole tasks ----------------------------------------------------------------------------------------------------


def known() -> list[tuple[str, float]]:
    """The shortest certified time of each handover without rewards, with the part of its command that says the task."""
    best: dict[str, float] = {}
    for one in KNOWN:
        words = one["command"].split()
        said = " ".join(w for w in words if w.startswith(("+scenario=", "vehicle=", "scenario.kappa_init=")))
        if one["scenario"] not in ("race", "detour") and one.get("kappa_init") in (None, 2):
            best[said] = min(best.get(said, math.inf), one["travel_time_s"])
    return sorted((said, time) for said, time in best.items() if "race" not in said)


CERTIFIED = {
    # certified travel times of `benchbench suite handover100` and `hardware30` with strategy=auto, s
    ("random_handover", 10): 4.9845, ("random_handover", 9): 4.1826, ("random_handover", 68): 6.1270,
    ("random_handover", 81): 1.9459, ("random_handover", 75): 6.9296, ("random_hardware", 7): 8.6594,
    ("random_hardware", 16): 6.8289, ("random_hardware", 8): 7.2428, ("random_hardware", 2): 5.9625,
}  # fmt: skip


def check(case: Any, time: float) -> float:
    """The bounds are not above a certified time; returns the proved one."""
    told = bounded(case.scenario, case.model, case.model.plant())
    assert told["lower_bound_s"] <= time
    level = told["level_bound_s"]
    assert level is None or told["lower_bound_s"] <= level <= time
    assert told["limited_by"]
    return float(told["lower_bound_s"])


@pytest.mark.parametrize(("family", "seed"), sorted(CERTIFIED))
def test_no_bound_is_above_a_certified_flight(family: str, seed: int) -> None:
    """Yaw at 0.1 rad/s is proved to 0.4 and 0.2 % for two of the hardware flights."""
    case = config.compose(f"+scenario={family}", f"seed={seed}", "solver=ipopt")
    time = CERTIFIED[family, seed]
    found = check(case, time)
    if (family, seed) in (("random_hardware", 7), ("random_hardware", 16)):
        assert found > 0.99 * time


def test_no_bound_is_above_a_best_known_flight() -> None:
    tasks = known()
    assert len(tasks) > 5
    for words, time in tasks:
        check(config.compose(*words.split(), "solver=ipopt"), time)


def test_a_bound_is_never_below_that_from_speed_and_reach() -> None:
    draw = np.random.default_rng(0)
    for _ in range(5):
        target = [[*draw.uniform(-2, 2, 2), 0.4], [*draw.uniform(-0.4, 0.4, 2), 0.0]]
        made = task(
            target, contacts={"position": Position(), "heading": Heading()}, end=HOVERING | {"x": 2.5}
        )
        plant = MODEL.plant()
        assert lower_bound(made, MODEL, plant) >= sequence_bound(made, made.itinerary.stops, MODEL, plant)


def test_the_demand_that_limits_a_flight_is_named() -> None:
    plant = MODEL.plant()
    far = task([[0.0, 2.0, 0.4]], end=HOVERING | {"y": 4.0})
    assert handover_bound(far, MODEL, plant).demand == "speed and thrust along y"
    aside = task([[1.0, 2.5, 0.4]], end=HOVERING | {"x": 2.0}, contact_seconds=1.0)
    assert handover_bound(aside, MODEL, plant).demand == "the way to the target and on"
    slow = task([[0.0, 2.0, 0.4]], travel_time=(9.0, 12.0))
    assert handover_bound(slow, MODEL, plant) == Bound(9.0, "the least travel time allowed")
    behind = task(
        [[0.5, 0.0, 0.4], [-0.1, 0.0, 0.0]], contacts={"position": Position(), "heading": Heading()}
    )
    proved = handover_bound(behind, MODEL, plant)
    assert proved.demand == "the yaw rate turns the nose to the target and back"
    level = level_bound(behind, MODEL, plant, proved)
    assert level is not None and level.seconds > 2 * proved.seconds
    assert level_bound(far, MODEL, plant, handover_bound(far, MODEL, plant)) is None, "no heading is asked"


def test_a_way_that_takes_longer_than_allowed_has_no_flight() -> None:
    """Full speed is enough, speeding up is not: 2.5 m in 1.95 s."""
    made = task([[1.0, 0.0, 0.4]], end=HOVERING | {"x": 2.5}, travel_time=(0.1, 1.95))
    assert lower_bound(made, MODEL, MODEL.plant()) > 1.95
