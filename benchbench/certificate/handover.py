"""What a flight with stops is asked: ends, limits, dynamics, contacts, order."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchbench.certificate.audit import Audit, ContactEvidence, audit
from benchbench.certificate.certificate import Measures
from benchbench.certificate.check import worst
from benchbench.certificate.checks.contacts import contact_flown, contact_planned
from benchbench.certificate.checks.intervals import (
    defect_angle,
    defect_position,
    defect_rate,
    defect_velocity,
)
from benchbench.certificate.checks.nodes import planned_end, planned_limits, planned_start
from benchbench.certificate.checks.replay import replay_angle, replay_end, replay_position, replay_rate
from benchbench.certificate.checks.stops import stop_choice, stop_order
from benchbench.certificate.difference import distance
from benchbench.certificate.evidence import Given
from benchbench.certificate.examination import Examination, examine
from benchbench.certificate.measured import measured
from benchbench.certificate.numbers import flown
from benchbench.certificate.touch import touch
from benchbench.ocp.contact import Contact, in_words
from benchbench.ocp.handover import Handover
from benchbench.ocp.plan import Plan

PLANNED = (
    planned_start, planned_end, planned_limits, defect_position, defect_angle, defect_velocity, defect_rate,
    contact_planned, stop_choice, stop_order,
)  # fmt: skip
FLOWN = (replay_position, replay_angle, replay_rate, replay_end, contact_flown)


@examine.register
def _handover(scenario: Handover, given: Given) -> Examination[ContactEvidence]:
    found = measured(scenario, given)
    audits = audit(given.plan, found.flight, scenario.itinerary, found.plant, given.limits)
    evidence = ContactEvidence(**vars(found), audits=audits)
    return Examination(
        evidence,
        PLANNED,
        FLOWN,
        Measures(**flown(evidence), **_numbers(evidence), **_touched(evidence, scenario)),
    )


def _numbers(evidence: ContactEvidence) -> dict[str, Any]:
    """Numbers of the record: the end, the whole of all contacts, the shortest of them, the worst gaps."""
    plan, made = evidence.plan, evidence.made
    missed = evidence.flight.configuration[-1:] - evidence.scenario.end_point(evidence.model)
    numbers: dict[str, Any] = {
        "replay_end_error_m": float(distance(plan, missed)[0]),
        "contact_steps": min((one.steps for one in evidence.asked), default=0),
        "stops": tuple(_spoken(plan, one) for one in made),
        "reward_s": sum((one.stop.reward or 0.0 for one in made), 0.0),
    }
    if not made:
        return numbers
    spans = [plan.time[list(one.window or (0, 0))] for one in made]
    numbers |= {
        "contact_start_s": float(spans[0][0]),
        "contact_end_s": float(spans[-1][1]),
        "contact_duration_s": float(min(stop - start for start, stop in spans)),
    }
    gaps = _gaps(made)
    numbers["contact_gaps"] = {name: gap for name, (_, gap) in gaps.items()}
    numbers["contact_gaps_said"] = tuple(in_words(c, gap) for c, gap in gaps.values() if np.isfinite(gap))
    return numbers


def _touched(evidence: ContactEvidence, scenario: Handover) -> dict[str, Any]:
    """How the ball is met, at the stop where that is fastest."""
    found = [touch(evidence, one, scenario.ball_radius, scenario.magnet_reach) for one in evidence.made]
    fastest = max((one for one in found if one is not None), key=lambda one: one.speed, default=None)
    if fastest is None:
        return {}
    return {
        "touch_speed_mps": fastest.speed, "touch_before_s": fastest.before, "passage_m": fastest.passage,
    }  # fmt: skip


def _gaps(made: Sequence[Audit]) -> dict[str, tuple[Contact, float]]:
    """Each contact and its worst gap: in the windows of all stops made; of a path condition all along its path."""
    found: dict[str, tuple[Contact, float]] = {}
    for one in made:
        for name, contact in one.stop.contacts.items():
            replayed = one.replayed[name]
            if contact.kept == "in contact":
                gap = float(replayed[one.worst_replayed(name)])
            else:
                gap = worst(replayed[one.path_samples(contact)])[0]
            before = found[name][1] if name in found else -np.inf
            found[name] = contact, gap if np.isnan(gap) else max(before, gap)
    return found


def _spoken(plan: Plan, one: Audit) -> str:
    first, last = one.window or (0, 0)
    return f"{one.stop.name} {plan.time[first]:.3f} to {plan.time[last]:.3f} s"
