"""How a flown path passes gates, by geometry alone: in order, between samples too, at which speed and with which heading.

Written apart from the conditions that planners use.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ocp.track import HEADING, Gate, Opening


@dataclass(frozen=True)
class Pass:
    """How one gate was passed, at `time` (s): `beyond` its ball or the edge of its opening, m, negative inside.

    `inside`: within the allowance, and after the gate before. first, last: the pieces of the path (from sample k to
    k + 1) in which the gate is passed. An opening that is never crossed in its direction is infinitely far.
    """

    time: float
    beyond: float
    inside: bool
    first: int = 0
    last: int = 0


@dataclass(frozen=True)
class Manner:
    """By how much speed (m/s) and heading (rad) are off what a gate asks for, at the best instant of its passing."""

    speed: float
    heading: float


def passes(time: Array, position: Array, gates: tuple[Gate, ...], allowance: float) -> tuple[Pass, ...]:
    """Follow a path (m,) s, (m, 3) m, straight between its points, through the gates in order.

    A gate counts from the moment the one before was entered. Of each gate the nearest point of the first stay inside is
    told; of one that is never entered, and of all after it, the nearest point from there on.
    """
    found: list[Pass] = []
    first, share = 0, 0.0
    for gate in gates:
        beyond, at = _nearest(position[first:], gate, share)
        inside = beyond <= allowance
        if not inside.any() or (found and not found[-1].inside):
            k = int(np.nanargmin(beyond)) if np.isfinite(beyond).any() else 0
            found.append(Pass(_time(time, first + k, at[k]), float(beyond[k]), False))
            continue
        entered = int(np.argmax(inside))
        left = entered + int(np.argmin(np.append(inside[entered:], False)))
        k = entered + int(np.argmin(beyond[entered:left]))
        found.append(
            Pass(_time(time, first + k, at[k]), float(beyond[k]), True, first + entered, first + left - 1)
        )
        share = _entry(position[first + entered :], gate, allowance, share if entered == 0 else 0.0)
        first += entered
    return tuple(found)


def manner(
    gate: Gate, one: Pass, time: Array, position: Array, velocity: Array, nose: Array, allowance: float
) -> Manner:
    """Speed and heading in passing; velocity and nose (m, 3) belong to the samples of the path.

    Asked at the nearest point, and of a ball at all samples inside, of which the best one counts.
    """
    inner = np.arange(one.first + 1, one.last + 1)
    far = np.linalg.norm(position[inner] - np.array(gate.position), axis=1)
    inner = inner[far <= gate.radius + allowance] if gate.opening is None else inner[:0]
    fast, ahead = (
        np.vstack([[np.interp(one.time, time, column) for column in values.T], values[inner]])
        for values in (velocity, nose)
    )
    speed = np.linalg.norm(fast, axis=1)
    low, high = gate.speed or (0.0, np.inf)
    slow = np.maximum(np.maximum(low - speed, speed - high), 0.0)
    turned = np.zeros(len(slow))
    if gate.heading is not None:
        off = np.arctan2(ahead[:, 1], ahead[:, 0]) - gate.heading
        turned = np.maximum(np.abs((off + np.pi) % (2 * np.pi) - np.pi) - HEADING, 0.0)
    best = int(np.argmin(slow + turned))
    return Manner(float(slow[best]), float(turned[best]))


def _nearest(position: Array, gate: Gate, after: float) -> tuple[Array, Array]:
    """How far each straight piece of a path stays beyond a gate, and where on the piece (share)."""
    if gate.opening is not None:
        return _crossing(position, gate, gate.opening, after)
    start, way = position[:-1], np.diff(position, axis=0)
    to = np.array(gate.position) - start
    length = np.sum(way**2, axis=1)
    share = np.clip(np.sum(to * way, axis=1) / np.maximum(length, 1e-300), 0.0, 1.0)
    share[:1] = np.maximum(share[:1], after)
    return np.linalg.norm(to - share[:, None] * way, axis=1) - gate.radius, share


def _crossing(position: Array, gate: Gate, opening: Opening, after: float) -> tuple[Array, Array]:
    """Where each piece crosses the plane in the direction asked for; infinitely far where it does not."""
    side, up = (np.array(axis) for axis in opening.sides)
    from_centre = position - np.array(gate.position)
    height = from_centre @ np.array(opening.normal)
    before, behind = height[:-1], height[1:]
    along, against = (before < 0) & (behind >= 0), (before > 0) & (behind <= 0)
    crossed = {"along": along, "against": against, "either": along | against}[opening.direction]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(crossed, before / (before - behind), 0.0)
    crossed[:1] &= share[:1] >= after
    there = from_centre[:-1] + share[:, None] * np.diff(position, axis=0)
    out = np.maximum(np.abs(there @ side) - opening.width / 2, np.abs(there @ up) - opening.height / 2)
    return np.where(crossed, out, np.inf), share


def _entry(position: Array, gate: Gate, allowance: float, after: float) -> float:
    """Share of the first piece at which the path enters the gate."""
    if gate.opening is not None:
        return float(_crossing(position[:2], gate, gate.opening, after)[1][0])
    start, way = position[0] - np.array(gate.position), position[1] - position[0]
    a, b, c = way @ way, start @ way, start @ start - (gate.radius + allowance) ** 2
    root = (-b - np.sqrt(max(b * b - a * c, 0.0))) / a if a > 0 else 0.0
    return float(np.clip(root, after, 1.0))


def _time(time: Array, piece: int, share: float) -> float:
    return float(time[piece] + share * (time[piece + 1] - time[piece]))
