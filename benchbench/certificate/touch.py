"""How the magnet meets the ball: how fast where it first comes within reach, how long before the window, through what on the way.

The target of a contact is the uppermost point of a ball on a stand, which is a vertical column of the ball's radius. None of it is
judged here: a contact that asks for it does (a speed of approach), and a flight does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchbench.certificate.audit import Audit, ContactEvidence
from benchbench.ground.arrays import Array
from benchbench.ocp.motion import sample


@dataclass(frozen=True)
class Touch:
    """speed: m/s relative to the ball where it is first within reach; before: s from then to the window, 0 inside it.

    passage: m that the end effector is inside ball or stand before the window, at the deepest; 0 outside.
    """

    speed: float
    before: float
    passage: float


def touch(evidence: ContactEvidence, one: Audit, radius: float, reach: float) -> Touch | None:
    """Return how the first touch of a stop goes on the replay; None where the ball is never within reach up to its window's end."""
    flight, plan = evidence.flight, evidence.plan
    if one.window is None:
        return None
    end, opens = flight.nodes[one.window[1]], float(plan.time[one.window[0]])
    time = flight.time[: end + 1]
    position, velocity = sample(one.stop.target, time)
    tip, way = evidence.plant.tool(flight.configuration[: end + 1], flight.velocity[: end + 1])
    offset = tip - position + np.array([0.0, 0.0, radius])
    within = np.flatnonzero(np.linalg.norm(offset, axis=1) - radius <= reach)
    if not len(within):
        return None
    first = int(within[0])
    speed = float(np.linalg.norm(way[first] - velocity[first]))
    before = time < opens
    depth = float(np.max(_depth(offset[before], radius), initial=0.0))
    return Touch(speed, max(opens - float(time[first]), 0.0), depth)


def _depth(offset: Array, radius: float) -> Array:
    """How far inside ball or stand points (n, 3) from the ball's centre are, m; negative outside."""
    ball = radius - np.linalg.norm(offset, axis=1)
    stand = np.where(offset[:, 2] < 0, radius - np.linalg.norm(offset[:, :2], axis=1), -np.inf)
    return np.asarray(np.maximum(ball, stand))
