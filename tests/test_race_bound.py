"""Lower bounds on the time of a race against flights of a point mass along one line, which can be written down.

Thrust is 4 * 6.8794 N on 0.85 kg. Next to no gravity, where it would hide what is asked: then the line of the flight
gives the best of all directions, and from rest to rest over D a point mass takes 2 sqrt(D / f), onwards sqrt(2 D / f).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from test_race_certificate import vehicle

from benchbench.certificate.bound import lower_bound
from benchbench.certificate.race_bound import order_bound, race_bound
from benchbench.ocp.race import Race
from benchbench_plugins.models.quadrotor import Quadrotor, Ramp

F, G = 4 * 6.8794 / 0.85, 9.801
FLOATING, HEAVY = vehicle(gravity=1e-12), vehicle()
TINY = 1e-9


def race(end: Sequence[float], *gates: Any, start: Sequence[float] = (0, 0, 1), **changes: Any) -> Race:
    ends = {side: dict(zip("xyz", at, strict=True)) for side, at in (("start", start), ("end", end))}
    return Race(**({"name": "line", "track": list(gates), "radius": TINY} | ends | changes))


def bound(task: Race, model: Quadrotor = FLOATING) -> float:
    found = race_bound(task, model, model.plant())
    assert lower_bound(task, model, model.plant()) == found
    return found


def rest(metres: float) -> float:
    return 2 * np.sqrt(metres / F)


def onwards(metres: float) -> float:
    return np.sqrt(2 * metres / F)


def ball(x: float, radius: float) -> dict[str, float]:
    return {"x": x, "y": 0, "z": 1, "radius": radius}


LINES = [
    # end, gates, changes, exact
    ((8, 0, 1), [(4, 0, 1)], {"end_velocity": "rest"}, rest(8)),
    ((8, 0, 1), [(4, 0, 1)], {}, onwards(8)),
    ((0, 0, 9), [(0, 0, 4)], {"end_velocity": "rest"}, rest(8)),
    ((0, -8, 1), [(0, -4, 1)], {}, onwards(8)),
    # there and back: a turn where the gate is
    ((-5, 0, 1), [(10, 0, 1)], {}, rest(10) + onwards(15)),
    ((-5, 0, 1), [(10, 0, 1)], {"end_velocity": "rest"}, rest(10) + rest(15)),
    ((4, 0, 1), [(10, 0, 1), (2, 0, 1)], {}, rest(10) + rest(8) + onwards(2)),
    ((4, 0, 1), [(3, 0, 1), (10, 0, 1), (7, 0, 1), (2, 0, 1)], {}, rest(10) + rest(8) + onwards(2)),
    # balls are touched on the near side: what is inside one already need not move
    ((-5, 0, 1), [ball(10, 2.0)], {"end_radius": 0.5}, rest(8) + onwards(12.5)),
    ((-5, 0, 1), [ball(10, 2.0)], {"end_radius": 0.5, "end_velocity": "rest"}, rest(8) + rest(13)),
    ((-5, 0, 1), [ball(10, 2.0), ball(9, 1.5)], {}, rest(8) + onwards(13)),
    ((12, 0, 1), [ball(10, 2.0), ball(9, 1.5)], {}, onwards(12)),
    ((2, 0, 1), [ball(1, 3.0)], {}, onwards(2)),
]


@pytest.mark.parametrize(("end", "gates", "changes", "exact"), LINES)
def test_the_bound_is_the_time_along_a_line(
    end: Sequence[float], gates: list[Any], changes: dict[str, Any], exact: float
) -> None:
    assert bound(race(end, *gates, **changes)) == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize(
    ("height", "free", "stopped"),
    [
        (21.0, np.sqrt(2 * 20 / (F - G)), np.sqrt(2 * 20 * (1 / (F - G) + 1 / (F + G)))),
        (-19.0, np.sqrt(2 * 20 / (F + G)), np.sqrt(2 * 20 * (1 / (F - G) + 1 / (F + G)))),
    ],
)
def test_gravity_slows_what_climbs_and_speeds_what_falls(height: float, free: float, stopped: float) -> None:
    """Without a turn, and from rest to rest with full thrust one way, then the other: exact for a point mass."""
    middle = (0, 0, (height + 1) / 2)
    assert bound(race((0, 0, height), middle), HEAVY) == pytest.approx(free, rel=1e-6)
    at_rest = race((0, 0, height), middle, end_velocity="rest")
    assert bound(at_rest, HEAVY) == pytest.approx(stopped, rel=1e-6)
    back = bound(race((0, 0, 1), (0, 0, height)), HEAVY)
    fall = F + (G if height > 1 else -G)
    assert back == pytest.approx(stopped + np.sqrt(2 * 20 / fall), rel=1e-6)


def test_a_turn_under_gravity_is_between_all_thrust_along_it_and_what_is_left_at_one_height() -> None:
    found = bound(race((-5, 0, 1), (10, 0, 1)), HEAVY)
    low, high = (2 * np.sqrt(10 / a) + np.sqrt(2 * 15 / a) for a in (F, np.sqrt(F**2 - G**2)))
    assert low - 1e-6 < found < high


def test_too_little_thrust_to_climb_bounds_nothing_less_than_a_fall() -> None:
    """It cannot rise at all: a bound so large that no plan is below it."""
    weak = vehicle(motor_force=(0.0, 0.85 * 9.801 / 4 - 0.1))
    assert bound(race((0, 0, 5), (0, 0, 3)), weak) > 1e5
    assert bound(race((0, 0, 5), (0, 0, 3), end_velocity="rest"), weak) > 1e5
    assert bound(race((0, 0, 5), (0, 0, -3)), weak) > 1e5


def test_motors_that_hardly_push() -> None:
    """A quarter of a metre per second squared."""
    weak = vehicle(gravity=1e-12, motor_force=(0.0, 0.85 * 0.25 / 4))
    for out, back in ((10, -5), (-10, 5)):
        found = bound(race((back, 0, 1), (out, 0, 1)), weak)
        assert found == pytest.approx(2 * np.sqrt(10 / 0.25) + np.sqrt(2 * 15 / 0.25), rel=1e-6)


def test_a_way_around_a_corner_counts_by_its_length() -> None:
    """A square of 4 m sides: with all thrust and gravity along the way it takes at least sqrt(2 L / (f + g))."""
    corners = [(4, 0, 1), (4, 4, 1), (0, 4, 1)]
    found = bound(race((0, 0, 1), *corners, start_velocity={"vx": 1e-9}), HEAVY)
    assert found == pytest.approx(np.sqrt(2 * 16 / (F + G)), rel=1e-6)
    around = [
        {"x": x, "y": y, "z": z, "radius": r}
        for (x, y, z), r in zip(corners, (0.5, 0.25, 0.125), strict=True)
    ]
    short = bound(race((0, 0, 1), *around, start_velocity={"vx": 1e-9}, end_radius=1.0), HEAVY)
    assert short == pytest.approx(np.sqrt(2 * (16 - 2 * 0.875 - 1.0) / (F + G)), rel=1e-6)
    overlapping = [ball(4, 1.0), ball(5, 2.0)]
    touched = bound(race((9, 0, 1), *overlapping, start_velocity={"vx": 1e-9}), HEAVY)
    assert touched == pytest.approx(np.sqrt(2 * (3.0 + 0.0 + 2.0) / (F + G)), rel=1e-6)


@pytest.mark.parametrize("velocity", [{"vx": 3.0}, {"vx": -3.0}, {"vx": 0.0, "vy": 1.8, "vz": -2.4}])
def test_a_flying_start_saves_what_its_speed_may_save_in_any_direction(velocity: dict[str, float]) -> None:
    """The way is v t + (f + g) t^2 / 2, whatever the velocity's direction; and no direction proves a turn."""
    found = bound(race((-5, 0, 1), (10, 0, 1), start_velocity=velocity), HEAVY)
    assert 3.0 * found + (F + G) * found**2 / 2 == pytest.approx(25.0)


