"""Interface of a relaxation, and what turns an MPCC into a smooth program with a parameter sigma."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, ClassVar

import casadi as ca
import numpy as np
from pydantic import Field

from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, Pair, PairKind, Slot, Variable, evaluate

Schedule = Annotated[tuple[Annotated[float, Field(gt=0, allow_inf_nan=False)], ...], Field(min_length=1)]
"""Values of sigma > 0, at least one; a field of this type refuses anything else."""


@dataclass(frozen=True)
class Unknown:
    """A new scalar unknown per pair, brought in by a relaxation; `guess` is an expression of g, h.

    With `update` it is held at its guess during a solve, and has the value of `update` (an expression of
    g, h, sigma and the pair's unknowns), clipped into its bounds, in the next: a multiplier estimate.
    """

    symbol: ca.SX
    lower: float
    upper: float
    guess: ca.SX
    update: ca.SX | None = None


@dataclass(frozen=True)
class Shared:
    """A new scalar unknown that all pairs share: one symbol, whose name is the variable's.

    `cost`, an expression of it and sigma, counts once.
    """

    symbol: ca.SX
    lower: float
    upper: float
    guess: float
    cost: ca.SX


@dataclass(frozen=True)
class Gap:
    """The physical gap behind H = (gap / limit)^2 - 1: its largest value in contact, in `unit`."""

    limit: float
    unit: str


@dataclass(frozen=True)
class Relaxed:
    """What became of one scalar pair: rows with bounds, a cost term, new unknowns.

    `pairs`: what is left to a solver that takes complementarity pairs as they are (`Solver.native_pairs`).
    `signs`: the rows do not imply G >= 0 (and H >= 0 for a complementarity pair); the framework adds them
    where they are not a bound or a constraint of the problem already.
    """

    rows: ca.SX
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    cost: ca.SX = field(default_factory=lambda: ca.SX(0))
    unknowns: tuple[Unknown, ...] = ()
    shared: tuple[Shared, ...] = ()
    pairs: tuple[tuple[ca.SX, ca.SX], ...] = ()
    signs: bool = True


class Relaxation(ABC):
    """Replaces one scalar pair by something smooth; the framework does it for all pairs and drives sigma.

    `schedule` are the values of sigma to solve for, one after the other; what sigma means is the
    plugin's own business. `kinds` are the kinds of pairs it takes; a relaxation without "vanishing" gets
    such a pair with a slack s >= H as the complementarity pair 0 <= G, s >= 0, G s = 0.
    """

    schedule: tuple[float, ...]
    kinds: ClassVar[tuple[PairKind, ...]] = ("complementarity",)
    accuracy: ClassVar[float] = 1e-3
    """How far from a stationary point, and from G H = 0, the last sigma may end on a problem scaled to one."""

    power: ClassVar[float] = 1.0
    """Products G H end near sigma to this power; 0: there is no sigma to drive."""

    @abstractmethod
    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, gap: Gap | None) -> Relaxed:
        """Return rows for the scalar pair (g, h) of a kind; `gap`: the physical one, where h is made of one."""


@dataclass(frozen=True)
class Smooth:
    """A relaxed problem; each update gives the held unknowns of the same name their next values."""

    mpcc: Mpcc
    updates: tuple[Block, ...] = ()

    def after(self, x: Array, sigma: float) -> Smooth:
        """Return the problem to solve next, when x (n,) was found for sigma; itself when nothing is held."""
        if not self.updates:
            return self
        held = {u.name: np.clip(evaluate(u, self.mpcc, x, sigma), u.lower, u.upper) for u in self.updates}
        variables = (
            replace(v, lower=held[v.name], upper=held[v.name], guess=held[v.name]) if v.name in held else v
            for v in self.mpcc.variables
        )
        return replace(self, mpcc=replace(self.mpcc, variables=tuple(variables)))


def relax(mpcc: Mpcc, relaxation: Relaxation) -> Mpcc:
    """Return the relaxed problem of the first sigma; the same for all unless unknowns are held."""
    return smooth(mpcc, relaxation).mpcc


def smooth(mpcc: Mpcc, relaxation: Relaxation) -> Smooth:
    """Return the relaxed problem: pairs became constraints, costs and unknowns; guesses are carried over."""
    sigma = ca.SX.sym("sigma")
    result = replace(mpcc, pairs=())
    updates: tuple[Block, ...] = ()
    shared: dict[str, Shared] = {}
    for i, pair in enumerate(mpcc.pairs):
        if not pair.block.instances:
            continue
        first = all(earlier.block.name != pair.block.name for earlier in mpcc.pairs[:i])
        name = pair.block.name if first else f"{pair.block.name}_{i}"
        part = _PairBlock(pair, name, sigma, *_relax_all(pair, relaxation, sigma))
        result += part.problem(evaluate(pair.block, mpcc, mpcc.guess))
        updates += part.updates()
        shared |= {s.symbol.name(): s for s in part.shared}
    for unknown in shared.values():
        result += _shared(unknown, sigma)
    return Smooth(result, updates)


@dataclass(frozen=True)
class _PairBlock:
    """A pair block: the symbols of one instance (g, h) and what became of each of its scalar pairs."""

    pair: Pair
    name: str
    sigma: ca.SX
    g: ca.SX
    h: ca.SX
    parts: tuple[Relaxed, ...]

    @property
    def shared(self) -> tuple[Shared, ...]:
        return tuple({s.symbol.name(): s for part in self.parts for s in part.shared}.values())

    def problem(self, start: Array) -> Mpcc:
        """Rows, cost and unknowns; `start` (instances, 2 pairs) are G and H at the guess."""
        rows = self._block(self.pair.block.name, "relaxed", ca.vertcat(*(part.rows for part in self.parts)))
        low, high = (
            self._every([b for part in self.parts for b in getattr(part, k)]) for k in ("lower", "upper")
        )
        cost = sum((part.cost for part in self.parts), ca.SX(0))
        penalty = () if cost.is_zero() else (self._block(f"{self.pair.block.name}_penalty", "penalty", cost),)
        variables = tuple(self._variable(name, unknowns, start) for name, unknowns in self._own().items())
        left = [pair for part in self.parts for pair in part.pairs]
        pairs = (
            () if not left else (Pair(self._block(self.name, "pairs", _stacked(left)), "complementarity"),)
        )
        return Mpcc(variables, (replace(rows, lower=low, upper=high),) if low.size else (), penalty, pairs)

    def updates(self) -> tuple[Block, ...]:
        """What the held unknowns become, with their limits."""
        held = self.held
        if not held:
            return ()
        update = self._block(f"{self.name}_held", "update", ca.vertcat(*(e for _, e in held)))
        low, high = (self._every([getattr(u, k) for u, _ in held]) for k in ("lower", "upper"))
        return (replace(update, lower=low, upper=high),)

    @property
    def free(self) -> list[Unknown]:
        return [u for part in self.parts for u in part.unknowns if u.update is None]

    @property
    def held(self) -> list[tuple[Unknown, ca.SX]]:
        return [(u, u.update) for part in self.parts for u in part.unknowns if u.update is not None]

    def _own(self) -> dict[str, list[Unknown]]:
        """The free and the held unknowns by the name of their variable."""
        named = {f"{self.name}_slack": self.free, f"{self.name}_held": [u for u, _ in self.held]}
        return {name: unknowns for name, unknowns in named.items() if unknowns}

    def _variable(self, name: str, unknowns: list[Unknown], start: Array) -> Variable:
        first = ca.Function("first", [ca.vertcat(self.g, self.h)], [ca.vertcat(*(u.guess for u in unknowns))])
        low, high = (self._every([getattr(u, k) for u in unknowns]) for k in ("lower", "upper"))
        guess = np.clip(np.asarray(first.map(len(start))(start.T)).T, low, high)
        if any(u.update is not None for u in unknowns):  # held at the guess
            return Variable(name, guess, guess, guess)
        return Variable(name, low, high, guess)

    def _block(self, name: str, what: str, expression: ca.SX) -> Block:
        """Bring an expression of g, h and the new unknowns to the instances of the pair block."""
        block, count = self.pair.block, self.g.shape[0]
        new = ca.vertcat(
            ca.SX(0, 1),
            *(u.symbol for unknowns in self._own().values() for u in unknowns),
            *(s.symbol for s in self.shared),
        )
        z, p = (ca.SX.sym(n, block.function.size1_in(i)) for i, n in enumerate("zp"))
        gh = block.function(z, p, self.sigma)
        inside = ca.Function("inside", [self.g, self.h, new, self.sigma], [expression])
        out = inside(gh[:count], gh[count:], new, self.sigma)
        function = ca.Function(f"{block.name}_{what}", [ca.vertcat(z, new), p, self.sigma], [out])
        m = block.instances
        slots = [Slot(n, np.arange(m * len(u)).reshape(m, -1)) for n, u in self._own().items()]
        slots += [Slot(s.symbol.name(), np.zeros((m, 1), dtype=np.int64)) for s in self.shared]
        none = np.zeros((m, out.shape[0]))
        return replace(
            block, name=name, function=function, slots=(*block.slots, *slots), lower=none, upper=none
        )

    def _every(self, values: list[float]) -> Array:
        """The same values for every instance."""
        return np.tile(np.array(values, float), (self.pair.block.instances, 1))


def _stacked(pairs: Sequence[tuple[ca.SX, ca.SX]]) -> ca.SX:
    """[G; H] as a pair block gives it."""
    return ca.vertcat(*(g for g, _ in pairs), *(h for _, h in pairs))


def _relax_all(pair: Pair, relaxation: Relaxation, sigma: ca.SX) -> tuple[ca.SX, ca.SX, tuple[Relaxed, ...]]:
    count = pair.block.function.size1_out(0) // 2
    g, h = ca.SX.sym("g", count), ca.SX.sym("h", count)
    gaps = [Gap(limit, pair.block.unit) for limit in pair.limit] if pair.limit else [None] * count
    return g, h, tuple(_relax_scalar(pair, relaxation, g[i], h[i], sigma, gaps[i]) for i in range(count))


def _shared(unknown: Shared, sigma: ca.SX) -> Mpcc:
    """The unknown and its cost."""
    name, none = unknown.symbol.name(), np.zeros((1, 1))
    low, high, guess = (np.full((1, 1), x) for x in (unknown.lower, unknown.upper, unknown.guess))
    function = ca.Function(f"{name}_cost", [unknown.symbol, ca.SX.sym("p", 0), sigma], [unknown.cost])
    slots = (Slot(name, none.astype(np.int64)),)
    cost = Block(f"{name}_cost", function, slots, parameters=np.zeros((1, 0)), lower=none, upper=none)
    return Mpcc((Variable(name, low, high, guess),), (), (cost,))


def _relax_scalar(
    pair: Pair, relaxation: Relaxation, g: ca.SX, h: ca.SX, sigma: ca.SX, gap: Gap | None
) -> Relaxed:
    if pair.kind in relaxation.kinds:
        inner = relaxation.relax(g, h, sigma, pair.kind, gap)
        signs = [] if pair.sign_known else [g]
        signs += [h] if pair.kind == "complementarity" else []
    else:
        s = ca.SX.sym("s")
        seen = relaxation.relax(g, s, sigma, "complementarity", gap)
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
