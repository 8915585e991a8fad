"""The intervals of a plan, or parts of them, as states that are flown at once."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from benchbench.ground.arrays import Array, Index
from benchbench.ocp.model import Plant
from benchbench.ocp.plan import Plan, bezier


def slope(plant: Plant, half: int, state: Array, inputs: Array) -> Array:
    """d[q, v]/dt (..., n) for states [q, v] (..., n), of which q takes `half`, and inputs (..., n_u)."""
    q, v = state[..., :half], state[..., half:]
    out = np.empty_like(state)
    out[..., :half] = plant.kinematics(q, v)
    out[..., half:] = plant.acceleration(q, v, inputs)
    return out


@dataclass(frozen=True)
class Pieces:
    """M pieces in order of time; together they are the N intervals of a plan.

    half: size of q in a state [q, v]; seconds (N,) and points (N, d, n_u): length and control points of the
    input of each interval; interval (M,): the one that a piece is part of; begin, length (M,): fractions of it.
    """

    plant: Plant
    half: int
    seconds: Array
    points: Array
    interval: Index
    begin: Array
    length: Array

    @classmethod
    def of(cls, plan: Plan, plant: Plant) -> Pieces:
        """Whole intervals."""
        whole = np.arange(plan.intervals, dtype=np.int64)
        fractions = np.zeros(plan.intervals), np.ones(plan.intervals)
        half = plan.configuration.shape[1]
        return cls(plant, half, np.diff(plan.time), plan.input_pieces, whole, *fractions)

    def rate(self, x: float, state: Array) -> Array:
        """dy/dx (..., M, n) at a fraction x in [0, 1] of each piece, for states (..., M, n)."""
        inputs = bezier(self.points[self.interval], self.begin + x * self.length)
        inputs = np.broadcast_to(inputs, (*state.shape[:-1], inputs.shape[-1]))
        duration = self.seconds[self.interval] * self.length
        return duration[:, None] * slope(self.plant, self.half, state, inputs)

    def only(self, piece: int) -> Pieces:
        """One of them."""
        one = slice(piece, piece + 1)
        return replace(self, interval=self.interval[one], begin=self.begin[one], length=self.length[one])

    def split(self, parts: Index) -> tuple[Pieces, Index, Array]:
        """Cut piece i into parts[i] equal ones: those, (m,) the piece that each was, and (m,) the fraction where it begins."""
        piece = np.repeat(np.arange(len(parts)), parts)
        share = (np.arange(len(piece)) - np.repeat(np.cumsum(parts) - parts, parts)) / parts[piece]
        begin = self.begin[piece] + share * self.length[piece]
        finer = replace(self, interval=self.interval[piece], begin=begin, length=(self.length / parts)[piece])
        return finer, piece, share

    def starting(self, nodes: Index) -> Array:
        """Whether a piece begins at one of these nodes of the plan, (M,) bool."""
        return np.asarray((self.begin == 0.0) & np.isin(self.interval, nodes))

    @property
    def last(self) -> Index:
        """The last piece of each interval, (N,)."""
        return np.searchsorted(self.interval, np.arange(len(self.seconds)), side="right") - 1
