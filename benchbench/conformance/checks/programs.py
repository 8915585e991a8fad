"""Small problems with known solutions, made of the same pieces as any MPCC."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array
from benchbench.mpcc import problem
from benchbench.mpcc.problem import Block, Mpcc, Pair, PairKind, Slot, Variable

Expression = Callable[..., Sequence[Any]]


def unknowns(
    start: Sequence[float] | Array, lower: Any = -np.inf, upper: Any = np.inf, name: str = "x"
) -> Variable:
    """One column of unknowns."""
    guess = np.asarray(start, float)[:, None]
    low, high = (
        np.broadcast_to(np.asarray(b, float).reshape(-1, 1), guess.shape).copy() for b in (lower, upper)
    )
    return Variable(name, low, high, guess)


def block(
    name: str, where: Any, outputs: Expression, lower: Any = 0.0, upper: Any = 0.0, parameters: Any = None
) -> Block:
    """`outputs(z, p, sigma)`, of lists of scalars, with `parameters` (instances, n_p).

    `where` are slots, or the places in "x" that each instance reads, (instances, n_z).
    """
    if not isinstance(where, tuple):
        where = (Slot("x", np.atleast_2d(np.asarray(where, dtype=np.int64))),)

    def rule(*reads: ca.SX) -> Sequence[Any]:
        z, p = reads[: len(where)], reads[len(where) :]
        return outputs(*(ca.vertsplit(ca.vertcat(*part)) if part else [] for part in (z, p)), sigma)

    sigma = ca.SX.sym("sigma")
    return problem.block(name, where, rule, lower, upper, parameters=parameters, sigma=sigma)


@dataclass(frozen=True)
class Known:
    """An MPCC, and for each group of unknowns the points that are allowed as its solution.

    `solutions` holds, for each group, which unknowns it is and the acceptable values of these.
    """

    name: str
    mpcc: Mpcc
    solutions: tuple[tuple[tuple[int, ...], tuple[tuple[float, ...], ...]], ...]

    def distance(self, x: Array) -> float:
        """Largest distance of a group from its nearest acceptable point."""
        return max(
            min(float(np.linalg.norm(x[list(where)] - np.array(point))) for point in points)
            for where, points in self.solutions
        )


def _projections(
    kind: PairKind, cases: Sequence[tuple[tuple[float, float], tuple[tuple[float, float], ...]]]
) -> Mpcc:
    """Nearest feasible points to several given points, one pair each: min |x - a|^2 + |y - b|^2, 0 <= x _|_ y."""
    targets = np.array([point for point, _ in cases])
    index = np.arange(2 * len(cases)).reshape(-1, 2)
    start = np.array([1.0, 0.6]) + 0.1 * targets
    cost = block("cost", index, lambda z, p, s: [(z[0] - p[0]) ** 2 + (z[1] - p[1]) ** 2], parameters=targets)
    pair = Pair(block("touch", index, lambda z, p, s: [z[0], z[1]], lower=0.0), kind)
    return Mpcc((unknowns(start.ravel()),), (), (cost,), (pair,))


def known() -> list[Known]:
    """Solutions follow from the branches of the pairs, written out in the code."""
    strict = [
        ((3.0, 0.0), ((3.0, 0.0),)), ((0.0, 2.0), ((0.0, 2.0),)),  # feasible already
        ((2.0, -1.0), ((2.0, 0.0),)), ((-1.0, 2.0), ((0.0, 2.0),)),
        ((2.0, 1.0), ((2.0, 0.0), (0.0, 1.0))),  # two local minima
        ((0.3, 0.2), ((0.3, 0.0), (0.0, 0.2))),  # two close ones: only a tight relaxation tells them apart
    ]  # fmt: skip
    biactive = [((-1.0, -1.0), ((0.0, 0.0),)), ((0.0, 0.0), ((0.0, 0.0),))]  # with and without multipliers
    vanishing = [
        ((2.0, -1.0), ((2.0, -1.0),)), ((0.0, 2.0), ((0.0, 2.0),)), ((0.0, -2.0), ((0.0, -2.0),)),  # feasible
        ((-1.0, 2.0), ((0.0, 2.0),)), ((-1.0, -2.0), ((0.0, -2.0),)),
        ((2.0, 1.0), ((2.0, 0.0), (0.0, 1.0))),
    ]  # fmt: skip

    def groups(cases: Any) -> Any:
        return tuple(((2 * i, 2 * i + 1), points) for i, (_, points) in enumerate(cases))

    return [
        Known("strict", _projections("complementarity", strict), groups(strict)),
        Known("biactive", _projections("complementarity", biactive), groups(biactive)),
        Known("vanishing", _projections("vanishing", vanishing), groups(vanishing)),
        _scaled(),
        _bilevel(),
    ]


def _scaled() -> Known:
    """Min (x - 3)^2 + (y - 5)^2 with 0 <= 10 (x - 1) _|_ (y - 2) / 10 >= 0: minima at (3, 2) and (1, 5)."""
    cost = block("cost", [0, 1], lambda z, p, s: [(z[0] - 3) ** 2 + (z[1] - 5) ** 2])
    pair = Pair(block("touch", [0, 1], lambda z, p, s: [10 * (z[0] - 1), (z[1] - 2) / 10]), "complementarity")
    return Known(
        "scaled", Mpcc((unknowns([2.0, 4.0]),), (), (cost,), (pair,)), (((0, 1), ((3.0, 2.0), (1.0, 5.0))),)
    )


def _bilevel() -> Known:
    """bard1 of MacMPEC (Bard 1991): the lower level's optimality conditions are three pairs.

    min (x - 5)^2 + (2 y + 1)^2 with 2 (y - 1) - 1.5 x + l_1 - l_2 / 2 + l_3 = 0 and l >= 0 complementary to
    3 x - y - 3, y / 2 - x + 4, 7 - x - y; x, y >= 0.
    Local minima (1, 0) with f = 17 and, where two rows meet, (5, 2) with f = 25.
    """
    cost = block("cost", [0, 1], lambda z, p, s: [(z[0] - 5) ** 2 + (2 * z[1] + 1) ** 2])
    stationary = block(
        "lower", range(5), lambda z, p, s: [2 * (z[1] - 1) - 1.5 * z[0] + z[2] - z[3] / 2 + z[4]]
    )
    pair = block(
        "touch", range(5),
        lambda z, p, s: [z[2], z[3], z[4], 3 * z[0] - z[1] - 3, z[1] / 2 - z[0] + 4, 7 - z[0] - z[1]],
    )  # fmt: skip
    x = unknowns([1.5, 0.5, 1.0, 1.0, 1.0], [0.0, 0.0, -np.inf, -np.inf, -np.inf])
    mpcc = Mpcc((x,), (stationary,), (cost,), (Pair(pair, "complementarity"),))
    return Known("bilevel", mpcc, (((0, 1), ((1.0, 0.0), (5.0, 2.0))),))
