"""Replay of the planned inputs on the plant by an error-controlled integrator (DOP853, 8th order).

The inputs jump at nodes, so every interval is integrated on its own, over the fraction s in [0, 1] of it.
Two questions, two functions: `defects` asks whether the plan agrees with itself (each interval starts at its
planned state), `replay` what the vehicle does open loop from the first state on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.integrate import DOP853

from benchbench.arrays import Array, Index
from benchbench.ocp.model import Plant
from benchbench.ocp.plan import Plan, bezier

TOLERANCE = 1e-10
"""Relative and absolute tolerance of a step, far below every limit of the certificate."""
FAR = 1e3
"""m, rad, m/s or rad/s: a replay that gets here has left any room and is stopped."""
EVALUATIONS = 5000
"""Evaluations allowed at once, plus ALLOWANCE per interval; a smooth interval takes 15 to 40."""
ALLOWANCE = 100


@dataclass(frozen=True)
class Defects:
    """State reached at the end of each interval from its planned first state, minus the planned last state.

    configuration (N, n_q), velocity (N, n_v); NaN where the integration broke down.
    """

    configuration: Array
    velocity: Array


@dataclass(frozen=True)
class Replay:
    """Dense open-loop flight; NaN after a breakdown.

    time (m,) s; configuration (m, n_q), velocity (m, n_v); nodes (N + 1,) positions of the plan's nodes in `time`;
    restarts: nodes at which the flight starts again from the planned state (the sample there is the one
    before the restart); broken_at: s, None when the whole plan was flown.
    """

    time: Array
    configuration: Array
    velocity: Array
    nodes: Index
    restarts: tuple[int, ...]
    broken_at: float | None


def defects(plan: Plan, plant: Plant) -> Defects:
    """Integrate all intervals at once, each from its planned state."""
    start = np.hstack([plan.configuration, plan.velocity])
    half = plan.configuration.shape[1]
    rate = _rate(plant, half, np.diff(plan.time)[:, None], plan.input_pieces)
    end = _integrate(rate, start[:-1].ravel(), np.ones(1), EVALUATIONS)[0]
    missed = end.reshape(start[1:].shape) - start[1:]
    return Defects(missed[:, :half], missed[:, half:])


def replay(
    plan: Plan,
    plant: Plant,
    samples: int = 10,
    restart_seconds: float | None = None,
    restart_nodes: Sequence[int] = (),
) -> Replay:
    """Fly the inputs from the first planned state, `samples` points per interval.

    The flight starts again from the planned state at `restart_nodes`, and with `restart_seconds` at the nodes
    nearest to its multiples: an unstable vehicle cannot be flown open loop for long.
    """
    planned = np.hstack([plan.configuration, plan.velocity])
    pieces = plan.input_pieces
    step, fractions = np.diff(plan.time), np.arange(1, samples + 1) / samples
    half = plan.configuration.shape[1]
    restarts = tuple(sorted({*_restarts(plan.time, restart_seconds), *restart_nodes}))
    flown = np.full((plan.intervals * samples + 1, planned.shape[1]), np.nan)
    flown[0] = state = planned[0]
    budget = EVALUATIONS + ALLOWANCE * plan.intervals
    for k in range(plan.intervals):
        rate = _rate(plant, half, step[k], pieces[k])
        rows = slice(k * samples + 1, (k + 1) * samples + 1)
        flown[rows] = _integrate(rate, state, fractions, budget)
        budget -= rate.calls
        state = planned[k + 1] if k + 1 in restarts else flown[rows][-1]
        if not np.isfinite(flown[rows]).all():
            break
    inner = plan.time[:-1, None] + step[:, None] * np.arange(samples) / samples
    time = np.append(inner.ravel(), plan.time[-1])
    broken = ~np.isfinite(flown).all(axis=1)
    broken_at = float(time[np.argmax(broken)]) if broken.any() else None
    nodes = np.arange(plan.intervals + 1, dtype=np.int64) * samples
    return Replay(time, flown[:, :half], flown[:, half:], nodes, restarts, broken_at)


class _rate:  # noqa: N801  (used as a function)
    """d[q, v]/ds over intervals of length `step` s, with inputs by control points; counts its calls."""

    def __init__(self, plant: Plant, half: int, step: Array, points: Array) -> None:
        self.plant, self.half, self.step, self.points, self.calls = plant, half, step, points, 0

    def __call__(self, s: float, y: Array) -> Array:
        self.calls += 1
        state = y.reshape(*self.points.shape[:-2], -1)
        half = self.half
        q, v = state[..., :half], state[..., half:]
        out = np.empty_like(state)
        out[..., :half] = self.plant.kinematics(q, v)
        out[..., half:] = self.plant.acceleration(q, v, bezier(self.points, s))
        return (self.step * out).ravel()


def _integrate(rate: Callable[[float, Array], Array], start: Array, fractions: Array, budget: int) -> Array:
    """States (len(fractions), n) at increasing fractions in (0, 1]; NaN from a breakdown on."""
    found = np.full((len(fractions), len(start)), np.nan)
    done = 0
    with np.errstate(all="ignore"):
        solver = DOP853(rate, 0.0, start, 1.0, rtol=TOLERANCE, atol=TOLERANCE, first_step=1.0)
        while solver.status == "running" and solver.nfev < budget:
            solver.step()
            if str(solver.status) == "failed" or not np.max(np.abs(solver.y)) < FAR:
                break
            reached = int(np.searchsorted(fractions, solver.t, side="right"))
            if reached > done:
                found[done:reached] = solver.dense_output()(fractions[done:reached]).T
                done = reached
    return found


def _restarts(time: Array, seconds: float | None) -> tuple[int, ...]:
    if seconds is None:
        return ()
    marks = np.arange(seconds, time[-1], seconds)
    nodes = np.unique(np.argmin(np.abs(time[:, None] - marks), axis=0)) if len(marks) else ()
    return tuple(int(k) for k in nodes if 0 < k < len(time) - 1)
