"""Where a target heads in cells of time, and by how much a nose must turn for it at least."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from benchbench.ground.arrays import Array, Flags, Index
from benchbench.ocp.contact import SLOW

SHARP = 0.5
"""rad of turn of the target within a cell from which its direction is taken as any."""
NEAR = 3
"""Cells to either side of one in which an instant that is counted to it may lie."""


@dataclass(frozen=True, eq=False)
class Course:
    """Direction of the target in each cell, (n,) each.

    way    rad, without jumps of 2 pi
    spare  rad by which a nose that is right may be off it anywhere near the cell
    free   near the cell the target may be so slow, or turn so sharply, that no direction is asked
    """

    way: Array
    spare: Array
    free: Flags

    @classmethod
    def of(cls, moving: Array, error: float) -> Self:
        """Read it from the target's velocities (n, 3) m/s at the beginnings of the cells; error: of the nose, rad."""
        speed, way = np.linalg.norm(moving[:, :2], axis=1), np.arctan2(moving[:, 1], moving[:, 0])
        jump = np.abs(_short(np.diff(way, append=way[-1])))
        free = _around((speed <= 2 * SLOW) | (jump > SHARP)) > 0
        return cls(np.unwrap(way), error + NEAR * _around(jump), free)

    def off(self, heading: float | None) -> Array:
        """How far the nose has to turn from a heading to be right, signed, (n,) rad, at least; None: it may be any."""
        if heading is None:
            return np.zeros(len(self.way))
        off = _short(self.way - heading)
        return np.where(self.free, 0.0, np.sign(off) * np.maximum(np.abs(off) - self.spare, 0.0))

    def followed(self, begin: Index, end: Index, turned: float) -> Flags:
        """Whether a nose that turns by so many rad, at most, may be right from one cell to another."""
        frees = np.concatenate([[0], np.cumsum(self.free)])
        free = frees[np.minimum(end + 1, len(self.free))] > frees[begin]
        turn = np.abs(self.way[end] - self.way[begin])
        return np.asarray(free | (turn <= self.spare[begin] + self.spare[end] + turned))


def _around(values: Array | Flags) -> Array:
    """The largest of the cells near each."""
    padded = np.pad(np.asarray(values, float), NEAR, mode="edge")
    return np.asarray(np.max(np.lib.stride_tricks.sliding_window_view(padded, 2 * NEAR + 1), axis=1))


def _short(angle: Array) -> Array:
    """The same angle from -pi to pi."""
    return np.asarray((angle + np.pi) % (2 * np.pi) - np.pi)
