"""Plain guesses: a plan that is there already, a straight line, hovering along a path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.model import AXES, space, travels
from benchbench.ocp.motion import sample
from benchbench.ocp.plan import Plan
from benchbench.ocp.stop import Stop, spread
from benchbench.planning.case import Case, Guess
from benchbench.planning.disturb import disturbed
from benchbench.planning.posture import touching

ABOVE = 0.02
"""How far above the target the straight line passes, m: a guess exactly on it sits on a stationary point."""


@final
@dataclass(frozen=True)
class GivenStart(Guess):
    """A plan that is there already, from another grid or an earlier solve."""

    found: Plan

    def plan(self, case: Case, ledger: Ledger) -> Plan:
        """Costs nothing."""
        return self.found


def first_plan(case: Case, ledger: Ledger) -> Plan:
    """Return what every strategy starts from: the guess of the case, disturbed by its seed (0: as it is)."""
    return disturbed(case.guess.plan(case, ledger), case, case.seed)


def straight_line(case: Case, sequence: Sequence[Stop] | None = None) -> Plan:
    """Start, above each target at its guessed contact time, end; at hover, without turning anything but the nose.

    sequence: the stops that are made, in order; None: as they are listed.
    """
    scenario, model = case.scenario, case.model
    itinerary = scenario.itinerary
    made = itinerary.listed if sequence is None else tuple(sequence)
    total, n = scenario.travel_time_guess, scenario.grid_intervals
    shares = spread(len(made), itinerary.middle)
    start, end = scenario.start_point(model), scenario.end_point(model)
    corners = np.stack([start, *(over(case, s, t) for s, t in zip(made, shares * total, strict=True)), end])
    time = np.linspace(0.0, total, n + 1)
    q = np.stack([np.interp(time, [0.0, *(shares * total), total], column) for column in corners.T], axis=-1)
    progress, first = np.zeros((n + 1, len(itinerary.stops))), 0
    for stop, share in zip(made, shares, strict=True):
        first = max(first, min(int(share * n), n - stop.kappa_init))
        progress[first : first + stop.kappa_init, itinerary.names.index(stop.name)] = 1.0
        first += stop.kappa_init
    return hovering(case, time, q, progress)


def hovering(case: Case, time: Array, q: Array, progress: Array) -> Plan:
    """Make a plan of nodes at `time` (n + 1,) s, at hover, that moves as q (n + 1, n_q) does.

    progress: (n + 1, stops); of no stops none is claimed.
    """
    c, w, claimed = case.model.configuration, case.model.velocity, case.scenario.itinerary.claimed
    moving = np.gradient(q, time, axis=0) if c.names == w.names else np.zeros((len(time), len(w.names)))
    return Plan.of(
        case.model, time=time, configuration=q, velocity=moving,
        inputs=np.tile(case.model.hover(), (len(time) - 1, 1)),
        progress=progress if progress.size else np.zeros((len(time), len(claimed))), stop_names=claimed,
    )  # fmt: skip


def over(case: Case, stop: Stop, time: float) -> Array:
    """Configuration (n_q,) with the tool a little above the target at `time`, the nose where it moves to.

    Of a robot that stands somewhere: with the tool at the target, or as near as it comes.
    """
    model = case.model
    start = case.scenario.start_point(model)
    (target,), (way,) = sample(stop.target, np.array([time]))
    if not travels(model):
        return touching(case, target, start)
    above = start.copy()
    names = model.configuration.names
    xyz = [names.index(axis) for axis in AXES]
    hang = model.plant().tool(start, np.zeros(len(model.velocity.names)))[0] - start[xyz]
    above[xyz] = target - hang + [0.0, 0.0, ABOVE]
    if np.hypot(*way[:2]) > 0.0:
        above = space(model).headed(above, float(np.arctan2(way[1], way[0])))
    return above
