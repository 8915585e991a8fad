"""Classics of optimal control come out as published, and as their discretisation must."""

from __future__ import annotations

from math import asinh, hypot, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve
from scipy.spatial import ConvexHull

import benchbench as bb
from benchbench_plugins.collections.obstacle_car import LEAST
from benchbench_plugins.collections.zermelo import TIME, start


def solved(scenario: str, intervals: int, *more: str) -> float:
    """The objective of a certified solution."""
    run = bb.plan(
        f"+scenario={scenario}", f"scenario.intervals={intervals}", "certificate.stationarity=off", *more
    )
    assert run.certified, run.record["reasons"]
    return float(run.record["objective"])


@pytest.mark.parametrize("intervals", [2, 5, 20])
def test_the_block_takes_the_least_effort_that_held_inputs_can(intervals: int) -> None:
    """By hand: the input of least effort is the mean of 6 - 12 t over each interval, times 1 / (1 - 1 / N^2)."""
    assert solved("block_move", intervals) == pytest.approx(12 / (1 - 1 / intervals**2), rel=1e-8)


@pytest.mark.parametrize("distance", [1.0, 6.25])
def test_the_double_integrator_is_exact_where_its_switch_is_on_a_node(distance: float) -> None:
    field = f"scenario.distance={distance}"
    assert solved("double_integrator", 8, field) == pytest.approx(2 * sqrt(distance), rel=1e-7)
    assert solved("double_integrator", 9, field) > 2 * sqrt(distance) * (1 + 1e-4)


def test_zermelo_starts_where_the_book_says() -> None:
    assert [round(value, 2) for value in start()] == [3.66, -1.86]
    assert pytest.approx(5.464, abs=5e-4) == TIME


def test_zermelo_converges_with_second_order_from_above() -> None:
    """Held headings are never faster than free ones."""
    coarse, fine = (solved("zermelo", intervals) - TIME for intervals in (20, 40))
    assert 0 < fine < 1e-3
    assert coarse / fine == pytest.approx(4.0, abs=0.1)


STEERING = 0.55457088
"""By the law of the linear tangent (Bryson & Ho 1975, section 2.4): COPS prints 0.554571."""


def test_steering_converges_with_second_order_from_above() -> None:
    coarse, fine = (solved("steering", intervals) - STEERING for intervals in (10, 20))
    assert 0 < fine < 2e-4
    assert coarse / fine == pytest.approx(4.0, abs=0.1)


def test_the_law_of_the_linear_tangent_gives_the_same_time() -> None:
    """By symmetry tan u = tan u_0 (1 - 2 t / T); u_0 and T from height and speed at the end, in closed form."""

    def missed(x: list[float]) -> list[float]:
        slope, time = x
        along = 100 * time * asinh(slope) / slope - 45
        secant = sqrt(1 + slope**2)
        up = 100 * (time / (2 * slope)) ** 2 * (secant * slope - asinh(slope))
        return [along, up - 5]

    _, time = fsolve(missed, [1.0, 0.55], xtol=1e-13)
    assert time == pytest.approx(STEERING, abs=1e-8)


@pytest.mark.slow
def test_the_robot_arm_is_as_quick_as_cops_says() -> None:
    """9.14093 at 800 intervals there; held motors come from above."""
    coarse, fine = (solved("robot_arm", intervals) - 9.14093 for intervals in (25, 100))
    assert 0 < fine < 5e-4 and coarse / fine > 16


def test_goddards_rocket_climbs_as_high_as_cops_says() -> None:
    assert -solved("goddard", 50) == pytest.approx(1.01283, abs=1.5e-5)


@pytest.mark.slow
def test_the_pole_swings_up_with_second_order_from_above() -> None:
    """Towards one number, which is that of dymos to its 0.1 %."""
    coarse, middle, fine = (solved("cart_pole", intervals) for intervals in (25, 50, 100))
    assert coarse > middle > fine
    assert (coarse - middle) / (middle - fine) == pytest.approx(4.0, abs=0.3)
    assert fine - (middle - fine) / 3 == pytest.approx(58.839, rel=1e-3)


def test_the_quadrotor_flips_over_and_its_inputs_lead_there() -> None:
    """No published number: the held inputs flown by another integrator end where they must, and refining converges from above."""
    run = bb.plan("+scenario=quadrotor_flip", "scenario.intervals=20", "certificate.stationarity=off")
    assert run.solution is not None
    w = run.solution["w"].ravel()
    held, way = (
        w[106:].reshape(20, 2),
        lambda _, x, u: [x[2], x[3], u[0] * np.sin(x[4]), u[0] * np.cos(x[4]) - 9.81, u[1]],
    )
    state = np.zeros(5)
    for u in held:
        state = solve_ivp(way, (0, w[0] / 20), state, args=(u,), rtol=1e-10, atol=1e-12).y[:, -1]
    np.testing.assert_allclose(state, [0, 2.7, 0, 0, 2 * np.pi], atol=2e-3)
    assert (
        held[:, 0].min() >= 1 - 1e-7
        and held[:, 0].max() <= 20 + 1e-6
        and np.abs(held[:, 1]).max() <= 10 + 1e-6
    )
    coarse, fine = w[0], solved("quadrotor_flip", 100)
    assert 2 * np.pi / 10 < fine < coarse < 1.002 * fine


def test_the_car_drives_tangent_arc_tangent() -> None:
    """Never shorter than the string around the disc, laid here point by point."""
    angle = np.linspace(0.0, np.pi, 20001)
    rim = np.stack([-np.cos(angle), np.sin(angle) - 0.5], axis=1)
    string = np.vstack([[-2.0, 0.0], rim, [2.0, 0.0]])
    least = (
        ConvexHull(string).area - 2.0 - 2 * hypot(1.0, 0.5)
    )  # its length all around, without the way back below
    coarse, fine = (solved("obstacle_car", intervals) - LEAST for intervals in (20, 80))
    assert pytest.approx(least, abs=1e-6) == LEAST
    assert 0 < fine < 1e-6 < coarse < 2e-4
