"""What bounds a handover, or a transfer, from below, and which of its demands does: one proof for each, the largest counts."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchbench.certificate.contact_bound import Visit
from benchbench.certificate.leg import Leg, legs, yaw_rate
from benchbench.certificate.speed_bound import arm_reach, rate_bound, sequence_bound
from benchbench.certificate.turning import ByRate, ByTorque, Turning
from benchbench.ocp.model import AXES, AgileModel, Model, Plant, travels
from benchbench.ocp.stop import Stop
from benchbench.ocp.to_rest import ToRest

FINEST, LONGER = 1e-3, 3.0
"""s to which the time of the way from rest to rest is found, from below, and by which it may be longer than at full speed."""


@dataclass(frozen=True)
class Bound:
    """A travel time in s that no flight beats, and the demand that says so; `inf`: no flight keeps it."""

    seconds: float
    demand: str


def handover_bound(scenario: ToRest, model: Model, plant: Plant) -> Bound:
    """Return the largest bound of the sequence of stops for which it is least; all of them are proofs."""
    allowed = Bound(scenario.travel_time[0], "the least travel time allowed")
    if not travels(model):
        seconds, name = rate_bound(scenario, model)
        return max(allowed, Bound(seconds, f"rate of '{name}'"), key=_seconds)
    return max(allowed, _quickest(scenario, model, plant), key=_seconds)


def _quickest(scenario: ToRest, model: Model, plant: Plant) -> Bound:
    """A task is asked about before it is planned and when its plan is told: the last ones are kept, with what they are kept for."""
    for task, vehicle, known, bound in _KEPT:
        if task is scenario and vehicle is model and known is plant:
            return bound
    sequences = scenario.itinerary.sequences()
    found = min((_proved(scenario, made, model, plant) for made in sequences), key=_seconds)
    _KEPT.append((scenario, model, plant, found))
    return found


_KEPT: deque[tuple[ToRest, Model, Plant, Bound]] = deque(maxlen=4)


def level_bound(scenario: ToRest, model: Model, plant: Plant, proved: Bound) -> Bound | None:
    """Return the bound for flights whose nose is turned by the yaw torque alone, which is no proof for others.

    It is not below the bound that is proved. None where a flight makes another number of stops than one, no heading is asked, or the
    model does not say.
    """
    sequences = list(scenario.itinerary.sequences())
    if len(sequences) != 1 or len(sequences[0]) != 1 or not isinstance(model, AgileModel):
        return None
    (stop,) = sequences[0]
    if stop.heading_error is None or not np.isfinite(proved.seconds):
        return None
    turning = ByTorque(yaw_rate(model), model.level_yaw_acceleration)
    seconds = visit(scenario, stop, model, plant, turning).least(proved.seconds, scenario.travel_time[1])
    return Bound(seconds, f"the yaw torque turns the nose to the target{stop.label} and back")


def _seconds(bound: Bound) -> float:
    return bound.seconds


def _proved(scenario: ToRest, made: Sequence[Stop], model: Model, plant: Plant) -> Bound:
    direct = _direct(scenario, model)
    found = [direct, Bound(sequence_bound(scenario, made, model, plant), "speed and reach")]
    if len(made) == 1 and np.isfinite(found[1].seconds):
        found += _visited(scenario, made[0], model, plant, max(b.seconds for b in found))
    return max(found, key=_seconds)


def _direct(scenario: ToRest, model: Model) -> Bound:
    """The way from rest to rest on the axis that takes longest: half of the time from the start, half to the end."""
    first, last = legs(scenario, model)
    way = last.place - first.place
    index = [model.configuration.index(name) for name in AXES]
    speed = np.where(way > 0, model.velocity.upper[index], -model.velocity.lower[index])
    least = np.abs(way) / speed
    axis_bounds = [_axis(first, last, i, float(way[i]), float(least[i])) for i in range(len(AXES))]
    axis = int(np.argmax(axis_bounds))
    return Bound(axis_bounds[axis], f"speed and thrust along {AXES[axis]}")


def _axis(first: Leg, last: Leg, axis: int, way: float, least: float) -> float:
    """The time of the way along one axis, from `least` on, which full speed all the time takes."""
    if way == 0:
        return 0.0
    time = least + np.arange(0.0, LONGER, FINEST)
    (less, ahead), (back, more) = first.way(time / 2), last.way(time / 2)
    there = (ahead + back if way > 0 else less + more)[:, axis] >= abs(way)
    return float(max(time[int(np.argmax(there))] - FINEST, least)) if there.any() else float(time[-1])


def _visited(scenario: ToRest, stop: Stop, model: Model, plant: Plant, start: float) -> list[Bound]:
    """Come and go, then the same with the nose turned as fast as its limit allows."""
    latest, rate = scenario.travel_time[1], yaw_rate(model)
    come = visit(scenario, stop, model, plant, None).least(start, latest)
    found = [Bound(come, f"the way to the target{stop.label} and on")]
    if stop.heading_error is not None and np.isfinite(rate) and np.isfinite(come):
        turned = visit(scenario, stop, model, plant, ByRate(rate)).least(come, latest)
        found.append(Bound(turned, f"the yaw rate turns the nose to the target{stop.label} and back"))
    return [bound for bound in found if bound.seconds > start]


def visit(scenario: ToRest, stop: Stop, model: Model, plant: Plant, turning: Turning | None) -> Visit:
    """The flight by one stop as its bound sees it."""
    first, last = legs(scenario, model)
    index = [model.configuration.index(name) for name in AXES]
    reach = np.inf if stop.reach is None else arm_reach(model, plant) + stop.reach
    error = np.inf if stop.heading_error is None else stop.heading_error
    speed = np.maximum(model.velocity.upper[index], -model.velocity.lower[index])
    return Visit(first, last, stop, reach, error, turning, speed)
