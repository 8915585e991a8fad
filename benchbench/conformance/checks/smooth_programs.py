"""Smooth programs with known solutions that a solver for programs without any structure must solve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchbench.conformance.checks.programs import block, unknowns
from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Mpcc


@dataclass(frozen=True)
class SmoothProgram:
    """A program without pairs, its only solution x (n,) and objective for a sigma."""

    name: str
    mpcc: Mpcc
    solution: Array
    objective: float
    sigma: float = 0.0


def convex() -> list[SmoothProgram]:
    """Programs that any solver must solve."""
    return [quadratic(), follows_sigma(2.0), follows_sigma(-1.0)]


def hard() -> list[SmoothProgram]:
    """Programs with one solution that a solver may miss, but not misjudge."""
    return [hs071(), rosenbrock()]


def hs071() -> SmoothProgram:
    """Hock & Schittkowski 1981, No. 71; to 1e-8 as in IPOPT's documentation."""
    cost = block("cost", range(4), lambda z, p, s: [z[0] * z[3] * (z[0] + z[1] + z[2]) + z[2]])
    rows = block(
        "rows",
        range(4),
        lambda z, p, s: [z[0] * z[1] * z[2] * z[3], sum(x**2 for x in z)],
        [25, 40],
        [np.inf, 40],
    )
    mpcc = Mpcc((unknowns([1.0, 5.0, 5.0, 1.0], 1.0, 5.0),), (rows,), (cost,))
    return SmoothProgram("hs071", mpcc, np.array([1.0, 4.74299964, 3.82114998, 1.37940829]), 17.01401729)


def rosenbrock() -> SmoothProgram:
    """No constraints, no bounds: (1, 1)."""
    cost = block("cost", range(2), lambda z, p, s: [100 * (z[1] - z[0] ** 2) ** 2 + (1 - z[0]) ** 2])
    return SmoothProgram("rosenbrock", Mpcc((unknowns([-1.2, 1.0]),), (), (cost,)), np.ones(2), 0.0)


def quadratic() -> SmoothProgram:
    """Min |x|^2 / 2 with x_0 + x_1 + x_2 = 3, x_0 >= 1.5 and x_2 fixed at 0.5: (1.5, 1, 0.5)."""
    cost = block("cost", [[0], [1], [2]], lambda z, p, s: [z[0] ** 2 / 2])
    total = block("total", range(3), lambda z, p, s: [z[0] + z[1] + z[2]], 3.0, 3.0)
    x = unknowns([2.0, 0.0, 0.5], [1.5, -np.inf, 0.5], [np.inf, np.inf, 0.5])
    return SmoothProgram("quadratic", Mpcc((x,), (total,), (cost,)), np.array([1.5, 1.0, 0.5]), 1.75)


def follows_sigma(sigma: float) -> SmoothProgram:
    """Min (x - sigma)^2, x >= 0: max(sigma, 0)."""
    cost = block("cost", [0], lambda z, p, s: [(z[0] - s) ** 2])
    mpcc = Mpcc((unknowns([0.5], 0.0),), (), (cost,))
    return SmoothProgram(f"sigma={sigma:g}", mpcc, np.array([max(sigma, 0.0)]), min(sigma, 0.0) ** 2, sigma)
