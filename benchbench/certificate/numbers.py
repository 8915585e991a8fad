"""Numbers of the record that say something about every flight."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchbench.certificate.difference import angle, distance
from benchbench.certificate.evidence import Evidence


def flown(evidence: Evidence) -> dict[str, Any]:
    """Errors of the replay and how far rates are used, by column of the record."""
    plan, missed = evidence.plan, evidence.missed.configuration
    found = {
        "replay_defect_position_m": distance(plan, missed),
        "replay_defect_angle_rad": angle(plan, missed),
        "replay_drift_position_m": distance(plan, evidence.drift),
        "max_rate_ratio": evidence.rates.ratio,
    }
    return {name: float(np.max(values)) for name, values in found.items()}
