"""Lower bound on the travel time when the contact happens at given shares of the flight; no dynamics, no solve."""

from __future__ import annotations

import numpy as np

from benchbench.certificate.limits import Limits
from benchbench.certificate.speed_bound import STEP, arm_reach, rate_bound
from benchbench.ground.arrays import Array
from benchbench.ocp.model import AXES, Model, travels
from benchbench.ocp.motion import sample
from benchbench.ocp.scenario import Scenario

CELLS = 250
"""Cells that are looked at together; windows whose bound is found leave."""


def window_bounds(scenario: Scenario, model: Model, limits: Limits, first: Array, last: Array) -> Array:
    """Return for each window a time in s that no certified plan with its contact there can beat; `inf` where none fits.

    first, last (n,): shares of the travel time t at which the contact begins and ends. On every axis the vehicle, no
    faster than its limit times `rate_ratio`, must be able to come within the arm's reach of the target by first t, and
    from there to within `end_position` of the end in (1 - last) t. Times are searched in cells
    of STEP, the earliest first; the target is known in cells of the same width.
    """
    (stop,) = scenario.itinerary.stops
    if not travels(model):
        return np.full(len(first), rate_bound(scenario, model)[0] / limits.rate_ratio)
    index = [model.configuration.index(name) for name in AXES]
    speed = model.velocity.upper[index] * limits.rate_ratio
    start, end = scenario.start_point(model)[index], scenario.end_point(model)[index]
    direct = np.max((np.abs(end - start) - limits.end_position) / speed)
    if stop.reach is None:
        return np.full(len(first), direct)
    reach = arm_reach(model, model.plant()) + stop.reach
    bounds, low = np.full(len(first), np.inf), max(0.0, direct)
    time = np.arange(0.0, scenario.travel_time[1] + STEP, STEP)
    target, moving = sample(stop.target, time)
    blur = 2 * STEP * np.max(np.abs(moving), axis=0)
    ends = ((first, start, first, 0.0), (last, end, 1 - last, limits.end_position))
    late_enough = time[time > low - STEP]
    for begin in range(0, len(late_enough), CELLS):
        cells = late_enough[begin : begin + CELLS]
        left = np.flatnonzero(np.isinf(bounds))
        fits = np.ones((len(left), len(cells)), bool)
        for share, place, leg, slack in ends:
            there = target[(share[left, None] * cells / STEP).astype(int)]
            near = reach + slack + blur + speed * (leg[left, None] * cells + STEP)[:, :, None]
            fits &= np.all(np.abs(there - place) <= near, axis=2)
        found = fits.any(axis=1)
        bounds[left[found]] = cells[np.argmax(fits[found], axis=1)]
    return np.maximum(bounds, direct)
