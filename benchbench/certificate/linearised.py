"""An MPCC linearised at a point: which constraints are active there, and their gradients."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from scipy.sparse import csc_array, csr_array, eye_array, vstack
from scipy.sparse.linalg import splu

from benchbench.ground.arrays import Array, Flags, Index
from benchbench.mpcc.problem import Mpcc
from benchbench.nlp.program import Program, assemble

LARGEST_RANK = 2000
"""Active constraints beyond which their rank is not computed (a dense matrix, seconds)."""
SAME = 9
"""Decimals to which two gradients of length one must agree to be the same."""
NEWTON_STEPS = 4


@dataclass(frozen=True)
class Active:
    """What is active, among all that an MPCC bounds.

    floor, roof  (r,) the value may not fall, may not rise; both: an equation
    both         (p,) pairs with G = H = 0, whose floor and roof are not set
    pairs        (r,) G or H of a pair, and zero
    """

    floor: Flags
    roof: Flags
    both: Flags
    pairs: Flags

    @property
    def rows(self) -> Flags:
        """All that is active, (r,)."""
        return self.floor | self.roof | self.pairs


@dataclass(frozen=True)
class Tangent:
    """First-order data of what is active at a point; row i is the gradient a_i, scaled to length one.

    gradient     (n,) of the cost
    rows         (m, n) gradients
    floor, roof  (m,) a direction d must keep a_i d >= 0, a_i d <= 0; both: a_i d = 0
    biactive     (k, 2) rows of G and H where both are zero; their floor and roof are not set
    vanishing    (k,) whether that pair is a vanishing one
    affine       no active constraint is curved
    """

    gradient: Array
    rows: csr_array
    floor: Flags
    roof: Flags
    biactive: Index
    vanishing: Flags
    affine: bool

    @property
    def independent(self) -> bool | None:
        """Whether the gradients are linearly independent (MPCC-LICQ); None: too many to tell."""
        m, n = self.rows.shape
        if m == 0 or m > n:
            return m == 0
        return None if m > LARGEST_RANK else int(np.linalg.matrix_rank(self.rows.toarray(), 1e-9)) == m


class Linearised:
    """Everything an MPCC bounds, r numbers: the unknowns, the constraints, then G and H of each pair."""

    def __init__(self, mpcc: Mpcc) -> None:
        blocks = (*mpcc.constraints, *(pair.block for pair in mpcc.pairs))
        self.program: Program = assemble(replace(mpcc, constraints=blocks, pairs=()), "never")
        rows = sum(b.lower.size for b in mpcc.constraints)
        self.g, self.h, self.vanishing = _places(mpcc, mpcc.size + rows)
        free = np.full(2 * len(self.g), np.inf)
        self.lower = np.concatenate([mpcc.lower, *(b.lower.ravel() for b in mpcc.constraints), -free])
        self.upper = np.concatenate([mpcc.upper, *(b.upper.ravel() for b in mpcc.constraints), free])
        curved = [np.tile(_curved(b.function), b.instances) for b in blocks]
        self.curved = np.concatenate([np.zeros(mpcc.size, bool), *curved])

    def values(self, x: Array) -> Array:
        """All r numbers at x (n,)."""
        return np.concatenate([x, np.asarray(self.program.jacobian(x, 0.0)[0]).ravel()])

    def gradients(self, x: Array) -> csr_array:
        """Their gradients, (r, n)."""
        jacobian = csr_array(ca.DM(self.program.jacobian(x, 0.0)[1]).tocsc())
        return csr_array(vstack([eye_array(x.size, format="csr"), jacobian], format="csr"))

    def active(self, x: Array, tolerance: float) -> Active:
        """Return what is active when all within `tolerance` (relative above 1) counts as zero."""
        values = self.values(x)
        floor = _near(values - self.lower, self.lower, tolerance)
        roof = _near(self.upper - values, self.upper, tolerance)
        zero_g = values[self.g] <= tolerance
        zero_h = (values[self.h] <= tolerance) & (~self.vanishing | (values[self.h] >= -tolerance))
        both = zero_g & zero_h
        only_g, only_h = zero_g & ~both, zero_h & ~both
        floor[self.g[only_g]] = True
        roof[self.g[only_g & (values[self.h] > 0)]] = True  # vanishing, H < 0: only G >= 0
        floor[self.h[only_h & ~self.vanishing]] = True
        roof[self.h[only_h]] = True
        pairs = np.zeros(len(floor), bool)
        pairs[self.g[zero_g]] = pairs[self.h[zero_h]] = True
        return Active(floor, roof, both, pairs)

    def snapped(self, x: Array, active: Active) -> Array:
        """The point (n,) near x (n,) where all that is active is exactly so: least-norm Newton steps; x if they fail."""
        which = np.flatnonzero(active.rows)
        with np.errstate(invalid="ignore"):
            aim = np.where(active.floor & np.isfinite(self.lower), self.lower, self.upper)
        aim = np.where(np.isfinite(aim), aim, 0.0)[which]
        moved, first = x, np.inf
        for _ in range(NEWTON_STEPS):
            gap = aim - self.values(moved)[which]
            first = min(first, float(np.max(np.abs(gap), initial=0.0)))
            rows = self.gradients(moved)[which]
            square = csc_array(rows @ rows.T + 1e-10 * eye_array(len(which)))
            moved = moved + rows.T @ splu(square).solve(gap)
        left = float(np.max(np.abs(aim - self.values(moved)[which]), initial=0.0))
        return moved if left <= first else x

    def tangent(self, x: Array, active: Active) -> Tangent:
        """Return the gradients at x of what is active; a bound or row that repeats a pair's sign counts once."""
        rows = self.gradients(x)
        length = np.sqrt(np.asarray(rows.multiply(rows).sum(axis=1)).ravel())
        rows = csr_array(rows.multiply(1.0 / np.where(length > 0, length, 1.0)[:, None]))
        kept = active.rows & ~_repeats(rows, active)
        place = np.cumsum(kept) - 1
        biactive = np.stack([place[self.g[active.both]], place[self.h[active.both]]], axis=1)
        return Tangent(
            np.asarray(self.program.gradient(x, 0.0)[1]).ravel(), csr_array(rows[np.flatnonzero(kept)]),
            active.floor[kept], active.roof[kept], biactive, self.vanishing[active.both],
            not np.any(self.curved & kept),
        )  # fmt: skip


