"""Pieces of a plan and their flight at once, on a point whose motion can be written down."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from test_replay import TIME, Point, plan, pushed, spring, swing

from benchbench.certificate import sequential
from benchbench.certificate.dop853 import along, step
from benchbench.certificate.pieces import Pieces, slope
from benchbench.certificate.replay import FAR, TOLERANCE, defects, fly, replay
from benchbench.certificate.shooting import PARTS, Shot, roughly, settled
from benchbench.ground.arrays import Array
from benchbench.ocp.plan import Plan

POINT = Point(pushed, gain=2.0)
STEPS = np.diff(TIME)
INPUTS = np.arange(1.0, 13) ** 2
"""Three control points for each of four intervals."""


def bezier() -> Plan:
    return plan(0 * TIME, 0 * TIME, INPUTS, "bezier")


def at(x: float, points: Array) -> float:
    """The quadratic with these control points."""
    a, b, c = points
    return float((1 - x) ** 2 * a + 2 * x * (1 - x) * b + x**2 * c)


def test_whole_intervals_are_the_pieces_of_a_plan() -> None:
    pieces = Pieces.of(bezier(), POINT)
    assert (pieces.half, pieces.interval.tolist()) == (1, [0, 1, 2, 3])
    assert (pieces.begin.tolist(), pieces.length.tolist()) == ([0, 0, 0, 0], [1, 1, 1, 1])
    np.testing.assert_array_equal(pieces.seconds, STEPS)
    assert pieces.last.tolist() == [0, 1, 2, 3]


def test_the_rate_of_a_piece_is_that_of_its_part_of_the_interval() -> None:
    """dq/dx = h 2 v and dv/dx = h u, h what the piece lasts and u that of its own fraction of the interval."""
    state = np.array([[5.0, 3.0], [6.0, -1.0], [7.0, 2.0], [8.0, 0.5]])
    whole = Pieces.of(bezier(), POINT)
    for x in (0.0, 0.25, 1.0):
        u = [at(x, INPUTS[3 * k : 3 * k + 3]) for k in range(4)]
        expected = np.column_stack([STEPS * 2 * state[:, 1], STEPS * u])
        np.testing.assert_allclose(whole.rate(x, state), expected, rtol=1e-14)
        batch = np.stack([state, 2 * state, -state])
        np.testing.assert_allclose(whole.rate(x, batch)[0], expected, rtol=1e-14)
        np.testing.assert_allclose(
            whole.rate(x, batch)[1:, :, 0], [2 * expected[:, 0], -expected[:, 0]], rtol=1e-14
        )
        np.testing.assert_allclose(whole.rate(x, batch)[1:, :, 1], [expected[:, 1]] * 2, rtol=1e-14)
    finer, piece, share = whole.split(np.array([1, 3, 1, 2]))
    assert piece.tolist() == [0, 1, 1, 1, 2, 3, 3] and finer.interval.tolist() == piece.tolist()
    np.testing.assert_allclose(share, [0, 0, 1 / 3, 2 / 3, 0, 0, 0.5])
    np.testing.assert_allclose(finer.begin, share)
    np.testing.assert_allclose(finer.length, [1, 1 / 3, 1 / 3, 1 / 3, 1, 0.5, 0.5])
    rates = finer.rate(0.5, np.ones((7, 2)))
    u = at(2 / 3 + 1 / 6, INPUTS[3:6])
    np.testing.assert_allclose(rates[3], STEPS[1] / 3 * np.array([2.0, u]), rtol=1e-14)
    only = finer.only(3)
    assert (only.interval.tolist(), only.begin.tolist(), only.length.tolist()) == (
        [1],
        [finer.begin[3]],
        [finer.length[3]],
    )
    np.testing.assert_allclose(only.rate(0.5, np.ones((1, 2))), rates[3:4], rtol=1e-14)


def test_pieces_are_split_again_within_themselves() -> None:
    once, _, _ = Pieces.of(bezier(), POINT).split(np.array([2, 1, 1, 1]))
    twice, piece, share = once.split(np.array([1, 4, 1, 1, 1]))
    assert (piece.tolist(), share.tolist()) == ([0, 1, 1, 1, 1, 2, 3, 4], [0, 0, 0.25, 0.5, 0.75, 0, 0, 0])
    assert twice.begin.tolist() == [0, 0.5, 0.625, 0.75, 0.875, 0, 0, 0]
    assert twice.length.tolist() == [0.5, 0.125, 0.125, 0.125, 0.125, 1, 1, 1]
    assert twice.last.tolist() == [4, 5, 6, 7]
    assert twice.starting(np.array([0, 2])).tolist() == [True, *[False] * 5, True, False]


def test_slopes_are_kinematics_and_accelerations() -> None:
    states, inputs = np.array([[1.0, 3.0], [2.0, 4.0]]), np.array([[7.0], [8.0]])
    assert slope(POINT, 1, states, inputs).tolist() == [[6.0, 7.0], [8.0, 8.0]]


def swinging(time: Array = TIME) -> Plan:
    return plan(*swing(time), np.full(len(time) - 1, 2.0), time=time)


def shot(of: Plan, start: Array | None = None) -> Shot:
    states = np.hstack([of.configuration, of.velocity])[:-1]
    return Shot.of(Pieces.of(of, Point(spring)), states if start is None else start)


FRACTIONS = np.array([0.2, 0.5, 1.0])


def exact(time: Array) -> Array:
    """The swing at the fractions of each interval, (N, 3, 2)."""
    when = time[:-1, None] + np.diff(time)[:, None] * FRACTIONS
    return np.stack(swing(when), axis=-1)


def test_a_flight_at_once_is_the_swing() -> None:
    """From states that are a tenth off at all nodes but the first, and without a cut piece."""
    off = swinging()
    wrong = replace(off, configuration=off.configuration + 0.1 * (np.arange(5) > 0)[:, None])
    whole = settled(shot(wrong), np.zeros(1, int), TOLERANCE, FAR)
    assert whole is not None
    np.testing.assert_allclose(whole.at(FRACTIONS), exact(TIME), atol=1e-9)
    np.testing.assert_allclose(whole.ends, np.column_stack(swing(TIME[1:])), atol=1e-9)
    np.testing.assert_allclose(shot(swinging()).at(FRACTIONS), exact(TIME), atol=1e-8)


@pytest.mark.parametrize("nodes", [[0, 2], [0, 1, 3]])
def test_it_begins_anew_where_it_is_held(nodes: list[int]) -> None:
    """No force and no speed: each interval shows where its flight began."""
    still = plan(0.1 * np.arange(5), 0 * TIME, np.zeros(4))
    found = settled(Shot.of(Pieces.of(still, POINT), np.hstack([still.configuration, still.velocity])[:-1]),
                    np.array(nodes), TOLERANCE, FAR)  # fmt: skip
    assert found is not None
    begun = [0.1 * max(node for node in nodes if node <= k) for k in range(4)]
    np.testing.assert_allclose(found.ends[:, 0], begun, atol=1e-12)


def test_a_long_interval_is_cut_until_each_piece_is_exact() -> None:
    """Five seconds of a swing of 6.28 s between two short ones; pieces of other intervals are left whole."""
    time = np.array([0.0, 0.3, 5.3, 5.6])
    whole = settled(shot(swinging(time)), np.zeros(1, int), TOLERANCE, FAR)
    assert whole is not None
    counted = np.bincount(whole.pieces.interval)
    assert counted[0] == counted[2] == 1 and 6 < counted[1] <= 3 * PARTS - 2
    assert np.max(whole.flown.error(TOLERANCE)) <= 1.0
    np.testing.assert_allclose(whole.at(FRACTIONS), exact(time), atol=1e-8)
    alone = settled(shot(swinging(time)), np.arange(3), TOLERANCE, FAR)
    assert alone is not None
    np.testing.assert_allclose(alone.ends, np.column_stack(swing(time[1:])), atol=1e-8)


@pytest.mark.parametrize(("error", "parts"), [(0.9, 1), (1.1, 2), (1.9, 2), (300.0, 3), (1e5, 5)])
def test_a_piece_is_cut_by_the_eighth_root_of_its_error_and_a_tenth_more(error: float, parts: int) -> None:
    """The error is set by what is tolerated; 1.1 * 300^(1/8) = 2.2 and 1.1 * 10^(5/8) = 4.6."""
    began = shot(swinging(np.array([0.0, 0.1, 1.1, 1.2])))
    tolerance = float(began.flown.error(1.0)[1]) / error
    found = settled(began, np.arange(3), tolerance, FAR)
    assert found is not None and np.bincount(found.pieces.interval).tolist() == [1, parts, 1]


def test_what_would_need_too_many_pieces_is_left_to_the_flight_in_turn() -> None:
    """A swing sixteen hundred seconds long in one interval of four."""
    time = np.array([0.0, 0.3, 0.6, 1600.0, 1600.3])
    assert settled(shot(swinging(time)), np.zeros(1, int), TOLERANCE, FAR) is None


@pytest.mark.parametrize(("far", "found"), [(4.0, True), (3.4, False)])
def test_what_goes_too_far_is_not_settled(far: float, found: bool) -> None:
    """The swing reaches 3.5 after half a period."""
    time = np.linspace(0.0, np.pi, 9)
    assert (settled(shot(swinging(time)), np.zeros(1, int), TOLERANCE, far) is not None) == found


def test_numbers_that_are_none_are_not_settled() -> None:
    bad = swinging()
    start = np.hstack([bad.configuration, bad.velocity])[:-1]
    start[2, 1] = np.nan
    assert settled(shot(bad, start), np.zeros(1, int), TOLERANCE, FAR) is None


def test_a_rough_flight_is_exact_where_it_is_a_polynomial() -> None:
    """Inputs that grow on a line: v of degree two and q of degree three, which RK4 gets right."""
    rising = plan(0 * TIME, 0 * TIME, 3 * TIME, "linear")
    start = np.full((4, 2), 9.0)
    start[0] = 0.0
    found = roughly(Pieces.of(rising, Point(pushed)), start, np.array([0]))
    np.testing.assert_allclose(found, np.column_stack([TIME**3 / 2, 1.5 * TIME**2])[:-1], atol=1e-13)
    assert start[1:].tolist() == [[9.0, 9.0]] * 3
    held = roughly(Pieces.of(rising, Point(pushed)), start, np.array([0, 2]))
    assert held[2].tolist() == [9.0, 9.0] and held[1].tolist() == pytest.approx(found[1].tolist())
    after = TIME[3] - TIME[2]
    grown = 9 + 3 * TIME[2] * after + 1.5 * after**2
    assert held[3, 1] == pytest.approx(grown)


def test_the_dense_output_meets_both_ends() -> None:
    def rate(x: float, y: Array) -> Array:
        return np.stack([y[..., 1], -y[..., 0]], axis=-1)

    made = step(rate, np.array([[1.0, 0.0], [0.0, 2.0]]))
    terms = made.curve()
    np.testing.assert_array_equal(along(terms, np.zeros(2)), made.start)
    np.testing.assert_allclose(along(terms, np.ones(2)), made.end, atol=1e-15)
    x = 0.37
    np.testing.assert_allclose(
        along(terms, np.full(2, x)), [[np.cos(x), -np.sin(x)], [2 * np.sin(x), 2 * np.cos(x)]], atol=2e-6
    )
    np.testing.assert_allclose(made.end, [[np.cos(1), -np.sin(1)], [2 * np.sin(1), 2 * np.cos(1)]], atol=1e-8)


def test_the_flight_in_turn_ends_where_it_breaks_down() -> None:
    """dv/dt = v^2 from 1 at 0 s, which has no number at 1 s; begun anew at 1.1 s with 0 it stands still."""
    wild = Point(lambda q, v, u: v**2)
    begun = plan(0 * TIME, np.array([1.0, 1.0, 0.0, 0.0, 0.0]), np.zeros(4))
    found = sequential.flight(begun, wild, FRACTIONS, (), TOLERANCE, FAR)
    when = TIME[:2, None] + STEPS[:2, None] * FRACTIONS
    np.testing.assert_allclose(found[:2, :, 1], 1 / (1 - when), rtol=1e-8)
    assert np.isfinite(found[2, 0]).all() and np.isnan(found[2, 2:]).all() and np.isnan(found[3]).all()
    anew = sequential.flight(begun, wild, FRACTIONS, (2, 3), TOLERANCE, FAR)
    np.testing.assert_allclose(anew[2:, :, 1], 0.0, atol=1e-12)
    ends = sequential.ends(begun, wild, TOLERANCE, FAR)
    np.testing.assert_allclose(ends[:, 1], [1 / 0.7, 1 / 0.8, 0, 0], rtol=1e-8)


def test_a_calm_plan_is_not_flown_in_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object) -> Array:
        raise AssertionError("flown in turn")

    monkeypatch.setattr(sequential, "ends", never)
    monkeypatch.setattr(sequential, "flight", never)
    for restarts in ((), (2,)):
        flight = replay(swinging(), Point(spring), restart_nodes=restarts)
        np.testing.assert_allclose(flight.configuration[:, 0], swing(flight.time)[0], atol=1e-8)
        fly(swinging(), Point(spring), restart_nodes=restarts)
    np.testing.assert_allclose(defects(swinging(), Point(spring)).velocity, 0, atol=1e-8)


def test_defects_and_flight_come_together() -> None:
    off = swinging()
    wrong = replace(off, velocity=off.velocity + 0.25 * (np.arange(5) == 2)[:, None])
    missed, flight = fly(wrong, Point(spring), samples=4, restart_nodes=(3,))
    h = TIME[3] - TIME[2]
    np.testing.assert_allclose(missed.velocity[:, 0], [0, -0.25, 0.25 * np.cos(h), 0], atol=1e-8)
    np.testing.assert_allclose(missed.configuration[:, 0], [0, 0, 0.25 * np.sin(h), 0], atol=1e-8)
    assert (flight.restarts, flight.nodes.tolist(), flight.broken_at) == ((3,), [0, 4, 8, 12, 16], None)
    np.testing.assert_allclose(flight.configuration[:, 0], swing(flight.time)[0], atol=1e-8)
    early = fly(wrong, Point(spring), restart_seconds=0.5)[1]
    assert early.restarts == (2, 3) and len(early.time) == 41
