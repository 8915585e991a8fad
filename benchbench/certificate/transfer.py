"""What a transfer is asked: ends, limits, dynamics."""

from __future__ import annotations

from benchbench.certificate.certificate import Measures
from benchbench.certificate.checks.intervals import (
    defect_angle,
    defect_position,
    defect_rate,
    defect_velocity,
)
from benchbench.certificate.checks.nodes import planned_end, planned_limits, planned_start
from benchbench.certificate.checks.replay import replay_angle, replay_end, replay_position, replay_rate
from benchbench.certificate.difference import distance
from benchbench.certificate.evidence import Evidence, Given
from benchbench.certificate.examination import Examination, examine
from benchbench.certificate.measured import measured
from benchbench.certificate.numbers import flown
from benchbench.ocp.transfer import Transfer

PLANNED = (
    planned_start, planned_end, planned_limits, defect_position, defect_angle, defect_velocity, defect_rate,
)  # fmt: skip
FLOWN = (replay_position, replay_angle, replay_rate, replay_end)


@examine.register
def _transfer(scenario: Transfer, given: Given) -> Examination[Evidence]:
    evidence = measured(scenario, given)
    missed = float(distance(given.plan, evidence.drift)[-1])
    return Examination(evidence, PLANNED, FLOWN, Measures(**flown(evidence), replay_end_error_m=missed))