def _near(slack: Array, bound: Array, tolerance: float) -> Flags:
    with np.errstate(invalid="ignore"):
        return np.isfinite(bound) & (slack <= tolerance * np.maximum(1.0, np.abs(bound)))


def _repeats(rows: csr_array, active: Active) -> Flags:
    """Inequalities that say what the sign of an active pair says already."""

    def key(i: np.intp, sign: float) -> tuple[bytes, bytes]:
        first, last = rows.indptr[i : i + 2]
        order = np.argsort(rows.indices[first:last])
        numbers = np.round(sign * rows.data[first:last][order], SAME) + 0.0  # no -0.0
        return rows.indices[first:last][order].tobytes(), numbers.tobytes()

    own = {key(i, 1.0) for i in np.flatnonzero(active.pairs)}
    repeats = np.zeros(len(active.pairs), bool)
    for i in np.flatnonzero((active.floor != active.roof) & ~active.pairs):
        repeats[i] = key(i, 1.0 if active.floor[i] else -1.0) in own
    return repeats


def _places(mpcc: Mpcc, first: int) -> tuple[Index, Index, Flags]:
    """Places of G and H of each scalar pair from `first` on, and whether it is vanishing."""
    g, h, vanishing = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)], [np.zeros(0, bool)]
    for pair in mpcc.pairs:
        width = pair.block.function.size1_out(0)
        places = first + np.arange(pair.block.instances * width).reshape(-1, 2, width // 2)
        g.append(places[:, 0].ravel())
        h.append(places[:, 1].ravel())
        vanishing.append(np.full(pair.count, pair.kind == "vanishing"))
        first += places.size
    return np.concatenate(g), np.concatenate(h), np.concatenate(vanishing)


def _curved(function: ca.Function) -> Flags:
    """Whether each output of a block function is not affine in its unknowns."""
    z, p, sigma = function.sx_in()
    return np.array(ca.which_depends(function(z, p, sigma), z, 2, True), bool)
