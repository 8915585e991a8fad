"""Lower bounds on the time of a race from largest thrust alone, for a fixed order, for a first part of one, for any.

Whatever its attitude, the vehicle's acceleration a lies in the ball |a - gravity| <= f, f = largest thrust / mass; no drag
pushes. From rest, every flight through the gates then takes at least

    sqrt(2 L / (f + g)),   L the length of the straight lines between the balls, and for every direction n
    sum over the runs of p . n  of  sqrt(2 D (1 / a_plus + 1 / a_minus)),   the last run, whose end is free, sqrt(2 D / a_plus)

where a run is a way D from one turning point of p . n to the next that the order of the gates forces: p . n is at rest at
every turning point, and a . n is between -a_minus and a_plus. Both are proofs. The time-optimal flight of a point mass
(`benchbench.planning.race_start`) is not: it is a local solution, and its thrust is held over intervals, which the vehicle
need not do. It would be a bound if it were solved globally and in continuous time.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ocp.model import Model, Plant, racing, space
from benchbench.ocp.race import Race
from benchbench.ocp.track import Gate

DIRECTIONS = 400
"""Directions tried; each gives a bound, more of them a slightly better one."""
FAR = 1e9
"""Metres after which no ramp of a limit goes on."""


def race_bound(race: Race, model: Model, plant: Plant) -> float:
    """Return a time in s that no race can beat; where the order is free, in no order."""
    if race.order == "free":
        return order_bound(race, model, plant, ())
    return _through(race, race.goals, *_acceleration(race, model, plant))


def order_bound(race: Race, model: Model, plant: Plant, first: Sequence[int]) -> float:
    """Return the same for all orders that begin with the gates `first`, numbered from 1 as they are listed.

    A flight through all gates is one through those, any one of the others, and the end.
    """
    gates, end = race.listed, race.goals[-1]
    begun = tuple(gates[i - 1] for i in first)
    rest = [gate for i, gate in enumerate(gates, 1) if i not in first]
    thrust, gravity = _acceleration(race, model, plant)
    ways = [(*begun, gate, end) for gate in rest] or [(*begun, end)]
    return max(_through(race, way, thrust, gravity) for way in ways)


def _acceleration(race: Race, model: Model, plant: Plant) -> tuple[float, Array]:
    """Largest thrust over mass and gravity (3,), m/s^2."""
    still = np.zeros(len(model.velocity.names))
    gravity = plant.acceleration(space(model).origin(), still, 0 * model.hover())[:3]
    metres = np.append(race.flown(model, race.grid_intervals + 1), FAR)
    return float(np.max(racing(model).specific_thrust(metres))), np.asarray(gravity)


def _through(race: Race, goals: Sequence[Gate], thrust: float, gravity: Array) -> float:
    points = np.array([race.start_position, *(goal.position for goal in goals)])
    radii = np.array([0.0, *(goal.radius for goal in goals)])
    if race.end_velocity == "rest":
        radii[-1] = 0.0
    apart = np.maximum(np.linalg.norm(np.diff(points, axis=0), axis=1) - radii[:-1] - radii[1:], 0.0)
    most = thrust + float(np.linalg.norm(gravity))
    speed = float(np.linalg.norm(list(race.start_velocity.values()))) if race.start_velocity else 0.0
    along = (np.sqrt(speed**2 + 2 * most * float(np.sum(apart))) - speed) / most
    if speed > 0:
        return float(along)
    return float(max(along, np.max(_turning(points, radii, thrust, gravity, race.end_velocity == "rest"))))


def _turning(points: Array, radii: Array, thrust: float, gravity: Array, rest: bool) -> Array:
    """Bound of each direction, (directions,) s: the tightest way of p . n through the intervals w . n -+ r."""
    ways = _directions()
    pull = ways @ gravity
    up, down = np.maximum(thrust + pull, 0.0), np.maximum(thrust - pull, 0.0)
    both = 1 / np.maximum(up, 1e-12) + 1 / np.maximum(down, 1e-12)
    at, run = ways @ points[0], np.zeros(len(ways))
    time, heading = np.zeros(len(ways)), np.zeros(len(ways))
    for point, radius in zip(points[1:], radii[1:], strict=True):
        step = np.clip(at, ways @ point - radius, ways @ point + radius) - at
        turned = step * heading < 0
        time += np.where(turned, np.sqrt(2 * run * both), 0.0)
        run = np.where(turned, 0.0, run) + np.abs(step)
        heading = np.where(step == 0, heading, np.sign(step))
        at = at + step
    last = both if rest else 1 / np.maximum(np.where(heading > 0, up, down), 1e-12)
    return np.asarray(time + np.sqrt(2 * run * last))


@cache
def _directions() -> Array:
    """Half of a Fibonacci sphere, and the axes; the opposite of a direction says the same."""
    k = np.arange(DIRECTIONS) + 0.5
    height, turn = k / DIRECTIONS, np.pi * (1 + np.sqrt(5)) * k
    ring = np.sqrt(1 - height**2)
    sphere = np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=1)
    return np.vstack([np.eye(3), sphere])
