"""Programs over a time axis, one row of unknowns per node: what every solver here must take, stage solvers too.

A point on a line with position, speed and a held force: x (N + 1, 2), u (N, 1), step h = 1 / N, from rest.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from benchbench.conformance.checks.programs import block
from benchbench.conformance.checks.smooth_programs import SmoothProgram
from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, Slot, Variable, rows

N, H = 12, 1 / 12
Law = Callable[[Any, Any, Any], Any]


def rest_to_rest() -> SmoothProgram:
    """Least sum h u^2 from 0 to 1; the solution by linear algebra from the optimality conditions."""
    x, u = _variables(end=(1.0, 0.0))
    weights, matrix, ends = np.zeros(3 * N + 2), np.zeros((2 * N + 4, 3 * N + 2)), [0, 1, 2 * N, 2 * N + 1]
    weights[2 * N + 2 :] = 2 * H
    for k in range(N):
        a, b, c = 2 * k, 2 * N + 2 + k, 2 * k + 2
        matrix[2 * k, [c, a, a + 1]] = [1, -1, -H]
        matrix[2 * k + 1, [c + 1, a + 1, b]] = [1, -1, -H]
    matrix[-4:, ends] = np.eye(4)
    right = np.zeros(5 * N + 6)
    right[-2] = 1.0
    zero = np.zeros((len(matrix), len(matrix)))
    solution = np.linalg.solve(np.block([[np.diag(weights), matrix.T], [matrix, zero]]), right)[: 3 * N + 2]
    mpcc = Mpcc((x, u), (_steps(linear),), (_effort(),))
    return SmoothProgram("rest_to_rest", mpcc, solution, float(solution @ (weights * solution) / 2))


def lands_at(sigma: float) -> SmoothProgram:
    """The same to the position sigma, said by a row."""
    whole = rest_to_rest()
    x, u = _variables(end=(np.nan, 0.0))
    there = block("there", (Slot("x", np.array([[2 * N]])),), lambda z, p, s: [z[0] - s])
    mpcc = Mpcc((x, u), (_steps(linear), there), (_effort(),))
    return SmoothProgram(
        f"lands_at={sigma:g}", mpcc, sigma * whole.solution, sigma**2 * whole.objective, sigma
    )


def tracking() -> SmoothProgram:
    """A pendulum with known optimal forces: the cost is the squared distance from them, the end is where they lead."""
    forces = 3 * np.sin(np.arange(N) + 1.0)
    states = [(0.0, 0.0)]
    for force in forces:
        position, speed = swinging(*states[-1], force)
        states.append((float(position), float(speed)))
    x, u = _variables(end=states[-1])
    mpcc = Mpcc((x, u), (_steps(swinging),), (_effort(forces[:, None]),))
    return SmoothProgram("tracking", mpcc, np.concatenate([np.ravel(states), forces]), 0.0)


def impossible() -> Mpcc:
    """Rest to rest with a force that is too weak by half."""
    x, u = _variables(end=(1.0, 0.0), force=2.0)
    return Mpcc((x, u), (_steps(linear),), (_effort(),))


def falls_forever() -> Mpcc:
    """As far as possible with any force: no bound, no solution."""
    x, u = _variables(end=(np.nan, np.nan))
    far = block("far", (Slot("x", np.array([[2 * N]])),), lambda z, p, s: [-z[0]])
    return Mpcc((x, u), (_steps(linear),), (far,))


def undefined() -> Mpcc:
    """log(u - 1) at u = 0: NaN from the start."""
    x, u = _variables(end=(np.nan, np.nan))
    cost = block("log", (rows("u", 1, range(N)),), lambda z, p, s: [ca.log(z[0] - 1)])
    return Mpcc((x, u), (_steps(linear),), (cost,))


def linear(x: Any, v: Any, u: Any) -> tuple[Any, Any]:
    """Explicit Euler step of x'' = u."""
    return x + H * v, v + H * u


def swinging(x: Any, v: Any, u: Any) -> tuple[Any, Any]:
    """Explicit Euler step of x'' = u - 20 sin x."""
    sin = ca.sin(x) if isinstance(x, ca.SX) else np.sin(x)
    return x + H * v, v + H * (u - 20 * sin)


def _variables(end: tuple[float, ...], force: float = np.inf) -> tuple[Variable, Variable]:
    """From rest at 0; an end of NaN is free."""
    low, high = np.full((N + 1, 2), -np.inf), np.full((N + 1, 2), np.inf)
    low[0] = high[0] = 0.0
    fixed = np.isfinite(end)
    low[-1, fixed] = high[-1, fixed] = np.array(end)[fixed]
    none = np.zeros((N, 1))
    x = Variable("x", low, high, np.clip(np.zeros((N + 1, 2)), low, high))
    return x, Variable("u", none - force, none + force, none)


def _steps(law: Law) -> Block:
    left, right = rows("x", 2, range(N)), rows("x", 2, range(1, N + 1))

    def gap(z: Any, p: Any, s: Any) -> list[Any]:
        x, v = law(z[0], z[1], z[4])
        return [z[2] - x, z[3] - v]

    return block("step", (left, right, rows("u", 1, range(N))), gap)


def _effort(around: Array | float = 0.0) -> Block:
    wanted = np.broadcast_to(np.asarray(around, float), (N, 1))
    return block(
        "effort", (rows("u", 1, range(N)),), lambda z, p, s: [H * (z[0] - p[0]) ** 2], parameters=wanted
    )
