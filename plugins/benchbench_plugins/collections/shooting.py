"""Classics of optimal control as nonlinear programs: inputs held over equal intervals, each integrated by Runge-Kutta."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.ready import whole


@dataclass(frozen=True)
class Classic:
    """Minimise travel time + the integral of `running(x, u)` subject to dx/dt = rate(x, u).

    start, end  (n,) states, NaN where free; inputs: (lower, upper) of each, and the guess of each in `input_guess`
    time        T in s where it is fixed, or (least, guess, most) where it is free and counts as cost
    final       of the last state, where that is the cost: then a free time does not count
    path        of a state, at least 0 at every node; (n,) in, scalar out
    """

    rate: Callable[[ca.SX, ca.SX], ca.SX]
    running: Callable[[ca.SX, ca.SX], ca.SX] | None
    start: tuple[float, ...]
    end: tuple[float, ...]
    inputs: tuple[tuple[float, float], ...]
    input_guess: tuple[float, ...]
    time: float | tuple[float, float, float]
    final: Callable[[ca.SX], ca.SX] | None = None
    path: Callable[[ca.SX], ca.SX] | None = None


def transcribed(problem: Classic, intervals: int) -> Mpcc:
    """Return it with N intervals; unknowns are T, the states (N + 1, n) and the inputs (N, m), in a row.

    States start on the line from start to end; one that is free there stays where it began, one that is free here at 0.
    """
    n, m, nodes = len(problem.start), len(problem.inputs), intervals + 1
    w = ca.SX.sym("w", 1 + nodes * n + intervals * m)
    x = ca.reshape(w[1 : 1 + nodes * n], n, nodes)
    u = ca.reshape(w[1 + nodes * n :], m, intervals)
    h = w[0] / intervals
    gaps = [_end(problem.rate, x[:, k], u[:, k], h) - x[:, k + 1] for k in range(intervals)]
    free = not isinstance(problem.time, float)
    cost = problem.final(x[:, -1]) if problem.final else w[0] if free else ca.SX(0)
    if problem.running is not None:
        cost += sum(h * problem.running(x[:, k], u[:, k]) for k in range(intervals))
    kept = [problem.path(x[:, k]) for k in range(nodes)] if problem.path else []
    none = ca.SX(0, 1)
    values = {"f": cost, "g": ca.vertcat(*gaps, *kept), "G": none, "H": none}
    functions = {key: ca.Function(key, [w, ca.SX.sym("p", 0)], [value]) for key, value in values.items()}
    lower, guess, upper = _numbers(problem, intervals)
    rows, most = np.zeros(intervals * n + len(kept)), np.full(len(kept), np.inf)
    return whole(
        functions, np.zeros(0), guess, (lower, upper), (rows, np.append(rows[: intervals * n], most))
    )


def _end(rate: Callable[[ca.SX, ca.SX], ca.SX], x: ca.SX, u: ca.SX, h: ca.SX) -> ca.SX:
    """One step of the classical Runge-Kutta method."""
    a = rate(x, u)
    b = rate(x + h / 2 * a, u)
    c = rate(x + h / 2 * b, u)
    return x + h / 6 * (a + 2 * b + 2 * c + rate(x + h * c, u))


def _numbers(problem: Classic, intervals: int) -> tuple[Array, Array, Array]:
    """Lower bounds, guess and upper bounds of all unknowns."""
    times = (problem.time,) * 3 if isinstance(problem.time, float) else problem.time
    start, end = np.array(problem.start), np.array(problem.end)
    share = np.linspace(0.0, 1.0, intervals + 1)[:, None]
    first = np.nan_to_num(start)
    states = first + share * (np.where(np.isnan(end), first, end) - first)
    lower, upper = np.full(states.shape, -np.inf), np.full(states.shape, np.inf)
    for row, fixed in ((0, start), (-1, end)):
        known = ~np.isnan(fixed)
        lower[row, known] = upper[row, known] = fixed[known]
    low, high = (np.array([pair[i] for pair in problem.inputs]) for i in (0, 1))

    def joined(time: float, nodes: Array, inputs: Sequence[float] | Array) -> Array:
        return np.concatenate([[time], nodes.ravel(), np.tile(inputs, intervals)])

    return (
        joined(times[0], lower, low),
        joined(times[1], states, problem.input_guess),
        joined(times[2], upper, high),
    )
