"""Lower bounds on the travel time, against the same question asked at every instant, without cells and margins."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from flights import Polynomial, table_one
from test_certificate import LIMITS

from benchbench.certificate.limits import Limits
from benchbench.certificate.speed_bound import STEP, arm_reach, sequence_bound
from benchbench.certificate.window_bound import window_bounds
from benchbench.ground.arrays import Array
from benchbench.ocp.handover import Handover
from benchbench_plugins.contacts.position import Position
from benchbench_plugins.contacts.velocity import Velocity

MODEL, HEIGHT = table_one(), 0.65
ARM = 0.05 + 0.182
"""Offset and length of the arm hanging down, m."""
TOUCH = ARM + 0.02
SPEED = np.array([1.3, 1.3, 1.15])
FASTEST = SPEED * LIMITS.rate_ratio
LONGEST = 6.0


def flight(target: Any, end: float = 2.5, **changes: Any) -> Handover:
    """From x = 0 to x = `end`; `target` are the coefficients of its motion."""
    fields: dict[str, Any] = {
        "name": "line", "start": {"z": HEIGHT}, "end": {"x": end, "z": HEIGHT}, "contacts": {"position": Position()},
        "travel_time": (0.1, LONGEST),
    }  # fmt: skip
    if target is not None:
        fields["target"] = Polynomial(0.0, np.array(target, float))
    return Handover(**(fields | changes))


@pytest.mark.parametrize("attitude", ["euler", "quaternion"])
def test_the_arm_reaches_farthest_hanging_down(attitude: str) -> None:
    model = table_one(attitude=attitude)
    assert ARM - 4e-5 <= arm_reach(model, model.plant()) <= ARM + 1e-12


def one(task: Handover, first: float, last: float, limits: Limits = LIMITS) -> float:
    (bound,) = window_bounds(task, MODEL, limits, np.array([first]), np.array([last]))
    return float(bound)


def ahead(metres: float) -> list[float]:
    return [metres, 0.0, HEIGHT]


@pytest.mark.parametrize("time", [0.0312, 0.5004, 0.50051, 1.2347, 2.2221, 5.9995])
def test_a_window_at_the_end_is_bounded_to_one_cell(time: float) -> None:
    """The way to a resting target takes `time`; the end is anywhere, so nothing else counts."""
    anywhere = LIMITS.model_copy(update={"end_position": 9.0})
    bound = one(flight([ahead(TOUCH + FASTEST[0] * time)]), 1.0, 1.0, anywhere)
    assert time - STEP - 1e-9 <= bound < time


@pytest.mark.parametrize("time", [0.5004, 0.50051, 1.2347, 2.2229])
def test_a_target_that_comes_fast_is_not_missed_between_cells(time: float) -> None:
    """It closes in with 5 m/s, four times as fast as the vehicle flies: its own way in a cell counts most."""
    anywhere = LIMITS.model_copy(update={"end_position": 30.0})
    target = [ahead(TOUCH + (5.0 + FASTEST[0]) * time), [-5.0, 0.0, 0.0]]
    bound = one(flight(target), 1.0, 1.0, anywhere)
    assert time - 3 * STEP <= bound < time


@pytest.mark.parametrize("slack", [0.0, 0.02, 0.3])
@pytest.mark.parametrize("last", [0.25, 0.5, 0.9])
def test_the_way_back_ends_where_the_certificate_allows(slack: float, last: float) -> None:
    """There and back along a line: the way back from the target may end `slack` short of the end, not beyond the start."""
    limits = LIMITS.model_copy(update={"end_position": max(slack, 1e-9)})
    far = 1.0
    there = (far - TOUCH) / (FASTEST[0] * last)
    back = (far - TOUCH - slack) / (FASTEST[0] * (1 - last))
    bound = one(flight([ahead(far)], end=0.0), last, last, limits)
    exact = max(there, back)
    assert exact - 2 * STEP / min(last, 1 - last) <= bound <= exact


def test_no_window_is_faster_than_the_straight_way() -> None:
    """Where the target is on the way anyhow, and where no distance is asked for."""
    direct = (2.5 - LIMITS.end_position) / FASTEST[0]
    assert one(flight([ahead(1.25)]), 0.5, 0.5) == pytest.approx(direct, abs=1e-12)
    far = flight([ahead(100.0)], contacts={"velocity": Velocity()})
    assert one(far, 0.5, 0.5) == pytest.approx(direct, abs=1e-12)


def test_a_window_that_fits_nowhere_has_no_bound() -> None:
    """The longest time allowed is enough, or enough for the straight way only, or not even for that."""
    reach = FASTEST[0] * LONGEST
    on_the_way, aside = [ahead(0.3 * reach)], [[0.0, 3.0, HEIGHT]]
    assert np.isfinite(one(flight(on_the_way, end=reach - 0.1), 0.3, 0.3))
    assert np.isinf(one(flight(on_the_way, end=reach + 0.5), 0.3, 0.3))
    for end in (reach - 0.1, reach - 0.001, reach + 0.5):
        assert np.isinf(one(flight(aside, end=end), 0.3, 0.3))


@pytest.mark.parametrize("seed", range(8))
def test_windows_of_a_moving_target_against_every_instant(seed: int) -> None:
    """Instants a twentieth of a cell apart; the bound is never late, and early by the cells that it grants at most."""
    draw = np.random.default_rng(seed)
    place, moving = draw.uniform(-2.0, 2.0, 3) * [1, 1, 0.2] + [1, 0, 0.4], draw.uniform(-0.3, 0.3, 3)
    end = draw.uniform(0.5, 3.0)
    task = flight([place, moving], end)
    first = draw.uniform(0.05, 0.8, 5)
    last = first + draw.uniform(0.0, 0.15, 5)
    bounds = window_bounds(task, MODEL, LIMITS, first, last)
    time = np.arange(0.0, LONGEST, STEP / 20)[:, None]
    start, goal = np.array([0, 0, HEIGHT]), np.array([end, 0, HEIGHT])
    direct = np.max((np.abs(goal - start) - LIMITS.end_position) / FASTEST)
    for a, b, bound in zip(first, last, bounds, strict=True):
        came = np.abs(place + moving * a * time - start) <= TOUCH + FASTEST * a * time
        goes = (
            np.abs(place + moving * b * time - goal) <= TOUCH + LIMITS.end_position + FASTEST * (1 - b) * time
        )
        fits = np.all(came & goes, axis=1) & (time[:, 0] >= direct)
        exact = float(time[np.argmax(fits), 0]) if fits.any() else np.inf
        assert bound <= exact
        closing = np.min([a * (FASTEST - np.abs(moving)), (1 - b) * FASTEST - b * np.abs(moving)])
        granted = np.max(2 * FASTEST + 3 * np.abs(moving)) * STEP
        if np.isfinite(exact) and closing > 0:
            assert bound >= exact - granted / closing - STEP


def instants(task: Handover, target: Array, speed: Array, end: float) -> float:
    """Shortest time of a flight by one target, (coefficients, 3), at instants a twentieth of a cell apart."""
    time = np.arange(0.0, LONGEST, STEP / 20)[:, None]
    place = sum(c * time**i for i, c in enumerate(target))
    came = np.all(np.abs(place - [0, 0, HEIGHT]) <= TOUCH + speed * time, axis=1)
    rest = np.max(np.maximum(np.abs(place - [end, 0, HEIGHT]) - TOUCH, 0.0) / speed, axis=1)
    return float(np.min(np.where(came, time[:, 0] + rest, np.inf)))


@pytest.mark.parametrize("seed", range(8))
def test_the_bound_of_a_contact_against_every_instant(seed: int) -> None:
    draw = np.random.default_rng(seed)
    target = np.stack([draw.uniform(-1.5, 1.5, 3) * [1, 1, 0.2] + [1, 0, 0.4], draw.uniform(-0.6, 0.6, 3)])
    end = draw.uniform(0.5, 3.0)
    task = flight(target, end)
    bound = sequence_bound(task, task.itinerary.stops, MODEL, MODEL.plant())
    exact = max(end / SPEED[0], instants(task, target, SPEED, end))
    assert exact - 6 * STEP <= bound <= exact


def test_a_target_that_is_fast_along_one_axis_is_no_nearer_along_another() -> None:
    """It crosses the way at 20 m/s, where it is 1 m ahead; what it does in a cell counts along its own axis alone."""
    time = (1.0 - TOUCH) / SPEED[0]
    aside = -20.0 * (time + 0.02)
    target = [[1.0, aside, HEIGHT], [0.0, 20.0, 0.0]]
    task = flight(target).model_copy(update={"end": {"x": 0.5, "y": -0.4, "z": HEIGHT}})
    bound = sequence_bound(task, task.itinerary.stops, MODEL, MODEL.plant())
    exact = time + (0.5 - TOUCH) / SPEED[0]
    assert exact - 5 * STEP <= bound <= exact
    fast = (1.0 - TOUCH) / FASTEST[0]
    late = [[1.0, -20.0 * (fast + 0.02), HEIGHT], [0.0, 20.0, 0.0]]
    anywhere = LIMITS.model_copy(update={"end_position": 30.0})
    assert fast - 4 * STEP <= one(flight(late), 1.0, 1.0, anywhere) <= fast


def test_bounds_do_not_depend_on_where_the_way_begins() -> None:
    """The same way 7 m farther back and 3 m aside."""
    for ahead_by in (1.25, 4.0):
        here, there = flight([[ahead_by, 0.5, HEIGHT]]), flight([[ahead_by - 7, 3.5, HEIGHT]])
        there = there.model_copy(
            update={"start": {"x": -7.0, "y": 3.0, "z": HEIGHT}, "end": {"x": -4.5, "y": 3.0, "z": HEIGHT}}
        )
        assert one(there, 0.6, 0.7) == pytest.approx(one(here, 0.6, 0.7), abs=2 * STEP)
        bounds = [sequence_bound(t, t.itinerary.stops, MODEL, MODEL.plant()) for t in (there, here)]
        assert bounds[0] == pytest.approx(bounds[1], abs=2 * STEP)


def test_the_bound_of_two_contacts_along_a_line() -> None:
    """3 m ahead, back to -1 m, on to 5 m; only the touch at either target shortens the ways."""
    stops = {name: {"target": Polynomial(0.0, np.array([ahead(x)]))} for name, x in (("a", 3.0), ("b", -1.0))}
    task = flight(None, 5.0, stops=stops, order="free", travel_time=(0.1, 20.0))
    a, b = task.itinerary.stops
    ways = {
        (a, b): (3 - TOUCH) + (4 - 2 * TOUCH) + (6 - TOUCH),
        (b, a): (1 - TOUCH) + (4 - 2 * TOUCH) + (2 - TOUCH),
    }
    for made, way in ways.items():
        bound = sequence_bound(task, made, MODEL, MODEL.plant())
        assert way / SPEED[0] - 6 * STEP <= bound <= way / SPEED[0] + 1e-9
