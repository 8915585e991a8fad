"""The replay and its defects on plants that can be integrated by hand, and one that blows up."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from benchbench.certificate.replay import defects, replay
from benchbench.ground.arrays import Array
from benchbench.ocp.model import Plant
from benchbench.ocp.plan import Interpolation, Plan


class Point(Plant):
    """One coordinate, dq/dt = gain v, dv/dt = a(q, v, u)."""

    def __init__(self, a: Callable[[Array, Array, Array], Array], gain: float = 1.0) -> None:
        self.a, self.gain = a, gain

    def acceleration(self, q: Array, v: Array, u: Array) -> Array:
        return self.a(q, v, u)

    def kinematics(self, q: Array, v: Array) -> Array:
        return self.gain * v

    def tool(self, q: Array, v: Array) -> tuple[Array, Array]:
        return np.repeat(q, 3, axis=-1), np.repeat(v, 3, axis=-1)

    def nose(self, q: Array) -> Array:
        return np.ones((*q.shape[:-1], 3))

    def skeleton(self, q: Array) -> dict[str, Array]:
        return {}


def pushed(q: Array, v: Array, u: Array) -> Array:
    return u


def spring(q: Array, v: Array, u: Array) -> Array:
    return u - q


TIME = np.array([0.0, 0.3, 0.5, 1.1, 1.6])


def plan(q: Array, v: Array, u: Array, how: Interpolation = "hold", time: Array = TIME) -> Plan:
    idle = np.zeros(len(time))
    return Plan(time, q[:, None], v[:, None], u[:, None], idle, how, ("x",), ("m",), ("u",), ("m/s^2",))


def swing(time: Array) -> tuple[Array, Array]:
    """From 0.5 at rest around 2, which the input holds: q = 2 - 1.5 cos t."""
    return 2 - 1.5 * np.cos(time), 1.5 * np.sin(time)


def swinging() -> Plan:
    return plan(*swing(TIME), np.full(4, 2.0))


def test_an_oscillator_at_every_sample() -> None:
    found = replay(swinging(), Point(spring))
    step = np.diff(TIME)[:, None] * np.arange(10) / 10
    np.testing.assert_allclose(found.time, [*(TIME[:-1, None] + step).ravel(), 1.6], atol=1e-12)
    np.testing.assert_allclose(found.configuration[:, 0], swing(found.time)[0], atol=1e-8)
    np.testing.assert_allclose(found.velocity[:, 0], swing(found.time)[1], atol=1e-8)
    assert (found.nodes.tolist(), found.restarts, found.broken_at) == ([0, 10, 20, 30, 40], (), None)
    missed = defects(swinging(), Point(spring))
    assert missed.configuration.shape == missed.velocity.shape == (4, 1)
    np.testing.assert_allclose(np.hstack([missed.configuration, missed.velocity]), 0, atol=1e-8)


def test_samples_per_interval() -> None:
    found = replay(swinging(), Point(spring), samples=3)
    np.testing.assert_allclose(found.time[:5], [0, 0.1, 0.2, 0.3, 0.3 + 0.2 / 3], atol=1e-12)
    np.testing.assert_allclose(found.configuration[:, 0], swing(found.time)[0], atol=1e-8)
    assert found.nodes.tolist() == [0, 3, 6, 9, 12]


def test_kinematics_are_the_plants_own() -> None:
    """Velocities that count double: dq/dt = 2 v."""
    v = 0.5 * TIME
    moving = plan(0.5 * TIME**2, v, np.full(4, 0.5))
    missed = defects(moving, Point(pushed, 2.0))
    np.testing.assert_allclose(missed.configuration, 0, atol=1e-9)
    np.testing.assert_allclose(
        replay(moving, Point(pushed, 2.0)).configuration[-1, 0], 0.5 * 1.6**2, atol=1e-9
    )


@pytest.mark.parametrize("how", ["hold", "linear", "bezier"])
def test_inputs_in_between(how: Interpolation) -> None:
    """Held: dv = u h. On a line: dv = (u0 + u1) h / 2. Three control points: dv = (u0 + u1 + u2) h / 3."""
    count = {"hold": 4, "linear": 5, "bezier": 12}[how]
    u = np.arange(1.0, count + 1) ** 2
    h = np.diff(TIME)
    whole = {"hold": lambda: u * h, "linear": lambda: (u[:-1] + u[1:]) / 2 * h,
             "bezier": lambda: u.reshape(4, 3).mean(axis=1) * h}[how]()  # fmt: skip
    found = defects(plan(0 * TIME, 0 * TIME, u, how), Point(pushed))
    np.testing.assert_allclose(found.velocity[:, 0], whole, rtol=1e-9)
    flown = replay(plan(0 * TIME, 0 * TIME, u, how), Point(pushed))
    np.testing.assert_allclose(flown.velocity[flown.nodes[1:], 0], np.cumsum(whole), rtol=1e-9)


def test_defects_are_reached_minus_planned() -> None:
    q, v = swing(TIME)
    q[-1] += 0.25
    v[2] -= 0.5
    missed = defects(plan(q, v, np.full(4, 2.0)), Point(spring))
    h = TIME[3] - TIME[2]
    np.testing.assert_allclose(missed.configuration[:, 0], [0, 0, -0.5 * np.sin(h), -0.25], atol=1e-8)
    np.testing.assert_allclose(missed.velocity[:, 0], [0, 0.5, -0.5 * np.cos(h), 0], atol=1e-8)


def off() -> Plan:
    """All planned nodes 0.1 m off at rest, with no force: what is flown from each tells where a flight began."""
    return plan(0.1 * np.arange(5), 0 * TIME, np.zeros(4))


@pytest.mark.parametrize(
    ("seconds", "nodes", "restarts"),
    [
        (None, (), ()),
        (None, (3, 1), (1, 3)),
        (0.5, (), (2, 3)),
        (0.5, (1, 2), (1, 2, 3)),
        (
            0.75,
            (),
            (2,),
        ),  # 0.75 s is nearer to 0.5 s than to 1.1 s; 1.5 s to the end, where none starts again
        (0.1, (), (1, 2, 3)),  # 0.1 s is nearest to the start
        (1.6, (), ()),
        (9.0, (), ()),
    ],
)
def test_restarts(seconds: float | None, nodes: tuple[int, ...], restarts: tuple[int, ...]) -> None:
    """The sample at a restart is the one before it."""
    found = replay(off(), Point(pushed), restart_seconds=seconds, restart_nodes=nodes)
    assert found.restarts == restarts
    begins = np.array([0.1 * max((k for k in restarts if k < node), default=0) for node in range(1, 5)])
    np.testing.assert_allclose(found.configuration[found.nodes[1:], 0], begins, atol=1e-12)


def test_a_breakdown_has_a_time_and_no_numbers_after_it() -> None:
    """dv/dt = v^2 from 1: v = 1 / (1 - t), which leaves any room just before 1 s; q = -log(1 - t)."""
    wild = plan(0 * TIME, np.ones(5), np.zeros(4))
    found = replay(wild, Point(lambda q, v, u: v**2))
    assert found.broken_at == pytest.approx(0.5 + 0.6 * 0.9)
    k = int(np.argmax(found.time >= found.broken_at))
    assert np.isfinite(found.velocity[:k]).all() and np.isnan(found.velocity[k:]).all()
    assert np.isnan(found.configuration[k:]).all()
    np.testing.assert_allclose(found.velocity[:k, 0], 1 / (1 - found.time[:k]), rtol=1e-5)
    assert len(found.time) == 41


def test_a_defect_of_a_breakdown_is_no_number() -> None:
    missed = defects(plan(0 * TIME, 2 * np.ones(5), np.zeros(4)), Point(lambda q, v, u: v**2))
    assert np.isnan(missed.configuration).all() and np.isnan(missed.velocity).all()
    calm = defects(plan(0 * TIME, np.ones(5), np.zeros(4)), Point(lambda q, v, u: v**2))
    np.testing.assert_allclose(calm.velocity[:, 0], 1 / (1 - np.diff(TIME)) - 1, rtol=1e-8)


def test_a_replay_that_takes_too_many_steps_is_given_up() -> None:
    """A spring of 10^10 / s^2 needs a hundred thousand steps a second; the time is that of the first sample not reached."""
    stiff = plan(np.ones(5), 0 * TIME, np.zeros(4))
    calls = 0

    def a(q: Array, v: Array, u: Array) -> Array:
        nonlocal calls
        calls += 1
        return -1e10 * q

    found = replay(stiff, Point(a))
    assert found.broken_at == pytest.approx(0.03)
    assert calls < 6000
    assert np.isnan(found.velocity[1:]).all()


def test_a_long_plan_has_more_evaluations_in_all() -> None:
    """250 intervals with the steps of a mild oscillator each: all are flown."""
    time = np.linspace(0.0, 250.0, 251)
    q, v = swing(time)
    found = replay(plan(q, v, np.full(250, 2.0), time=time), Point(spring), samples=1)
    assert found.broken_at is None
    np.testing.assert_allclose(found.configuration[:, 0], swing(found.time)[0], atol=1e-6)


@pytest.mark.parametrize(("speed", "broken"), [(999.0, False), (1001.0, True)])
def test_what_is_a_kilometre_away_has_left(speed: float, broken: bool) -> None:
    still = plan(np.zeros(5), np.full(5, speed), np.zeros(4))
    calm = replay(still, Point(lambda q, v, u: 0 * v, 0.0))
    assert (calm.broken_at is not None) == broken
