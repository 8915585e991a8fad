"""Does each interval, flown from its planned state, arrive where the plan says?"""

from __future__ import annotations

import numpy as np

from benchbench.certificate import advice
from benchbench.certificate.check import Checks, at_most, worst
from benchbench.certificate.difference import angle, distance, rate, speed
from benchbench.certificate.evidence import Evidence
from benchbench.ground.arrays import Array


def defect_position(evidence: Evidence) -> Checks:
    """Check the position at the end of each interval."""
    missed, limit = evidence.missed.configuration, evidence.limits.defect_position
    return _defect(evidence, "position", distance(evidence.plan, missed), limit, "m")


def defect_angle(evidence: Evidence) -> Checks:
    """Check the angles at the end of each interval."""
    missed, limit = evidence.missed.configuration, evidence.limits.defect_angle
    return _defect(evidence, "angle", angle(evidence.plan, missed), limit, "rad")


def defect_velocity(evidence: Evidence) -> Checks:
    """Check the velocity at the end of each interval: a plan may not change its speed without the thrust for it."""
    value, (k,) = worst(speed(evidence.plan, evidence.missed.velocity))
    what = "jump of the planned velocity beside what its inputs fly"
    return _jump(evidence, "velocity", what, value, k, evidence.limits.defect_velocity, "m/s")


def defect_rate(evidence: Evidence) -> Checks:
    """Check the rates at the end of each interval, those of attitude and of joints."""
    missed = evidence.missed.velocity
    value, (k,) = worst(rate(evidence.plan, missed))
    turning = [i for i, unit in enumerate(evidence.plan.velocity_units) if unit == "rad/s"]
    which = evidence.plan.velocity_names[turning[worst(np.abs(missed[k, turning]))[1][0]]] if turning else ""
    what = f"jump of the planned rate of '{which}' beside what its inputs fly"
    return _jump(evidence, "rate", what, value, k, evidence.limits.defect_rate, "rad/s")


def _jump(evidence: Evidence, kind: str, what: str, value: float, k: int, limit: float, unit: str) -> Checks:
    where = f" at the end of interval {k} (t={evidence.plan.time[k + 1]:.3f} s)"
    yield at_most(f"defect_{kind}", what, value, limit, unit, where, advice=advice.FINER)


def _defect(evidence: Evidence, kind: str, missed: Array, limit: float, unit: str) -> Checks:
    value, (k,) = worst(missed)
    what, where = f"{kind} defect of one interval", f" in interval {k} (t={evidence.plan.time[k]:.3f} s)"
    yield at_most(f"defect_{kind}", what, value, limit, unit, where, advice=advice.FINER)
