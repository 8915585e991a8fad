"""Numbers of the record that say something about every flight."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchbench.certificate.difference import angle, distance
from benchbench.certificate.evidence import Evidence
from benchbench.ground.arrays import Array


def flown(evidence: Evidence) -> dict[str, Any]:
    """Errors of the replay and how far rates are used, by column of the record."""
    plan, missed = evidence.plan, evidence.missed.configuration
    found = {
        "replay_defect_position_m": _away(evidence, plan.configuration[1:], missed),
        "replay_defect_angle_rad": angle(plan, missed),
        "replay_drift_position_m": _away(evidence, plan.configuration, evidence.drift),
        "max_rate_ratio": evidence.rates.ratio,
    }
    return {name: float(np.max(values)) for name, values in found.items()}


def _away(evidence: Evidence, planned: Array, difference: Array) -> Array:
    """Metres (n,) between configurations (n, n_q) and those that differ so from them; of a robot without a place, its tool's."""
    if "m" in evidence.plan.coordinate_units:
        return distance(evidence.plan, difference)
    still = np.zeros((len(planned), len(evidence.plan.velocity_names)))
    ends = [evidence.plant.tool(q, still)[0] for q in (planned, planned + difference)]
    return np.asarray(np.linalg.norm(ends[1] - ends[0], axis=1))
