"""A smooth start: minimum-jerk flights to the target and on to the end, tilted as they accelerate."""

from __future__ import annotations

from dataclasses import replace
from functools import singledispatch
from typing import final

import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ground.errors import IncompatibleCase
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.handover import Handover
from benchbench.ocp.model import AXES, travels
from benchbench.ocp.motion import sample
from benchbench.ocp.plan import Plan
from benchbench.ocp.scenario import Scenario
from benchbench.planning.case import Case, Guess
from benchbench.planning.guess import hovering, over

PEAK = 1.875
"""Largest speed of a minimum-jerk flight from rest to rest, times its duration over its length."""


@final
@dataclass(frozen=True)
class MinimumJerk(Guess):
    """Polynomials of fifth degree (Flash & Hogan 1985, doi:10.1523/JNEUROSCI.05-07-01688.1) over the target.

    Corners are those of the straight line, flown as fast as the speed limits allow; the vehicle meets the target with
    its velocity. Roll and pitch lean into the acceleration where they are coordinates; quaternions are blended.
    """

    def plan(self, case: Case, ledger: Ledger) -> Plan:
        """Costs nothing; the time of contact is a fixed point of the distance to where the target is then.

        Raises IncompatibleCase for another kind of scenario.
        """
        check_way(case.scenario)
        scenario, rest = case.scenario, np.zeros(len(case.model.configuration.names))
        most = np.full(len(rest), np.inf)
        own, rated = _rated(case)
        most[own] = case.model.velocity.upper[rated]
        start, end = scenario.start_point(case.model), scenario.end_point(case.model)
        corners, speeds, times = [start], [rest], [0.0]
        for stop in scenario.itinerary.listed:
            when = times[-1] + scenario.itinerary.middle * scenario.travel_time_guess
            for _ in range(20):
                when = times[-1] + _duration(over(case, stop, when) - corners[-1], most)
            corners.append(over(case, stop, when))
            moving = sample(stop.target, np.array([when]))[1][0]
            speeds.append(np.concatenate([moving, rest[3:]]) if travels(case.model) else rest)
            times.append(when)
        times.append(times[-1] + _duration(end - corners[-1], most))
        return _through(case, np.array(times), [*corners, end], [*speeds, rest])


@singledispatch
def check_way(scenario: Scenario) -> None:
    """Raise IncompatibleCase unless the way of this kind of scenario leads over its stops to rest at its end."""
    raise IncompatibleCase("guess", "'minimum_jerk' flies handovers", "simple, line, point_mass, phases")


@check_way.register
def _(scenario: Handover) -> None:
    """It does."""


def _through(case: Case, times: Array, corners: list[Array], speeds: list[Array]) -> Plan:
    """Fly through corners with given speeds at given times; the stops are claimed at the nearest nodes."""
    n, itinerary = case.scenario.grid_intervals, case.scenario.itinerary
    time = np.linspace(0.0, times[-1], n + 1)
    leg = np.clip(np.searchsorted(times, time, side="right") - 1, 0, len(times) - 2)
    flown = [
        _flight(time, times[i : i + 2], corners[i : i + 2], speeds[i : i + 2]) for i in range(len(times) - 1)
    ]
    q, v, a = (np.stack(parts)[leg, np.arange(n + 1)] for parts in zip(*flown, strict=True))
    progress = np.zeros((n + 1, len(itinerary.stops)))
    for stop, when in zip(itinerary.listed, times[1:-1], strict=True):
        first = int(np.clip(np.searchsorted(time, when), 1, n - stop.kappa_init))
        progress[first : first + stop.kappa_init, itinerary.names.index(stop.name)] = 1.0
    own, rated = _rated(case)
    rates = np.zeros((n + 1, len(case.model.velocity.names)))
    rates[:, rated] = v[:, own]
    return replace(hovering(case, time, _tilted(q, a, case), progress), velocity=rates)


def _rated(case: Case) -> tuple[list[int], list[int]]:
    """Coordinates whose rates are velocities of the vehicle, and which; those of a quaternion are none."""
    names, rates = case.model.configuration.names, case.model.velocity.names
    place = len(AXES) if travels(case.model) else 0
    rated = [i for i, name in enumerate(rates) if i < place or name in names]
    return [i if i < place else names.index(rates[i]) for i in rated], rated


def _duration(way: Array, most: Array) -> float:
    limited = np.isfinite(most)
    return max(float(np.max(PEAK * np.abs(way[limited]) / most[limited])), 0.05)


def _flight(
    time: Array, ends: Array, corners: list[Array], speeds: list[Array]
) -> tuple[Array, Array, Array]:
    """q, v and acceleration at `time`, each (n, n_q), with no acceleration at both ends."""
    h = ends[1] - ends[0]
    s = np.clip((time - ends[0]) / h, 0.0, 1.0)[:, None]
    (q0, q1), (v0, v1) = corners, speeds
    way, v0, v1 = q1 - q0, v0 * h, v1 * h
    c3, c4, c5 = 10 * way - 6 * v0 - 4 * v1, -15 * way + 8 * v0 + 7 * v1, 6 * way - 3 * v0 - 3 * v1
    q = q0 + v0 * s + c3 * s**3 + c4 * s**4 + c5 * s**5
    v = (v0 + 3 * c3 * s**2 + 4 * c4 * s**3 + 5 * c5 * s**4) / h
    return q, v, (6 * c3 * s + 12 * c4 * s**2 + 20 * c5 * s**3) / h**2


def _tilted(q: Array, acceleration: Array, case: Case) -> Array:
    """Roll and pitch that point the thrust along acceleration and weight, within limits; not at the ends."""
    box, names = case.scenario.limits(case.model), case.model.configuration.names
    tilted = q.copy()
    for name, axis, sign in (("pitch", 0, 1.0), ("roll", 1, -1.0)):
        if name in names:
            tilted[1:-1, names.index(name)] += sign * np.arctan2(acceleration[1:-1, axis], 9.81)
    return np.clip(tilted, box.lower, box.upper)
