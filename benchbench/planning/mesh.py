"""Where a grid is refined: in the intervals in which the replay found the largest errors, and nowhere else."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from benchbench.certificate.certificate import Certificate
from benchbench.certificate.difference import angle, distance, rate, speed
from benchbench.certificate.limited import Limited
from benchbench.certificate.replay import Replay, defects, replay
from benchbench.ground.arrays import Array, Flags
from benchbench.ocp.motion import sample
from benchbench.ocp.plan import Plan
from benchbench.planning.case import Case
from benchbench.planning.findings import ALONG, Step
from benchbench.planning.result import Result
from benchbench.transcription.grid import Grid, Mesh

MARKED = 0.3
"""An interval is halved where its error exceeds this share of what the certificate allows."""
EXCEEDED = 0.4
"""The same for what is exceeded between nodes, where margins are not cheap."""
LEFT = 1 / 8
"""What remains of the defect of an interval of a method of second order that is halved."""
AIM = 0.7
"""Errors that add up are to come down to this share of their limit."""
ALONE = ("defect_", "replay_rate", "replay_position", "replay_angle")
"""Names of checks that are about one interval; the others are about what has added up."""
MOST = 0.75
"""Share of the intervals above which all are halved."""


def marked(plan: Plan, found: Certificate, case: Case) -> Flags:
    """Tell which intervals to halve, (N,); all where most would be."""
    missed = _defects(plan, found, case)
    chosen = np.maximum(missed, _overshoot(plan, found, case)) > MARKED
    beyond = [c.value / c.limit for c in found.broken if not c.name.startswith(ALONE) and c.limit > 0]
    summed = [ratio for ratio in beyond if ratio > 0]  # nothing is a share of an infinite limit
    if summed:
        share = min((1 - AIM / max(summed)) / (1 - LEFT), 1.0)
        largest = np.argsort(-missed)
        enough = int(np.searchsorted(np.cumsum(missed[largest]), share * missed.sum())) + 1
        chosen[largest[:enough]] = True
    return chosen if 0 < chosen.mean() <= MOST else np.ones(plan.intervals, bool)


def exceeded(result: Result, found: Certificate, case: Case, step: Step, corrected: bool) -> Flags:
    """Tell which intervals to cut, (N,), of a plan whose transcription's error is taken off: perhaps none.

    Those in which rates or the room are exceeded, and those in contact, as the step says; and those whose error is still beyond
    its limit after it was taken off, since it changes much from plan to plan there.
    """
    plan = result.plan
    chosen = _overshoot(plan, found, case) > EXCEEDED if step.rates else np.zeros(plan.intervals, bool)
    if corrected:
        chosen |= _defects(plan, found, case) > 1.0
    return np.asarray(chosen | touching(plan)) if step.contacts else np.asarray(chosen)


def _paths(plan: Plan, flight: Replay, case: Case) -> Iterator[Array]:
    """By how much conditions kept along the path are exceeded on the replay, as a share of a cheap margin, (m,) each."""
    plant = case.model.plant()
    for column, name in enumerate(plan.stop_names):
        stop = next((one for one in case.scenario.itinerary.stops if one.name == name), None)
        made = plan.contact(column)
        if stop is None or made is None:
            continue
        place, way = sample(stop.target, flight.time)
        over = np.arange(len(flight.time)) > flight.nodes[made[1]]
        for contact in stop.contacts.values():
            if contact.kept != "in contact":
                gap = contact.gap(plant, flight.configuration, flight.velocity, place, way)
                passed = (gap / contact.limit - 1) / ALONG
                yield np.where(over, 0.0, passed) if contact.kept == "until contact" else passed


def apart(plan: Plan, found: Certificate, case: Case) -> Certificate:
    """Return the certificate with the flight of each interval from its planned state: what is exceeded there is exceeded between nodes.

    The flight of the whole plan adds errors up, which moves rates and places at the nodes, too.
    """
    if found.flight is None or found.flight.broken_at is not None:
        return found
    nodes = range(1, plan.intervals)
    return replace(found, flight=replay(plan, case.model.plant(), restart_nodes=nodes))


def touching(plan: Plan) -> Flags:
    """Tell which intervals are in contact from end to end, (N,)."""
    chosen = np.zeros(plan.intervals, bool)
    for first, last in plan.contacts:
        chosen[first:last] = True
    return chosen


def steady(case: Case) -> bool:
    """Whether limits stay the same along the flight; those that change with the nodes' numbers need equal steps."""
    flown = case.scenario.flown(case.model, 9)
    return all(np.all(limit == limit[0]) for limit in case.scenario.planned_rates_at(case.model, flown))


def halved(grid: Grid, chosen: Flags) -> Mesh:
    """Return the grid with the chosen intervals (N,) cut into two."""
    ends = np.cumsum([0, *(phase.intervals for phase in grid.phases)])
    return {
        phase.name: tuple(np.repeat(phase.steps / (1 + chosen[a:b]), 1 + chosen[a:b].astype(int)).tolist())
        for phase, a, b in zip(grid.phases, ends, ends[1:], strict=False)
    }


def _defects(plan: Plan, found: Certificate, case: Case) -> Array:
    """Largest defect of each interval as a share of its limit, (N,)."""
    limits, missed = case.limits, found.missed or defects(plan, case.model.plant())
    shares = (
        distance(plan, missed.configuration) / limits.defect_position,
        angle(plan, missed.configuration) / limits.defect_angle,
        speed(plan, missed.velocity) / limits.defect_velocity,
        rate(plan, missed.velocity) / limits.defect_rate,
    )
    return np.nan_to_num(np.max(shares, axis=0), nan=np.inf, posinf=1e9)


def _overshoot(plan: Plan, found: Certificate, case: Case) -> Array:
    """By how much limits of rates and of the room are passed in each interval, as a share of what is allowed, (N,)."""
    flight, limits = found.flight, case.limits
    if flight is None or flight.broken_at is not None:
        return np.zeros(plan.intervals)
    rates = np.max(Limited.of(case.model.velocity, flight.velocity).ratio, axis=1) - 1
    room = Limited.of(case.scenario.limits(case.model), flight.configuration)
    allowed = np.where(
        [unit == "m" for unit in room.units], limits.overshoot_position, limits.overshoot_angle
    )
    passed = np.max(room.excess / np.maximum(allowed, limits.node), axis=1)
    worst = np.max(
        [rates / max(limits.rate_ratio - 1, limits.node), passed, *_paths(plan, flight, case)], axis=0
    )
    return np.array([worst[a : b + 1].max() for a, b in zip(flight.nodes, flight.nodes[1:], strict=False)])
