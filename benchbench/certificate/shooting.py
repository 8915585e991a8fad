"""Flying a whole plan at once: multiple shooting, with the states at which pieces begin as unknowns.

One step of DOP853 takes all pieces from their beginnings to their ends. What an end misses the next beginning by is taken back by
Newton's method: y_k+1 = end_k, with the tangents of the ends, is a linear recursion in k. The solution is the flight
that an integration in turn finds, whatever the states it began from (Deuflhard and Bornemann, Scientific Computing with
Ordinary Differential Equations, Sec. 8.2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchbench.certificate.dop853 import Step, along, step
from benchbench.certificate.pieces import Pieces
from benchbench.ground.arrays import Array, Index

SETTLED = 1e-10
"""m, rad, m/s or rad/s: the last correction of Newton's method, whose next one would be far smaller."""
SWEEPS = 12
"""Passes over all pieces; a plan that is flown well takes 4 or 5."""
RENEWED = 0.1
"""Tangents are taken anew when a correction is not so much smaller than the one before."""
PARTS = 8
"""A piece is cut into at most so many at once, and all of them into so many times the intervals."""
NUDGE = 1e-7
"""Step of the difference quotients, relative to max(1, |y|)."""


@dataclass(frozen=True)
class Shot:
    """All pieces, flown each from where it begins."""

    pieces: Pieces
    flown: Step

    @classmethod
    def of(cls, pieces: Pieces, start: Array) -> Shot:
        """Fly; start (M, n) are the states [q, v] at the beginnings."""
        return cls(pieces, step(pieces.rate, start))

    @property
    def ends(self) -> Array:
        """States (N, n) at the ends of the intervals of the plan."""
        return self.flown.end[self.pieces.last]

    def at(self, fractions: Array) -> Array:
        """States (N, m, n) at increasing fractions (m,) in (0, 1] of each interval."""
        pieces, terms = self.pieces, self.flown.curve()
        place = (np.arange(len(pieces.seconds))[:, None] + fractions).ravel()
        piece = np.searchsorted(pieces.interval + pieces.begin, place, side="left") - 1
        x = (place - pieces.interval[piece] - pieces.begin[piece]) / pieces.length[piece]
        found = along(terms[:, piece], x)
        return found.reshape(len(pieces.seconds), len(fractions), -1)


def settled(shot: Shot, nodes: Index, tolerance: float, far: float) -> Shot | None:
    """Fly on from piece to piece, but from where they begin now at these nodes of the plan, the first among them.

    tolerance: of a step, absolute and relative, for each piece. None where that is not found: a state is further than
    `far`, or no number, steps need to be very short, or the corrections do not become small.
    """
    size, tangents = np.inf, None
    for _ in range(SWEEPS):
        if not np.max(np.abs(shot.flown.end)) < far:
            return None
        parts = _parts(shot.flown.error(tolerance))
        if np.sum(parts) > PARTS * len(shot.pieces.seconds):
            return None
        if np.max(parts) > 1:
            shot, tangents = _finer(shot, parts), None
            continue
        held = shot.pieces.starting(nodes)
        gaps = np.where(held[1:, None], 0.0, shot.flown.end[:-1] - shot.flown.start[1:])
        if not gaps.any():
            return shot
        if tangents is None:
            tangents = _tangents(shot)
        correction = _swept(gaps, tangents, held)
        before, size = size, float(np.max(np.abs(correction)))
        if size <= SETTLED:
            return shot
        tangents = tangents if size < RENEWED * before else None
        shot = Shot.of(shot.pieces, shot.flown.start + correction)
    return None


def roughly(pieces: Pieces, start: Array, nodes: Index) -> Array:
    """Where pieces begin (M, n) when they are flown in turn by one step of RK4 each, from `start` at these nodes."""
    found = start.copy()
    for k in np.flatnonzero(np.logical_not(pieces.starting(nodes))):
        rate, y = pieces.only(int(k) - 1).rate, found[k - 1 : k]
        first = rate(0.0, y)
        second = rate(0.5, y + first / 2)
        third = rate(0.5, y + second / 2)
        found[k] = (y + (first + 2 * second + 2 * third + rate(1.0, y + third)) / 6)[0]
    return found


def _parts(error: Array) -> Index:
    """Into how many parts each piece is to be cut: a step of order 8 has an error of the eighth power, a little to spare."""
    wanted = np.where(error > 1.0, np.ceil(1.1 * np.maximum(error, 1.0) ** (1 / 8)), 1.0)
    return np.minimum(wanted, PARTS).astype(np.int64)


def _finer(shot: Shot, parts: Index) -> Shot:
    pieces, piece, share = shot.pieces.split(parts)
    return Shot.of(pieces, along(shot.flown.curve()[:, piece], share))


def _tangents(shot: Shot) -> Array:
    """What the end of a piece changes by with its beginning (M, n, n): exp(J), J the derivative of its rate half way."""
    half = (shot.flown.start + shot.flown.end) / 2
    size = half.shape[-1]
    nudge = NUDGE * np.maximum(1.0, np.abs(half))
    nudged = half + np.eye(size)[:, None, :] * nudge
    rates = shot.pieces.rate(0.5, np.concatenate([half[None], nudged]))
    jacobian = ((rates[1:] - rates[0]) / nudge.T[:, :, None]).transpose(1, 2, 0)
    tangents = np.eye(size) + jacobian / 4
    for power in (3, 2, 1):
        tangents = np.eye(size) + jacobian @ tangents / power
    return tangents


def _swept(gaps: Array, tangents: Array, held: Array) -> Array:
    """Corrections (M, n) of all beginnings: none where held, else what the one before it moves the end by, and the gap."""
    found = np.zeros((len(held), gaps.shape[1]))
    for k in np.flatnonzero(np.logical_not(held)):
        found[k] = gaps[k - 1] + tangents[k - 1] @ found[k - 1]
    return found
