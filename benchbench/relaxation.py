"""Interface of a relaxation, and what turns an MPCC into a smooth program with a parameter sigma."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace

import casadi as ca
import numpy as np

from benchbench.mpcc import Block, Mpcc, Pair, PairKind, Slot, Variable, evaluate
from benchbench.plan import Array


@dataclass(frozen=True)
class Unknown:
    """A new scalar unknown per instance, brought in by a relaxation; `guess` is an expression of g, h."""

    symbol: ca.SX
    lower: float
    upper: float
    guess: ca.SX


@dataclass(frozen=True)
class Relaxed:
    """What became of one scalar pair: rows with bounds, a cost term, new unknowns.

    `signs`: the rows do not imply G >= 0 (and H >= 0 for a complementarity pair); the framework adds them
    where they are not a bound or a constraint of the problem already.
    """

    rows: ca.SX
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    cost: ca.SX = field(default_factory=lambda: ca.SX(0))
    unknowns: tuple[Unknown, ...] = ()
    signs: bool = True


class Relaxation(ABC):
    """Replaces one scalar pair by something smooth; the framework does it for all pairs and drives sigma.

    `schedule` are the values of sigma to solve for, one after the other; what sigma means is the
    plugin's own business. `kinds` are the kinds of pairs it takes; a relaxation without "vanishing" gets
    such a pair with a slack s >= H as the complementarity pair 0 <= G, s >= 0, G s = 0.
    """

    schedule: tuple[float, ...]
    kinds: tuple[PairKind, ...] = ("complementarity",)

    @abstractmethod
    def relax(
        self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, name: str, limit: float | None
    ) -> Relaxed:
        """Return rows for the scalar pair (g, h); `name` and `limit` are those of the pair (see `Pair`)."""


def relax(mpcc: Mpcc, relaxation: Relaxation) -> Mpcc:
    """Return the relaxed problem: pairs became constraints, costs and unknowns; guesses are carried over."""
    result = replace(mpcc, pairs=())
    for pair in mpcc.pairs:
        result += _relax_pair(pair, relaxation, _pair_values(pair, mpcc))
    return result


def _pair_values(pair: Pair, mpcc: Mpcc) -> Array:
    return evaluate(pair.block, mpcc, mpcc.guess)


def _relax_pair(pair: Pair, relaxation: Relaxation, start: Array) -> Mpcc:
    block, inner = pair.block, pair.block.function
    count = inner.size1_out(0) // 2
    z, p, sigma = ca.SX.sym("z", inner.size1_in(0)), ca.SX.sym("p", inner.size1_in(1)), ca.SX.sym("sigma")
    g, h = ca.SX.sym("g", count), ca.SX.sym("h", count)
    limits = pair.limit or (None,) * count
    parts = [_relax_scalar(pair, relaxation, g[i], h[i], sigma, limits[i]) for i in range(count)]
    unknowns = [u for part in parts for u in part.unknowns]
    new = ca.vertcat(ca.SX(0, 1), *(u.symbol for u in unknowns))
    inside = ca.Function("inside", [g, h, new, sigma], [
        ca.vertcat(*(part.rows for part in parts)), sum((part.cost for part in parts), ca.SX(0)),
    ])  # fmt: skip
    gh = inner(z, p, sigma)
    out, cost = inside(gh[:count], gh[count:], new, sigma)
    m = block.instances
    variables: tuple[Variable, ...] = ()
    slots = block.slots
    if unknowns:
        first = ca.Function("first", [g, h], [ca.vertcat(*(u.guess for u in unknowns))])
        guess = np.asarray(first.map(m)(start[:, :count].T, start[:, count:].T)).T
        low, high = (np.tile([getattr(u, k) for u in unknowns], (m, 1)) for k in ("lower", "upper"))
        name = f"{block.name}_slack"
        variables = (Variable(name, low, high, np.clip(guess, low, high)),)
        slots += (Slot(name, np.arange(m * len(unknowns)).reshape(m, -1)),)
    arguments = [ca.vertcat(z, new), p, sigma]
    low, high = (np.tile([b for part in parts for b in getattr(part, k)], (m, 1)) for k in ("lower", "upper"))
    rows = Block(
        block.name, ca.Function(f"{block.name}_relaxed", arguments, [out]), slots, block.parameters,
        low.astype(float), high.astype(float), block.unit,
    )  # fmt: skip
    costs: tuple[Block, ...] = ()
    if not cost.is_zero():
        penalty = ca.Function(f"{block.name}_penalty", arguments, [cost])
        costs = (Block(f"{block.name}_penalty", penalty, slots, block.parameters, low[:, :1], low[:, :1]),)
    return Mpcc(variables, (rows,) if out.shape[0] else (), costs)


def _relax_scalar(
    pair: Pair, relaxation: Relaxation, g: ca.SX, h: ca.SX, sigma: ca.SX, limit: float | None
) -> Relaxed:
    name = pair.block.name
    if pair.kind in relaxation.kinds:
        inner = relaxation.relax(g, h, sigma, pair.kind, name, limit)
        signs = [] if pair.sign_known else [g]
        signs += [h] if pair.kind == "complementarity" else []
    else:
        s = ca.SX.sym("s")
        seen = relaxation.relax(g, s, sigma, "complementarity", name, limit)
        unknowns = [replace(u, guess=ca.substitute(u.guess, s, ca.fmax(h, 0))) for u in seen.unknowns]
        slack = Unknown(s, 0.0, np.inf, ca.fmax(h, 0))
        inner = replace(_with_rows(seen, [s - h]), unknowns=(slack, *unknowns))
        signs = [] if pair.sign_known else [g]
    return _with_rows(inner, signs) if inner.signs else inner


def _with_rows(relaxed: Relaxed, rows: list[ca.SX]) -> Relaxed:
    """Put rows >= 0 in front."""
    return replace(
        relaxed,
        rows=ca.vertcat(*rows, relaxed.rows),
        lower=(0.0,) * len(rows) + relaxed.lower,
        upper=(np.inf,) * len(rows) + relaxed.upper,
    )
