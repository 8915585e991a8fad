"""Classics of optimal control come out as published, and as their discretisation must."""

from __future__ import annotations

from math import sqrt

import pytest

import benchbench as bb
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
