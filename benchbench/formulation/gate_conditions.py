"""What a gate asks of the vehicle at one node, h <= 0: said here once, for every way to pose a race.

A ball: |p - w|^2 / r^2 <= 1. A rectangle: the node lies in its plane to `SLAB` and within the opening, and flies through
it; all linear. Speeds and heading besides, at the same node. The certificate has its own geometry.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

import casadi as ca
import numpy as np

from benchbench.ocp.track import HEADING, Gate, Opening

Reads = Literal["position", "velocity", "attitude"]
SLAB = 1e-4
"""How far a node that stands for the crossing of a rectangle may be from its plane, m."""
ACROSS = 1.0
"""Least speed across a rectangle, m/s, or half the gate's largest speed where that is less.

At 4 g a vehicle turns back within 13 mm at the earliest, so it cannot touch the plane and leave without crossing; and
1 mm of replay error moves the crossing by no more than 1 cm at 10 m/s along the plane.
"""
LEVEL = 0.2
"""Least level part of the nose, of 1, where a heading is asked: it points up or down by 78 degrees at most.

A vertical nose has no heading. A vehicle that yaws slowly would pitch to the vertical at that one node instead of turning; and an
error of the replay in attitude is up to 1 / LEVEL times as large in heading.
"""


@dataclass(frozen=True)
class GateCondition:
    """One kind of condition: h(state, numbers) <= 0, (rows,), where state is what it `reads`.

    position (3,) m and velocity (3,) m/s in the world, or for "attitude" the nose (3,), the body x axis. `count` numbers
    tell one gate from another. `gap`: h is (gap / limit)^2 - 1, the last number the limit in `unit`.
    """

    name: str
    reads: Reads
    count: int
    h: Callable[[ca.SX, ca.SX], ca.SX]
    unit: str = "1"
    gap: bool = False


def _in_ball(p: ca.SX, gate: ca.SX) -> ca.SX:
    return ca.sumsqr(p - gate[:3]) / gate[3] ** 2 - 1


def _in_opening(p: ca.SX, gate: ca.SX) -> ca.SX:
    """Rows of normal, side and up in units of half the smaller side: both ends of slab, width and height."""
    rows = []
    for axis in range(3):
        along = ca.dot(p - gate[:3], gate[3 + 3 * axis : 6 + 3 * axis])
        rows += [(sign * along - gate[12 + axis]) / gate[15] for sign in (1, -1)]
    return ca.vertcat(*rows)


BALL = GateCondition("ball", "position", 4, _in_ball, "m", gap=True)
OPENING = GateCondition("opening", "position", 16, _in_opening)
ACROSS_IT = GateCondition("across", "velocity", 3, lambda v, n: 1 - ca.dot(v, n))
EITHER_WAY = GateCondition("either_way", "velocity", 3, lambda v, n: 1 - ca.dot(v, n) ** 2)
FASTEST = GateCondition("fastest", "velocity", 1, lambda v, most: ca.sumsqr(v) / most**2 - 1, "m/s", gap=True)
SLOWEST = GateCondition("slowest", "velocity", 1, lambda v, least: 1 - ca.sumsqr(v) / least**2)
NOSE = GateCondition(
    "nose",
    "attitude",
    3,
    lambda n, to: to[2] * ca.sqrt(n[0] ** 2 + n[1] ** 2 + 1e-12) - ca.dot(n[:2], to[:2]),
    "1",
)
NOT_VERTICAL = GateCondition("not_vertical", "attitude", 1, lambda n, least: 1 - ca.sumsqr(n[:2]) / least**2)


def conditions(gate: Gate, margin: float = 0.0) -> Iterator[tuple[GateCondition, tuple[float, ...]]]:
    """Conditions of a gate with their numbers; `margin` is the share of its size that is left unused."""
    left = 1 - margin
    if gate.opening is None:
        yield BALL, (*gate.position, gate.radius * left)
    else:
        yield from _rectangle(gate, gate.opening, left)
    if gate.speed is not None:
        least, most = gate.speed
        if least > 0:
            yield SLOWEST, (least,)
        if np.isfinite(most):
            yield FASTEST, (most,)
    if gate.heading is not None:
        yield NOSE, (np.cos(gate.heading), np.sin(gate.heading), np.cos(HEADING))
        yield NOT_VERTICAL, (LEVEL,)


def _rectangle(
    gate: Gate, opening: Opening, left: float
) -> Iterator[tuple[GateCondition, tuple[float, ...]]]:
    side, up = opening.sides
    halves = opening.width / 2 * left, opening.height / 2 * left
    yield OPENING, (*gate.position, *opening.normal, *side, *up, SLAB, *halves, min(halves))
    sign = -1 if opening.direction == "against" else 1
    kind = EITHER_WAY if opening.direction == "either" else ACROSS_IT
    least = ACROSS if gate.speed is None else min(ACROSS, gate.speed[1] / 2)
    yield kind, tuple(sign * x / least for x in opening.normal)
