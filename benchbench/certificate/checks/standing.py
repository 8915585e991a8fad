"""Are obstacles, which are kept always and ask for no target, kept at the nodes and on the replay?"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from benchbench.certificate import advice
from benchbench.certificate.check import Checks, at_most, worst
from benchbench.certificate.evidence import Evidence
from benchbench.ground.arrays import Array
from benchbench.ocp.contact import Contact


def standing_planned(evidence: Evidence) -> Checks:
    """Check every obstacle at every planned node."""
    plan, slack = evidence.plan, evidence.limits.node
    for name, one, gap in _gaps(evidence, plan.configuration, plan.velocity):
        value, (k,) = worst(gap)
        yield at_most(
            f"obstacle_{name}",
            f"{one.noun} '{name}'",
            value,
            one.limit + slack,
            one.unit,
            f" at node {k}",
            advice=advice.PATH,
        )


def standing_flown(evidence: Evidence) -> Checks:
    """Check it all along the replay."""
    flight, limits = evidence.flight, evidence.limits
    for name, one, gap in _gaps(evidence, flight.configuration, flight.velocity):
        value, (k,) = worst(gap)
        limit = one.limit + max(limits.contact_allowance.get(name, 0.0), limits.node)
        yield at_most(
            f"replay_obstacle_{name}",
            f"{one.noun} '{name}'",
            value,
            limit,
            one.unit,
            evidence.at(k),
            advice=advice.FINER,
        )


def _gaps(evidence: Evidence, q: Array, v: Array) -> Iterator[tuple[str, Contact, Array]]:
    nowhere = np.zeros((len(q), 3))
    for name, one in evidence.scenario.obstacles.items():
        yield name, one, one.gap(evidence.plant, q, v, nowhere, nowhere)
