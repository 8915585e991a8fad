"""Lower bound on the travel time from speed limits and reach alone, without any dynamics, for any sequence of stops."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ocp.model import AXES, Model, Plant, space
from benchbench.ocp.motion import sample
from benchbench.ocp.scenario import Scenario
from benchbench.ocp.stop import Stop

STEP = 1e-3
"""Width in s of the cells in which the time of contact is searched; each cell is bounded from below."""


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


def rate_bound(scenario: Scenario, model: Model) -> tuple[float, str]:
    """Return the time in s that the slowest coordinate needs from start to end at its largest rate, and its name.

    Of coordinates whose rates are velocities of the same name; a robot that stands somewhere has no better bound.
    """
    own, rates, found = model.configuration.names, model.velocity, (0.0, "")
    way = scenario.end_point(model) - scenario.start_point(model)
    fixed = np.equal(scenario.ends(model).lower_q, scenario.ends(model).upper_q)
    for name, far, held in zip(own, way, fixed, strict=True):
        if held and far and name in rates.names:
            i = rates.index(name)
            found = max(found, (float(far / (rates.upper[i] if far > 0 else rates.lower[i])), name))
    return found


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
