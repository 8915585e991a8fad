"""The rows of a transcription as numbers, at many points: its equations with their derivatives, and its limits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np
from scipy.sparse import csc_array

from benchbench.ground.arrays import Array, Flags, Index
from benchbench.mpcc.problem import Block, Mpcc, gather

NUDGE = 1e-7
"""Step of the difference quotients, relative to max(1, |z|)."""


@dataclass(frozen=True)
class Equations:
    """Rows of an MPCC that are asked to have one value, with derivatives by difference quotients.

    Newton's steps that are a little wrong end at the same solution, and nothing is differentiated for so few of them.
    """

    mpcc: Mpcc

    def __len__(self) -> int:
        """How many there are."""
        return sum(int(np.sum(part.equal)) for part in self._parts)

    def at(self, x: Array) -> tuple[Array, csc_array]:
        """Return what they miss their values by (m,), and its derivatives (m, n), at x (n,)."""
        residual, rows, columns, values, count = [np.zeros(0)], [], [], [], 0
        for part in self._parts:
            missed, slopes = part.at(x)
            row, read = np.nonzero(part.equal)[0], int(np.sum(part.equal))
            residual.append(missed)
            rows.append(np.repeat(np.arange(count, count + read), slopes.shape[1]))
            columns.append(part.index[row].ravel())
            values.append(slopes.ravel())
            count += read
        places = (np.concatenate(rows), np.concatenate(columns))
        return np.concatenate(residual), csc_array(
            (np.concatenate(values), places), shape=(count, self.mpcc.size)
        )

    @cached_property
    def _parts(self) -> list[_Part]:
        return list(_parts(self.mpcc))


@dataclass(frozen=True)
class _Part:
    """A block with equations: where its instances read, which of its outputs are equations, and the block mapped over all nudges."""

    block: Block
    index: Index
    equal: Flags
    mapped: ca.Function

    def at(self, x: Array) -> tuple[Array, Array]:
        """What the equations miss (m,), and its derivatives by what their instances read (m, n_z)."""
        read = x[self.index]
        nudge = NUDGE * np.maximum(1.0, np.abs(read))
        width = read.shape[1]
        nudged = np.concatenate([read[None], read + np.eye(width)[:, None, :] * nudge])
        numbers = np.tile(self.block.parameters, (width + 1, 1)).T
        out = np.asarray(ca.densify(self.mapped(nudged.reshape(-1, width).T, numbers, 0.0))).T
        out = out.reshape(width + 1, *self.equal.shape)
        slopes = np.moveaxis((out[1:] - out[0]) / nudge.T[:, :, None], 0, -1)
        return (out[0] - self.block.lower)[self.equal], slopes[self.equal]


def _parts(mpcc: Mpcc) -> Iterator[_Part]:
    for block in mpcc.constraints:
        equal = block.lower == block.upper
        if np.any(equal):
            index = gather(block, mpcc.offsets)
            yield _Part(block, index, equal, block.function.map(block.instances * (index.shape[1] + 1)))


@dataclass(frozen=True)
class Limits:
    """Bounds of an MPCC's unknowns, and its rows that are no equations."""

    mpcc: Mpcc

    def violation(self, x: Array) -> float:
        """Return the largest violation at x (n,), 0 where there is none."""
        worst = max(0.0, float(np.max(np.maximum(self._bounds[0] - x, x - self._bounds[1]))))
        for block, index, unequal, mapped in self._rows:
            out = np.asarray(ca.densify(mapped(x[index].T, block.parameters.T, 0.0))).T
            over = np.maximum(block.lower - out, out - block.upper)[unequal]
            worst = max(worst, float(np.max(over)))
        return worst

    @cached_property
    def _bounds(self) -> tuple[Array, Array]:
        return self.mpcc.lower, self.mpcc.upper

    @cached_property
    def _rows(self) -> list[tuple[Block, Index, Flags, ca.Function]]:
        unequal = [(block, block.lower < block.upper) for block in self.mpcc.constraints]
        return [
            (block, gather(block, self.mpcc.offsets), rows, block.function.map(block.instances))
            for block, rows in unequal if np.any(rows)
        ]  # fmt: skip
