"""Values beside their limits, and how far states are apart, by units."""

from __future__ import annotations

import numpy as np
import pytest

from benchbench.certificate.difference import angle, distance, rate, speed
from benchbench.certificate.limited import Limited
from benchbench.ground.arrays import Array
from benchbench.ocp.model import Coordinates
from benchbench.ocp.plan import Plan

INF = np.inf


def limited(values: list[list[float]], lower: list[float], upper: list[float]) -> Limited:
    count = len(lower)
    return Limited(
        tuple("abcdef"[:count]), ("m",) * count, np.array(values), np.array(lower), np.array(upper)
    )


def test_how_far_values_are_beyond_their_limits() -> None:
    of = limited([[-3.0, 5.0, 7.0], [2.0, 1.0, np.nan]], [-1.0, 0.0, -INF], [1.0, 4.0, INF])
    np.testing.assert_array_equal(of.excess, [[2, 1, 0], [1, 0, np.nan]])


def test_how_much_of_its_limits_a_value_uses_from_their_middle() -> None:
    """Between -1 and 5 the middle is 2 and half of the room 3; what has only one limit, or none, uses nothing."""
    of = limited(
        [[-1.0, 9.0, 9.0, 9.0], [3.5, 9.0, np.nan, 9.0]], [-1.0, -INF, -INF, 0.0], [5.0, INF, INF, INF]
    )
    np.testing.assert_array_equal(of.ratio, [[1, 0, 0, 0], [0.5, 0, np.nan, 0]])
    assert limited([[np.nan, 6.5]], [-1.0, -1.0], [5.0, 5.0]).ratio.tolist() == [
        [pytest.approx(np.nan, nan_ok=True), 1.5]
    ]


def test_limits_of_coordinates_or_others_along_the_rows() -> None:
    box = Coordinates(("a", "b"), ("m", "rad"), np.array([-1.0, -2.0]), np.array([1.0, 2.0]))
    values = np.array([[3.0, 0.0], [0.0, -5.0]])
    own = Limited.of(box, values)
    assert (own.names, own.units) == (box.names, box.units)
    np.testing.assert_array_equal(own.excess, [[2, 0], [0, 3]])
    along = Limited.of(box, values, (np.full((2, 2), -4.0), np.array([[2.0, 2.0], [9.0, 9.0]])))
    np.testing.assert_array_equal(along.excess, [[1, 0], [0, 1]])


def test_one_beside_the_other() -> None:
    """Limits that are the same for all rows go together with those that are not."""
    one = limited([[3.0], [0.0]], [-1.0], [1.0])
    other = Limited(
        ("z",), ("rad",), np.array([[0.0], [5.0]]), np.array([[1.0], [1.0]]), np.array([[2.0], [3.0]])
    )
    both = one.beside(other)
    assert (both.names, both.units) == (("a", "z"), ("m", "rad"))
    np.testing.assert_array_equal(both.values, [[3, 0], [0, 5]])
    np.testing.assert_array_equal(both.excess, [[2, 1], [0, 2]])
    np.testing.assert_array_equal(other.beside(one).excess, [[1, 2], [2, 0]])


def plan(coordinates: tuple[str, ...], velocities: tuple[str, ...]) -> Plan:
    """A plan of two nodes whose coordinates and velocities have these units."""

    def named(units: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(f"c{i}" for i in range(len(units)))

    q, v = np.zeros((2, len(coordinates))), np.zeros((2, len(velocities)))
    return Plan(
        np.arange(2.0), q, v, np.zeros((1, 1)), np.zeros(2), "hold", named(coordinates), coordinates, ("u",), ("N",),
        named(velocities), velocities,
    )  # fmt: skip


FLYING = plan(("m", "rad", "m", "1", "1", "1", "1"), ("m/s", "rad/s", "m/s", "rad/s", "1/s"))


def test_lengths_speeds_and_rates_are_those_of_their_units() -> None:
    apart = np.array([[3.0, 9, -4, 9, 9, 9, 9], [0, 9, 0, 9, 9, 9, 9]])
    assert distance(FLYING, apart).tolist() == [5, 0]
    moving = np.array([[-3.0, 0.5, 4, -2, 9], [0, -7, 0, 0.5, 9]])
    assert speed(FLYING, moving).tolist() == [5, 0]
    assert rate(FLYING, moving).tolist() == [2, 7]
    none = plan(("m",), ("m/s",))
    assert rate(none, np.ones((2, 1))).tolist() == [0, 0] and angle(none, np.ones((2, 1))).tolist() == [0, 0]


def turn(degrees: float) -> Array:
    half = np.radians(degrees) / 2
    return np.array([np.cos(half), 0.0, 0.0, np.sin(half)])


def test_angles_are_those_of_coordinates_or_of_a_turn() -> None:
    """A quaternion a little off is half an angle off."""
    apart = np.zeros((3, 7))
    apart[0, 1] = -0.25
    apart[1, 3:] = turn(40.1) - turn(40.0)
    apart[2, 1], apart[2, 3:] = 0.5, turn(40.1) - turn(40.0)
    assert angle(FLYING, apart) == pytest.approx([0.25, np.radians(0.1), 0.5], rel=1e-6)
