"""Lower bound on the travel time from speed limits and reach alone, without any dynamics.

It holds for plans that keep these limits exactly. The certificate forgives a little (`rate_ratio`, `end_position`); the
bounds of `window_bound`, which prune windows, grant that too.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import singledispatch

import numpy as np

from benchbench.arrays import Array
from benchbench.certificate.race_bound import race_bound
from benchbench.ocp.handover import Handover
from benchbench.ocp.model import Model, Plant, space
from benchbench.ocp.motion import sample
from benchbench.ocp.race import Race
from benchbench.ocp.scenario import Scenario
from benchbench.ocp.stop import Stop

AXES = ("x", "y", "z")
STEP = 1e-3
"""Width in s of the cells in which the time of contact is searched; each cell is bounded from below."""


@singledispatch
def lower_bound(scenario: Scenario, model: Model, plant: Plant) -> float:
    """Return a time in s that no plan within its limits can beat; of a kind that proves no more the least time allowed."""
    return scenario.travel_time[0]


lower_bound.register(Race, race_bound)


@lower_bound.register
def _(scenario: Handover, model: Model, plant: Plant) -> float:
    """Return the least of all sequences; `inf` when no allowed travel time reaches every stop asked for."""
    return min(sequence_bound(scenario, made, model, plant) for made in scenario.itinerary.sequences())


def sequence_bound(scenario: Scenario, made: Sequence[Stop], model: Model, plant: Plant) -> float:
    """Return a time in s that no plan that keeps its limits and makes these stops in this order can beat.

    Axis i needs |p_end - p_start|_i / v_max,i. Where contact asks for nearness (`Stop.reach`, the paper's nu_max), the
    vehicle must also be at some time t within the arm's reach plus that of the target on every axis, at
    times that follow each other for all stops, and needs the time from the last one to the end. From stop to stop
    each axis may choose its own time at the stop before, which can only make the bound smaller.
    """
    index = [model.configuration.index(name) for name in AXES]
    speed = model.velocity.upper[index]
    start, end = scenario.start_point(model)[index], scenario.end_point(model)[index]
    direct = float(np.max(np.abs(end - start) / speed))
    touched = [(stop.target, stop.reach) for stop in made if stop.reach is not None]
    if not touched:
        return direct
    time = np.arange(0.0, scenario.travel_time[1], STEP)
    arm, late = arm_reach(model, plant), speed * (time[:, None] + STEP)
    low, high = start - late, start + late
    at, place, near = np.ones(len(time), bool), np.tile(start, (len(time), 1)), 0.0  # of the stop before
    for motion, reach in touched:
        target, moving = sample(motion, time)
        close = arm + reach + STEP * np.max(np.abs(moving), axis=0)
        met = np.all((target >= low - close - near) & (target <= high + close + near), axis=1)
        at = np.logical_or.accumulate(at) & met
        away = speed * time[:, None]
        low = np.minimum.accumulate(np.where(at[:, None], target + away, np.inf)) - late
        high = np.maximum.accumulate(np.where(at[:, None], target - away, -np.inf)) + late
        place, near = target, close
    rest = np.max(np.maximum(np.abs(place - end) - near, 0.0) / speed, axis=1)
    return max(direct, float(np.min(np.where(at, time + rest, np.inf))))


def arm_reach(model: Model, plant: Plant, samples: int = 181) -> float:
    """Largest distance in m between the vehicle's position and its tool, over one arm coordinate at most.

    Attitude does not change it. Sampling an arc of 180 degrees at 181 points misses less than 4e-5 of it.
    """
    box, rest = model.configuration, space(model).origin()
    q: Array = np.tile(rest, (samples, 1))
    for i, name in enumerate(box.names):
        if name not in (*AXES, "roll", "pitch", "yaw") and box.units[i] != "1":
            q[:, i] = np.linspace(box.lower[i], box.upper[i], samples)
    position, _ = plant.tool(q, np.zeros((samples, len(model.velocity.names))))
    return float(np.max(np.linalg.norm(position, axis=1)))
