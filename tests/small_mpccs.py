"""Small MPCCs with known solutions: written by hand, and those of the package pympcc."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, Pair, PairKind, Slot, Variable

SIGMA = ca.SX.sym("sigma")
NONE = ca.SX.sym("p", 0)


@dataclass(frozen=True)
class Small:
    """A problem, the smallest objective there is, how far above or below an approximation may end, and why."""

    name: str
    mpcc: Mpcc
    optimum: float
    tolerance: float = 1e-3
    note: str = ""


def block(name: str, z: ca.SX, out: Sequence[Any], lower: float = 0.0, upper: float = 0.0) -> Block:
    """One instance of a function of all entries of the variable "x"."""
    out = ca.vertcat(*out)
    slot = Slot("x", np.arange(z.shape[0])[None, :])
    shape = (1, out.shape[0])
    function = ca.Function(name, [z, NONE, SIGMA], [out])
    return Block(name, function, (slot,), np.zeros((1, 0)), np.full(shape, lower), np.full(shape, upper))


def problem(
    start: Sequence[float] | Array, cost: Callable, g: Callable, h: Callable,
    lower: Any = -np.inf, upper: Any = np.inf, below: Callable | None = None, equal: Callable | None = None,
    kind: PairKind = "complementarity",
) -> Mpcc:  # fmt: skip
    """Minimise cost(x) with g, h paired, below(x) <= 0, equal(x) = 0; functions take an array of symbols."""
    n = len(start)
    z = ca.SX.sym("x", n)
    x = np.array([z[i] for i in range(n)], dtype=object)
    low, high = (np.array(np.broadcast_to(b, n), float)[:, None] for b in (lower, upper))
    rows = (block("below", z, below(x), -np.inf, 0.0),) if below else ()
    rows += (block("equal", z, equal(x)),) if equal else ()
    pair = Pair(block("touch", z, [*g(x), *h(x)]), kind)
    variable = Variable("x", low, high, np.array(start, float)[:, None])
    return Mpcc((variable,), rows, (block("cost", z, [cost(x)]),), (pair,))


def by_hand() -> list[Small]:
    """Optima follow from the two branches of each pair; the notes name the trap."""
    x0, x1 = (lambda x: [x[0]]), (lambda x: [x[1]])
    return [
        Small("ralph2", problem([0.4, 0.9], lambda x: x[0] ** 2 + x[1] ** 2 - 4 * x[0] * x[1], x0, x1), 0.0,
              note="origin, strongly stationary, biactive; f = -2 sigma on x y = sigma (MacMPEC)"),
        Small("scholtes3", problem([0.7, 0.4], lambda x: ((x[0] - 1) ** 2 + (x[1] - 1) ** 2) / 2, x0, x1), 0.5,
              note="(1, 0) or (0, 1); the origin with f = 1 is C-stationary (MacMPEC)"),
        Small("scholtes4", problem([0.5, 0.7, 0.3], lambda x: x[0] + x[1] - x[2], x0, x1,
                                   below=lambda x: [x[2] - 4 * x[0], x[2] - 4 * x[1]]), 0.0, 5e-3,
              "origin, B- and M- but not strongly stationary (Scheel & Scholtes 2000): f = -2 sqrt(sigma)"),
        Small("scale1", problem([0.5, 0.3], lambda x: (100 * x[0] - 1) ** 2 + (x[1] - 1) ** 2, x0, x1), 1.0,
              note="badly scaled pair: (0.01, 0) or (0, 1) (as in MacMPEC)"),
        Small("scale4", problem([0.5, 0.3], lambda x: 100 * ((x[0] - 1) ** 2 + (x[1] - 1) ** 2), x0, x1), 100.0, 0.1,
              "badly scaled cost (as in MacMPEC)"),
        Small("cubic", problem([0.5, 0.5], lambda x: (x[0] - 1) ** 2 + x[1] ** 2 + x[1] ** 3, x0, x1), 0.0,
              note="(1, 0), strongly stationary; the origin with f = 1 is C-stationary"),
        Small("weak", problem([0.5, 0.4], lambda x: (x[0] + 1) ** 2 + (x[1] - 1) ** 2, x0, x1), 1.0,
              note="(0, 1); the origin with f = 2 is W- and C- but not M-stationary"),
        Small("forced", problem([0.5, 0.5], lambda x: (x[0] - 1) ** 2 + (x[1] - 1) ** 2, x0, x1,
                                below=lambda x: [x[0] + x[1]]), 2.0, 5e-3,
              "only the origin is feasible: no relaxation may need an interior"),
        Small("academic", problem([2.0, 4.0], lambda x: 4 * x[0] + 2 * x[1], lambda x: [x[0], x[1]],
                                  lambda x: [5 * np.sqrt(2) - x[0] - x[1], 5 - x[0] - x[1]], 0.0,
                                  below=lambda x: [3 - x[0] - x[1]], kind="vanishing"), 10.0,
              note="(0, 5); (0, 5 sqrt 2) with f = 14.1 is only weakly stationary, and a trap (Achtziger & Kanzow 2008)"),
        Small("held", problem([1.0, 1.5], lambda x: (x[0] - 2) ** 2 + (x[1] - 2) ** 2, x0, lambda x: [x[1] - 1],
                              kind="vanishing"), 1.0, note="(2, 1): the condition holds"),
        Small("inside", problem([1.0, 1.5], lambda x: (x[0] - 1) ** 2 + (x[1] + 1) ** 2, x0, lambda x: [x[1] - 1],
                                kind="vanishing"), 0.0, note="(1, -1): H < 0 is allowed"),
        Small("vanished", problem([0.5, 2.5], lambda x: (x[0] - 1) ** 2 + (x[1] - 3) ** 2, x0, lambda x: [x[1] - 1],
                                  below=lambda x: [2 - x[1]], kind="vanishing"), 1.0, note="(0, 3): G must be 0"),
    ]  # fmt: skip


def pympcc_problems() -> list[Small]:
    """Convert the collection of pympcc; its exponentials are called on floats only, so they are rewritten here."""
    from pympcc.benchmarks import ALL_PROBLEMS

    def exponential(x: Any) -> list[ca.SX]:
        return [-ca.exp(x[0]) + x[1] - ca.exp(x[2])]

    found = []
    for spec in ALL_PROBLEMS:
        p = spec.problem
        g = exponential if spec.name in ("scholtes1", "scholtes2") else p.comp_G
        below = p.ineq_constraints if p.n_ineq else None
        equal = p.eq_constraints if p.n_eq else None
        mpcc = problem(p.x0, p.objective, g, p.comp_H, p.xl, p.xu, below, equal)
        found.append(Small(spec.name, mpcc, spec.f_opt, spec.f_atol))
    return found
