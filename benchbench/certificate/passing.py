"""How a plan passes the gates of a race: in which order, where, and how the replay passes them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchbench.certificate.evidence import Evidence
from benchbench.certificate.limits import Limits
from benchbench.ocp.gates import Pass, passes
from benchbench.ocp.plan import Plan
from benchbench.ocp.race import Race


@dataclass(frozen=True, kw_only=True, eq=False)
class GateEvidence(Evidence):
    """What was measured on a flight through gates: how the replay passes each in order, the end included."""

    scenario: Race
    passes: tuple[Pass, ...]


def as_passed(plan: Plan, race: Race, allowance: float) -> Race:
    """Return the race to judge: where the order is free, that with the order in which the plan passes the gates."""
    if race.order == "fixed":
        return race
    place = plan.configuration[:, :3]
    times = [passes(plan.time, place, (gate,), allowance)[0].time for gate in race.listed]
    return race.flown_in([int(i) + 1 for i in np.argsort(times, kind="stable")])


def gate_nodes(plan: Plan, race: Race, limits: Limits) -> tuple[int, ...]:
    """Nodes nearest to the gates' planned passes, the end left out: where the replay starts again."""
    found = passes(plan.time, plan.configuration[:, :3], race.goals, limits.gate_position)
    nodes = {int(np.argmin(np.abs(plan.time - one.time))) for one in found[:-1] if one.inside}
    return tuple(sorted(k for k in nodes if 0 < k < plan.intervals))
