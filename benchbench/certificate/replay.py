"""Replay of the planned inputs on the plant by an error-controlled integrator (DOP853, 8th order).

The inputs jump at nodes, so every interval is integrated on its own, over the fraction s in [0, 1] of it.
Two questions: `defects` asks whether the plan agrees with itself (each interval starts at its planned state), `replay`
what the vehicle does open loop from the first state on; `fly` answers both at the price of one. All intervals are
flown at once (`shooting`); where that finds no flight, the flight in turn decides (`sequential`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchbench.certificate import sequential
from benchbench.certificate.pieces import Pieces
from benchbench.certificate.shooting import Shot, roughly, settled
from benchbench.ground.arrays import Array, Index
from benchbench.ocp.model import Plant
from benchbench.ocp.plan import Plan

TOLERANCE = 1e-10
"""Relative and absolute tolerance of a step, far below every limit of the certificate."""
FAR = 1e3
"""m, rad, m/s or rad/s: a replay that gets here has left any room and is stopped."""
MOST_RESTARTS = 1000
"""A solver may claim a flight of centuries: so many restarts are made of it, half an hour of a real one."""


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
    return _defects(plan, plant, _alone(plan, plant))


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
    restarts = tuple(sorted({*_restarts(plan.time, restart_seconds), *restart_nodes}))
    return _replay(plan, plant, _alone(plan, plant), samples, restarts)


def fly(
    plan: Plan,
    plant: Plant,
    samples: int = 10,
    restart_seconds: float | None = None,
    restart_nodes: Sequence[int] = (),
) -> tuple[Defects, Replay]:
    """Return `defects` and `replay`, which begin with the same integration of all intervals."""
    alone = _alone(plan, plant)
    restarts = tuple(sorted({*_restarts(plan.time, restart_seconds), *restart_nodes}))
    return _defects(plan, plant, alone), _replay(plan, plant, alone, samples, restarts)


def _alone(plan: Plan, plant: Plant) -> Shot | None:
    """All intervals at once, each from its planned state; None where one breaks down or needs very short steps."""
    start = np.hstack([plan.configuration, plan.velocity])[:-1]
    with np.errstate(all="ignore"):
        return settled(Shot.of(Pieces.of(plan, plant), start), np.arange(plan.intervals), TOLERANCE, FAR)


def _defects(plan: Plan, plant: Plant, alone: Shot | None) -> Defects:
    ends = sequential.ends(plan, plant, TOLERANCE, FAR) if alone is None else alone.ends
    half = plan.configuration.shape[1]
    return Defects(ends[:, :half] - plan.configuration[1:], ends[:, half:] - plan.velocity[1:])


def _whole(plan: Plan, plant: Plant, alone: Shot | None, restarts: tuple[int, ...]) -> Shot | None:
    """The flight at once: found from the planned states, or from a rough flight where the inputs lead elsewhere."""
    nodes = np.array([0, *restarts])
    found = None if alone is None else settled(alone, nodes, TOLERANCE, FAR)
    if found is not None:
        return found
    pieces = Pieces.of(plan, plant)
    start = roughly(pieces, np.hstack([plan.configuration, plan.velocity])[:-1], nodes)
    return settled(Shot.of(pieces, start), nodes, TOLERANCE, FAR)


def _replay(plan: Plan, plant: Plant, alone: Shot | None, samples: int, restarts: tuple[int, ...]) -> Replay:
    fractions = np.arange(1, samples + 1) / samples
    with np.errstate(all="ignore"):
        whole = _whole(plan, plant, alone, restarts)
        states = None if whole is None else whole.at(fractions)
    if states is None:
        states = sequential.flight(plan, plant, fractions, restarts, TOLERANCE, FAR)
    half, inner = plan.configuration.shape[1], np.arange(samples) / samples
    first = np.hstack([plan.configuration[0], plan.velocity[0]])
    states = np.vstack([first, states.reshape(plan.intervals * samples, -1)])
    time = np.append((plan.time[:-1, None] + np.diff(plan.time)[:, None] * inner).ravel(), plan.time[-1])
    broken = ~np.isfinite(states).all(axis=1)
    broken_at = float(time[np.argmax(broken)]) if broken.any() else None
    nodes = np.arange(plan.intervals + 1, dtype=np.int64) * samples
    return Replay(time, states[:, :half], states[:, half:], nodes, restarts, broken_at)


def _restarts(time: Array, seconds: float | None) -> tuple[int, ...]:
    if seconds is None:
        return ()
    marks = np.arange(seconds, min(time[-1], MOST_RESTARTS * seconds), seconds)
    nodes = np.unique(np.argmin(np.abs(time[:, None] - marks), axis=0)) if len(marks) else ()
    return tuple(int(k) for k in nodes if 0 < k < len(time) - 1)
