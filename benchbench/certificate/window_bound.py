"""Lower bound on the travel time when the contact happens at given shares of the flight; no dynamics, no solve."""

from __future__ import annotations

import numpy as np

from benchbench.certificate.bound import AXES, STEP, arm_reach
from benchbench.certificate.limits import Limits
from benchbench.model import Model
from benchbench.motion import sample
from benchbench.plan import Array
from benchbench.scenario import Scenario


def window_bounds(scenario: Scenario, model: Model, limits: Limits, first: Array, last: Array) -> Array:
    """Return for each window a time in s that no certified plan with its contact there can beat; `inf` where none fits.

    first, last (n,): shares of the travel time t at which the contact begins and ends. On every axis the vehicle, no
    faster than its limit times `rate_ratio`, must be able to come within the arm's reach of the target by first t, and
    from there to within `end_position` of the end in (1 - last) t. Times are searched in cells of STEP.
    """
    (stop,) = scenario.itinerary.stops
    index = [model.configuration.index(name) for name in AXES]
    speed = model.velocity.upper[index] * limits.rate_ratio
    start, end = scenario.start_point(model)[index], scenario.end_point(model)[index]
    direct = np.max((np.abs(end - start) - limits.end_position) / speed)
    if "position" not in stop.contacts:
        return np.full(len(first), direct)
    reach = arm_reach(model, model.plant()) + stop.contacts["position"].limit
    time = np.arange(max(0.0, direct), scenario.travel_time[1] + STEP, STEP)
    bounds = np.full(len(first), np.inf)
    for i, (begin, finish) in enumerate(zip(first, last, strict=True)):
        fits = np.ones(len(time), bool)
        for share, place, left, slack in (
            (begin, start, begin, 0.0), (finish, end, 1 - finish, limits.end_position),
        ):  # fmt: skip
            target, moving = sample(stop.target, share * time)
            close = reach + slack + STEP * np.max(np.abs(moving), axis=0)
            fits &= np.all(np.abs(target - place) <= close + speed * (left * time[:, None] + STEP), axis=1)
        if fits.any():
            bounds[i] = time[int(np.argmax(fits))]
    return bounds
