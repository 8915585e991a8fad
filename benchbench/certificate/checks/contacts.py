"""Does every claimed contact hold its conditions, at the nodes and on the replay, and for long enough?"""

from __future__ import annotations

import numpy as np

from benchbench.certificate import advice
from benchbench.certificate.audit import Audit, ContactEvidence, event_contacts, path_contacts
from benchbench.certificate.check import Check, Checks, at_least, at_most, worst
from benchbench.certificate.limits import Limits

ROUNDING = 1e-6
"""Granted when durations and progress indices are added up, s and 1."""


def contact_planned(evidence: ContactEvidence) -> Checks:
    """Check, stop by stop, the nodes that claim contact, path conditions, and how long contact lasts."""
    asked = evidence.asked
    for one in evidence.audits:
        yield from _claims(one, evidence.limits)
        yield from _path(one, evidence.limits)
        if one in asked and any(True for _ in event_contacts(one.stop)):
            yield from _lasting(evidence, one)


def contact_flown(evidence: ContactEvidence) -> Checks:
    """Check the conditions on the replay: all through the window, or along the path."""
    limits = evidence.limits
    for one in evidence.audits:
        stop = one.stop
        for name, contact in event_contacts(stop):
            if one.window is not None:
                k = one.worst_replayed(name)
                gap, where = float(one.replayed[name][k]), evidence.at(k)
                what, limit = f"{contact.noun} in contact{stop.label}", _allowed(name, contact.limit, limits)
                yield at_most(f"contact_{name}", what, gap, limit, contact.unit, where, advice=advice.CONTACT)
        for name, contact in path_contacts(stop):
            asked = one.path_samples(contact)
            if not asked.any():
                continue
            gap, (k,) = worst(one.replayed[name][asked])
            limit, what = _allowed(name, contact.limit, limits), contact.noun + stop.label
            yield at_most(
                f"replay_path_{name}", what, gap, limit, contact.unit, evidence.at(k), advice=advice.FINER
            )


def _claims(one: Audit, limits: Limits) -> Checks:
    """Every node that claims contact is in contact."""
    if not one.claims.any():
        return
    for name, contact in event_contacts(one.stop):
        k = one.worst_planned(name)
        gap, limit = float(one.planned[name][k]), contact.limit + limits.node
        reason = (
            f"node {k} claims contact{one.stop.label} with epsilon {one.progress[k]:.3g} but its "
            f"{contact.noun} is {gap:.6g} {contact.unit}, allowed {contact.limit:.6g} {contact.unit}"
        )
        ok = gap <= limit
        yield Check(
            f"contact_node_{name}",
            gap,
            limit,
            contact.unit,
            ok,
            "" if ok else reason,
            advice.SHARPEN_OR_GUESS,
        )


def _path(one: Audit, limits: Limits) -> Checks:
    """Path conditions hold at every node up to where they end."""
    for name, contact in path_contacts(one.stop):
        asked = one.path_nodes(contact)
        if not asked.any():
            continue
        gap, (k,) = worst(one.planned[name][asked])
        what, limit = contact.noun + one.stop.label, contact.limit + limits.node
        yield at_most(f"path_{name}", what, gap, limit, contact.unit, f" at node {k}", advice=advice.PATH)


def _lasting(evidence: ContactEvidence, one: Audit) -> Checks:
    """Enough nodes in a row, enough progress in them, enough seconds.

    The certificate asks for kappa_init nodes of the scenario's own grid: on a finer one as many nodes are less.
    """
    plan, limits, stop = evidence.plan, evidence.limits, one.stop
    required, what = stop.kappa_init, f"the longest contact{stop.label} that holds every condition"
    yield at_least("contact_steps", what, one.steps, required, "nodes", advice=advice.PHASES_OR_SHARPEN)
    first, last = one.window or (0, -1)
    hidden = limits.contact_claim * len(plan.time) + ROUNDING
    total = float(np.sum(one.progress[first : last + 1]))
    made = f"the progress made in that contact{stop.label}"
    yield at_least("contact_progress", made, total, required, "1", hidden, advice=advice.PHASES_OR_RELAXATION)
    steps, grid = stop.steps(plan.intervals)
    asked = stop.contact_seconds if stop.contact_seconds is not None else steps * plan.travel_time / grid
    if asked:
        seconds = float(plan.time[last] - plan.time[first]) if one.window else 0.0
        yield at_least("contact_seconds", what, seconds, asked, "s", ROUNDING, advice=advice.SECONDS)


def _allowed(name: str, limit: float, limits: Limits) -> float:
    return limit + max(limits.contact_allowance.get(name, 0.0), limits.node)
