"""From blocks to one sparse program: f, g and their derivatives as CasADi functions of the stacked unknowns."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array, Index
from benchbench.mpcc.derivatives import Compile, Derivatives, derivatives
from benchbench.mpcc.problem import Block, Mpcc, gather
from benchbench.mpcc.spending import note, spending

DERIVATIVES = "derivatives"
"""What the CPU time of taking and compiling derivatives is noted as."""
INTERPRETED = "interpreted"
"""What the number of blocks that could not be compiled is noted as."""


@dataclass(frozen=True)
class Program:
    """A smooth program min f(x, p) s.t. lower_x <= x <= upper_x, lower_g <= g(x, p) <= upper_g.

    gradient (x, p) -> (f, dense df/dx); jacobian (x, p) -> (g, sparse dg/dx);
    hessian (x, p, lam_f, lam_g) -> upper triangle.
    p (1 + n_p,) is sigma, then the parameters of the `adjustable` blocks (see `numbers`): targets can move
    without a new program.
    """

    x: ca.MX
    p: ca.MX
    f: ca.MX
    g: ca.MX
    gradient: ca.Function
    jacobian: ca.Function
    hessian: ca.Function
    lower_x: Array
    upper_x: Array
    lower_g: Array
    upper_g: Array
    guess: Array
    compiled: bool
    adjustable: frozenset[str] = frozenset()

    def moved(self, mpcc: Mpcc) -> Program:
        """The same program with the bounds and guesses of another MPCC of the same structure."""
        lower_g, upper_g = _row_bounds(mpcc)
        return replace(
            self, lower_x=mpcc.lower, upper_x=mpcc.upper, lower_g=lower_g, upper_g=upper_g, guess=mpcc.guess
        )

    def numbers(self, mpcc: Mpcc, sigma: float) -> Array:
        """Return p (1 + n_p,) for an MPCC of the same structure."""
        return np.concatenate([[sigma], *(b.parameters.ravel() for b in _open(mpcc, self.adjustable))])


def assemble(
    mpcc: Mpcc, compile: Compile = "auto", adjustable: Collection[str] = (), seconds: float = math.inf
) -> Program:
    """Stack the variables, costs and constraints of an MPCC without pairs (a relaxed one).

    The parameters of blocks named in `adjustable` become parameters of the program; all others are constants.
    Half of the CPU `seconds` may go to compilers; blocks that take longer stay interpreted, and are counted.
    """
    if mpcc.pairs:
        raise ValueError("pairs must be relaxed before assembly")
    blocks = _blocks(mpcc)
    costs = sum(1 for b in mpcc.costs if b.instances)
    with spending(DERIVATIVES):
        local = derivatives([b.function for b in blocks], compile, [b.instances for b in blocks], seconds / 2)
    note(INTERPRETED, sum(not d.compiled for d in local) if compile != "never" else 0)
    free = _open(mpcc, adjustable)
    x, p = ca.MX.sym("x", mpcc.size), ca.MX.sym("p", 1 + sum(b.parameters.size for b in free))
    sigma, *open_numbers = ca.vertsplit(p, np.cumsum([0, 1, *(b.parameters.size for b in free)]).tolist())
    given = iter(open_numbers)
    numbers = [
        ca.reshape(next(given), *b.parameters.T.shape) if b.name in adjustable else ca.DM(b.parameters.T)
        for b in blocks
    ]
    lam_f = ca.MX.sym("lam_f")
    sizes = [b.instances * b.function.size1_out(0) for b in blocks[costs:]]
    lam_g = ca.MX.sym("lam_g", sum(sizes))
    firsts = [0] * costs + [int(s) for s in np.cumsum([0, *sizes])]
    parts = [
        _Part(block, d, gather(block, mpcc.offsets), first, x, own, sigma)
        for block, d, first, own in zip(blocks, local, firsts, numbers, strict=False)
    ]
    f = ca.densify(sum((ca.sum1(part.values()) for part in parts[:costs]), ca.MX(0)))
    g = ca.vertcat(ca.MX(0, 1), *(part.values() for part in parts[costs:]))
    n, m = mpcc.size, sum(sizes)
    gradient = ca.densify(_scatter([part.jacobian(0) for part in parts[:costs]], (1, n)).T)
    jacobian = _scatter([part.jacobian() for part in parts[costs:]], (m, n))
    weights = [lam_f] * costs + list(ca.vertsplit(lam_g, firsts[costs:]) if sizes else [])
    hessian = _scatter([part.hessian(w) for part, w in zip(parts, weights, strict=True)], (n, n))
    lower_g, upper_g = _row_bounds(mpcc)
    return Program(
        x=x, p=p, f=f, g=g,
        gradient=ca.Function("nlp_grad_f", [x, p], [f, gradient], ["x", "p"], ["f", "grad_f_x"]),
        jacobian=ca.Function("nlp_jac_g", [x, p], [g, jacobian], ["x", "p"], ["g", "jac_g_x"]),
        hessian=ca.Function("nlp_hess_l", [x, p, lam_f, lam_g], [hessian], ["x", "p", "lam_f", "lam_g"],
                            ["triu_hess_gamma_x_x"]),
        lower_x=mpcc.lower, upper_x=mpcc.upper, lower_g=lower_g, upper_g=upper_g, guess=mpcc.guess,
        compiled=all(d.compiled for d in local), adjustable=frozenset(adjustable),
    )  # fmt: skip


def _blocks(mpcc: Mpcc) -> list[Block]:
    return [b for b in (*mpcc.costs, *mpcc.constraints) if b.instances]


def _open(mpcc: Mpcc, adjustable: Collection[str]) -> list[Block]:
    return [b for b in _blocks(mpcc) if b.name in adjustable]


def _row_bounds(mpcc: Mpcc) -> tuple[Array, Array]:
    rows = [b for b in mpcc.constraints if b.instances]
    lower, upper = ([getattr(b, k).ravel() for b in rows] for k in ("lower", "upper"))
    return np.concatenate([np.zeros(0), *lower]), np.concatenate([np.zeros(0), *upper])


@dataclass(frozen=True)
class _Entries:
    """Values (k,) to be added into a matrix at rows, columns (k,), each times a weight (k,)."""

    values: ca.MX
    rows: Index
    columns: Index
    weights: Array


@dataclass(frozen=True)
class _Part:
    """One block inside the program: its own derivatives mapped over its instances."""

    block: Block
    local: Derivatives
    index: Index
    first_row: int
    x: ca.MX
    numbers: ca.MX | ca.DM
    sigma: ca.MX

    def values(self) -> ca.MX:
        """All outputs, instance by instance."""
        return ca.vec(self._map(self.local.value))

    def jacobian(self, row: int | None = None) -> _Entries:
        """Entries of dg/dx; with `row` given every output belongs to that row (a sum)."""
        outputs = self.block.function.size1_out(0)
        instance = np.arange(self.block.instances)[:, None]
        rows = self.first_row + instance * outputs + self.local.rows
        if row is not None:
            rows = np.full_like(rows, row)
        columns = self.index[:, self.local.columns]
        return _Entries(
            ca.vec(self._map(self.local.jacobian)), rows.ravel(), columns.ravel(), np.ones(rows.size)
        )

    def hessian(self, weight: ca.MX) -> _Entries:
        """Entries of the upper triangle of the Hessian of weight . out."""
        outputs = self.block.function.size1_out(0)
        shape = (outputs, self.block.instances)
        own = weight.numel() == outputs * self.block.instances
        lam = ca.reshape(weight, *shape) if own else ca.repmat(weight, *shape)
        i, j = (
            self.index[:, self.local.hessian_rows].ravel(),
            self.index[:, self.local.hessian_columns].ravel(),
        )
        local_i, local_j = np.broadcast_arrays(
            np.tile(self.local.hessian_rows, self.block.instances),
            np.tile(self.local.hessian_columns, self.block.instances),
        )
        twice = np.where((i == j) & (local_i != local_j), 2.0, 1.0)  # one unknown read twice by an instance
        values = ca.vec(self._map(self.local.hessian, lam))
        return _Entries(values, np.minimum(i, j), np.maximum(i, j), twice)

    def _map(self, function: ca.Function, *more: ca.MX) -> ca.MX:
        n = self.block.instances
        z = ca.reshape(self.x[self.index.ravel().tolist()], self.index.shape[1], n)
        mapped = function.map(f"{function.name()}_{n}", "serial", n, [2], [])
        return mapped(z, self.numbers, self.sigma, *more)


def _scatter(entries: Sequence[_Entries], shape: tuple[int, int]) -> ca.MX:
    """Add all entries into one sparse matrix by a constant 0/1 matrix on the stacked values."""
    if not any(e.rows.size for e in entries):
        return ca.MX(*shape)
    values = ca.vertcat(*(e.values for e in entries))
    rows, columns = (np.concatenate([getattr(e, k) for e in entries]) for k in ("rows", "columns"))
    place, inverse = np.unique(columns * shape[0] + rows, return_inverse=True)
    weights = np.concatenate([e.weights for e in entries])
    sparsity = ca.Sparsity.triplet(*shape, (place % shape[0]).tolist(), (place // shape[0]).tolist())
    if len(place) == len(rows) and np.all(weights == 1.0):
        order = np.argsort(inverse)
        return ca.MX(sparsity, values[order.tolist()])
    pattern = ca.Sparsity.triplet(len(place), len(rows), inverse.tolist(), list(range(len(rows))))
    return ca.MX(sparsity, ca.DM(pattern, weights.tolist()) @ values)
