"""Does each interval, flown from its planned state, arrive where the plan says?"""

from __future__ import annotations

from benchbench.arrays import Array
from benchbench.certificate import advice
from benchbench.certificate.check import Checks, at_most, worst
from benchbench.certificate.difference import angle, distance
from benchbench.certificate.evidence import Evidence


def defect_position(evidence: Evidence) -> Checks:
    """Check the position at the end of each interval."""
    missed, limit = evidence.missed.configuration, evidence.limits.defect_position
    return _defect(evidence, "position", distance(evidence.plan, missed), limit, "m")


def defect_angle(evidence: Evidence) -> Checks:
    """Check the angles at the end of each interval."""
    missed, limit = evidence.missed.configuration, evidence.limits.defect_angle
    return _defect(evidence, "angle", angle(evidence.plan, missed), limit, "rad")


def _defect(evidence: Evidence, kind: str, missed: Array, limit: float, unit: str) -> Checks:
    value, (k,) = worst(missed)
    what, where = f"{kind} defect of one interval", f" in interval {k} (t={evidence.plan.time[k]:.3f} s)"
    yield at_most(f"defect_{kind}", what, value, limit, unit, where, advice=advice.FINER)
