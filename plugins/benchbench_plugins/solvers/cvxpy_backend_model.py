"""What sequential convex programming asks of a program at a point: values, slopes and a convex curvature."""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy import sparse

from benchbench.ground.arrays import Array, Index
from benchbench.mpcc.derivatives import Compile, Derivatives, derivatives
from benchbench.mpcc.problem import Block, Mpcc, gather
from benchbench.nlp.program import Program, assemble


@dataclass(frozen=True)
class LocalProgram:
    """A program at a point x: f, df/dx (n,), scaled rows g (m,) and dg/dx (m, n); violation (m,) is unscaled."""

    f: float
    gradient: Array
    g: Array
    jacobian: sparse.csr_array
    violation: Array

    @property
    def finite(self) -> bool:
        """Whether every number is finite."""
        numbers = (self.f, self.gradient, self.g, self.jacobian.data)
        return all(bool(np.all(np.isfinite(part))) for part in numbers)


class LocalModel:
    """An assembled program; rows are scaled once, at the first point.

    A row is divided by its largest slope and curvature there, if that is above 1. The curvature matters: at
    rest the row (relative speed / limit)^2 - 1 <= 0 has no slope at all, and unscaled its l1 penalty would
    answer a step of 1 m/s with 10^4.
    """

    def __init__(self, mpcc: Mpcc, compile: Compile, seconds: float = math.inf) -> None:
        self.program: Program = assemble(mpcc, compile, seconds=seconds)
        self.costs = [b for b in mpcc.costs if b.instances]
        self.rows = [b for b in mpcc.constraints if b.instances]
        blocks = [*self.costs, *self.rows]
        self.n, self.m = mpcc.size, len(self.program.lower_g)
        self.jacobian_pattern = _pattern(self.program.jacobian, 1)
        self.scale: Array = np.ones(self.m)
        self.evaluations = 0
        local = derivatives([b.function for b in blocks], compile, seconds=seconds / 2)
        self.curves = [
            _BlockCurvature(b, d, gather(b, mpcc.offsets)) for b, d in zip(blocks, local, strict=True)
        ]
        keys = [curve.i * self.n + curve.j for curve in self.curves]
        unique, inverse = np.unique(
            np.concatenate([np.zeros(0, np.int64), *(k.ravel() for k in keys)]), return_inverse=True
        )
        self.curvature_pattern: tuple[Index, Index] = (unique // self.n, unique % self.n)
        ends = np.cumsum([k.size for k in keys])[:-1]
        self.places = np.split(inverse, ends) if keys else []

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Scaled bounds of the rows."""
        return self.scale * self.program.lower_g, self.scale * self.program.upper_g

    def outside(self, g: Array) -> Array:
        """Violation of the scaled rows g, (m,)."""
        low, high = self.bounds
        return np.maximum(np.maximum(low - g, g - high), 0.0)

    def at(self, x: Array, sigma: float) -> LocalProgram:
        """Evaluate at x."""
        self.evaluations += 2
        f, gradient = self.program.gradient(x, sigma)
        values, jacobian = self.program.jacobian(x, sigma)
        rows, columns = self.jacobian_pattern
        g = np.asarray(values).ravel()
        slopes = np.array(jacobian.nonzeros()) * self.scale[rows]
        matrix = sparse.csr_array((slopes, (rows, columns)), shape=(self.m, self.n))
        violation = np.maximum(np.maximum(self.program.lower_g - g, g - self.program.upper_g), 0.0)
        return LocalProgram(float(f), np.asarray(gradient).ravel(), self.scale * g, matrix, violation)

    def begin(self, x: Array, sigma: float) -> None:
        """Choose the row scales at the first point x and count evaluations from now on."""
        self.evaluations, self.scale = 0, np.ones(self.m)
        slopes = abs(self.at(x, sigma).jacobian).max(axis=1).toarray().ravel() if self.m else np.zeros(0)
        bends = [curve.largest(x, sigma).ravel() for curve in self.curves[len(self.costs) :]]
        worst = np.maximum(slopes, np.concatenate([np.zeros(0), *bends]))
        self.scale = 1 / np.maximum(1.0, np.where(np.isfinite(worst), worst, 1.0))

    def curvature(self, x: Array, sigma: float, lam: Array) -> Array:
        """Entries at `curvature_pattern` of a positive semidefinite stand-in for the Lagrangian's Hessian.

        Each instance of each block has its own small Hessian, whose negative eigenvalues are set to zero.
        lam (m,) are multipliers of the scaled rows.
        """
        self.evaluations += 1
        total = np.zeros(len(self.curvature_pattern[0]))
        sizes = [0] * len(self.costs) + [b.lower.size for b in self.rows]
        ends = np.cumsum(sizes)[:-1]
        weights = np.split(lam * self.scale, ends) if sizes else []
        for curve, place, weight in zip(self.curves, self.places, weights, strict=True):
            if curve.used.size:
                total += np.bincount(place, curve.convex(x, sigma, weight).ravel(), len(total))
        return total


class _BlockCurvature:
    """Second derivatives of one block on all its instances, on the local unknowns that have any."""

    def __init__(self, block: Block, local: Derivatives, index: Index) -> None:
        self.instances, self.outputs = block.instances, block.function.size1_out(0)
        self.used = np.unique(np.concatenate([local.hessian_rows, local.hessian_columns]))
        self.a, self.b = (np.searchsorted(self.used, k) for k in (local.hessian_rows, local.hessian_columns))
        self.function = local.hessian.map(block.instances)
        self.index, self.parameters = index, block.parameters
        mine = index[:, self.used]
        shape = (self.instances, self.used.size, self.used.size)
        self.i, self.j = np.broadcast_to(mine[:, :, None], shape), np.broadcast_to(mine[:, None, :], shape)

    def convex(self, x: Array, sigma: float, weight: Array) -> Array:
        """Hessians of weight . out with their negative eigenvalues cut off, (instances, used, used)."""
        lam = (
            weight.reshape(self.instances, self.outputs)
            if weight.size
            else np.ones((self.instances, self.outputs))
        )
        entries = self._entries(x, sigma, lam)
        matrix = np.zeros(self.i.shape)
        matrix[:, self.a, self.b] = entries
        matrix[:, self.b, self.a] = entries
        if not np.all(np.isfinite(matrix)):
            return np.zeros(self.i.shape)
        values, vectors = np.linalg.eigh(matrix)
        return np.asarray((vectors * np.maximum(values, 0.0)[:, None, :]) @ vectors.transpose(0, 2, 1))

    def largest(self, x: Array, sigma: float) -> Array:
        """Largest absolute second derivative of each output, (instances, outputs)."""
        if not self.used.size:
            return np.zeros((self.instances, self.outputs))
        units = [np.tile(unit, (self.instances, 1)) for unit in np.eye(self.outputs)]
        return np.stack([np.abs(self._entries(x, sigma, unit)).max(axis=1) for unit in units], axis=1)

    def _entries(self, x: Array, sigma: float, lam: Array) -> Array:
        sigmas = np.full((1, self.instances), sigma)
        return np.asarray(self.function(x[self.index].T, self.parameters.T, sigmas, lam.T)).T


def _pattern(function: ca.Function, output: int) -> tuple[Index, Index]:
    rows, columns = function.sparsity_out(output).get_triplet()
    return np.array(rows, np.int64), np.array(columns, np.int64)