def test_limits_that_grow_along_the_way_count_where_they_are_largest() -> None:
    """Even if the flight is too short to get there."""
    ramp = Ramp(metres=1e6, motor_force=1.0, body_rate=(1.0, 1.0, 1.0))
    assert bound(race((8, 0, 1), (4, 0, 1)), vehicle(gravity=1e-12, ramp=ramp)) == pytest.approx(
        onwards(8), rel=1e-6
    )


def test_orders_are_bounded_by_what_begins_them_and_any_one_of_the_rest() -> None:
    """Gates at 3 m and -1 m on either side of the start, the end at 1 m: with one of them left, the farther counts."""
    task = race((1, 0, 1), (3, 0, 1), (-1, 0, 1), order="free", end_velocity="rest")
    plant = FLOATING.plant()
    exact = {
        (): rest(3) + rest(2),
        (1,): rest(3) + rest(4) + rest(2),
        (2,): rest(1) + rest(4) + rest(2),
        (1, 2): rest(3) + rest(4) + rest(2),
        (2, 1): rest(1) + rest(4) + rest(2),
    }
    for first, time in exact.items():
        assert order_bound(task, FLOATING, plant, first) == pytest.approx(time, rel=1e-6)
    assert bound(task) == pytest.approx(exact[()], rel=1e-6)
    fixed = race((1, 0, 1), (3, 0, 1), (-1, 0, 1), end_velocity="rest", sequence=(2, 1))
    assert bound(fixed) == pytest.approx(exact[2, 1], rel=1e-6)
    last = race((1, 0, 1), (3, 0, 1), (-4, 0, 1), order="free", end_velocity="rest")
    assert bound(last) == pytest.approx(rest(4) + rest(5), rel=1e-6)
