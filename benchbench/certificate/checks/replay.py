"""What the dense open-loop replay does: limits between the nodes, and the end."""

from __future__ import annotations

import numpy as np

from benchbench.certificate import advice
from benchbench.certificate.check import BEYOND, Check, Checks, at_most, worst
from benchbench.certificate.difference import angle, distance
from benchbench.certificate.evidence import Evidence

TIMES = "times its limit"


def breakdown(evidence: Evidence) -> Check:
    """Say that the replay could not be flown to its end."""
    at = evidence.flight.broken_at
    reason = f"the replay diverges or cannot be integrated any further at t={at:.3f} s"
    return Check("replay_complete", at or 0.0, np.inf, "s", False, reason, advice.FINER)


def replay_position(evidence: Evidence) -> Checks:
    """Check positions between the nodes."""
    return _room(evidence, "position", "m", evidence.limits.overshoot_position)


def replay_angle(evidence: Evidence) -> Checks:
    """Check angles between the nodes."""
    return _room(evidence, "angle", "rad", evidence.limits.overshoot_angle)


def replay_rate(evidence: Evidence) -> Checks:
    """Check rates between the nodes."""
    value, (k, i) = worst(evidence.rates.ratio)
    what = f"rate of '{evidence.rates.names[i]}'"
    yield at_most(
        "replay_rate", what, value, evidence.limits.rate_ratio, TIMES, evidence.at(k), advice=advice.RATE
    )


def replay_end(evidence: Evidence) -> Checks:
    """Check that the replay ends at the end, upright as asked and at rest."""
    plan, limits = evidence.plan, evidence.limits
    missed = evidence.flight.configuration[-1:] - evidence.scenario.end_point(evidence.model)
    what, value = "distance from the end on the replay", float(distance(plan, missed)[0])
    yield at_most("replay_end", what, value, limits.end_position, "m", advice=advice.FINER)
    what, value = "angle from the end on the replay", float(angle(plan, missed)[0])
    yield at_most("replay_end_angle", what, value, limits.end_angle, "rad", advice=advice.FINER)
    value, (i,) = worst(evidence.rates.ratio[-1])
    what = f"rate of '{evidence.rates.names[i]}' at the end of the replay"
    yield at_most("replay_end_rest", what, value, limits.end_velocity_ratio, TIMES, advice=advice.FINER)


def _room(evidence: Evidence, kind: str, unit: str, limit: float) -> Checks:
    room = evidence.room
    mine = [i for i, u in enumerate(room.units) if u == unit]
    if mine:
        value, (k, i) = worst(room.excess[:, mine])
        what = f"'{room.names[mine[i]]}'"
        yield at_most(f"replay_{kind}", what, value, limit, unit, evidence.at(k), BEYOND, advice=advice.FINER)
