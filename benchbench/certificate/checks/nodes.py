"""Ends and limits at the planned nodes, to numeric accuracy."""

from __future__ import annotations

import numpy as np

from benchbench.certificate import advice
from benchbench.certificate.check import BEYOND, Checks, at_most, worst
from benchbench.certificate.evidence import Evidence
from benchbench.ground.arrays import Array

UNIT_LENGTH = 1e-6
"""Largest error of the length of a planned quaternion."""
QUATERNION = ("qw", "qx", "qy", "qz")


def planned_start(evidence: Evidence) -> Checks:
    """Check that the plan starts where, and as fast as, the scenario says."""
    scenario, model = evidence.scenario, evidence.model
    return _end(evidence, "start", 0, scenario.start_point(model), scenario.start_rates(model))


def planned_end(evidence: Evidence) -> Checks:
    """Check that the plan ends where the scenario says, at rest."""
    still = np.zeros(len(evidence.plan.velocity_names))
    return _end(evidence, "end", -1, evidence.scenario.end_point(evidence.model), still)


def planned_quaternion(evidence: Evidence) -> Checks:
    """Check the length of quaternions, where there are any."""
    plan = evidence.plan
    if QUATERNION[0] not in plan.coordinate_names:
        return
    parts = plan.configuration[:, [plan.coordinate_names.index(name) for name in QUATERNION]]
    error, (k,) = worst(np.abs(np.linalg.norm(parts, axis=1) - 1))
    what = "error of a quaternion's length"
    yield at_most(
        "planned_quaternion", what, error, UNIT_LENGTH, "1", f" at node {k}", advice=advice.ACCURACY
    )


def planned_limits(evidence: Evidence) -> Checks:
    """Check what has limits, kind by kind; inputs may have several rows per interval."""
    for kind, of in evidence.planned.items():
        if of.names:
            excess, (k, i) = worst(of.excess)
            what, where = (
                f"planned {kind} '{of.names[i]}'",
                f" {'in row' if kind == 'input' else 'at node'} {k}",
            )
            yield at_most(
                f"planned_{kind}", what, excess, evidence.limits.node, of.units[i], where, BEYOND,
                advice=advice.ACCURACY,
            )  # fmt: skip


def _end(evidence: Evidence, where: str, k: int, point: Array, rate: Array) -> Checks:
    plan, limit = evidence.plan, evidence.limits.node
    gap, (i,) = worst(np.abs(plan.configuration[k] - point))
    what = f"distance of planned '{plan.coordinate_names[i]}' from the {where}"
    yield at_most(f"planned_{where}", what, gap, limit, plan.coordinate_units[i], advice=advice.ACCURACY)
    speed, (i,) = worst(np.abs(plan.velocity[k] - rate))
    beside = " beside the given one" if rate.any() else ""
    what = f"planned rate of '{plan.velocity_names[i]}' at the {where}{beside}"
    yield at_most(f"planned_{where}_rest", what, speed, limit, plan.velocity_units[i], advice=advice.ACCURACY)
