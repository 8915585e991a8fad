"""The rules for all stops together: which have to be made, in which order, and what was made."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

from benchbench.certificate.audit import Audit
from benchbench.certificate.certificate import Check
from benchbench.ocp.plan import Plan
from benchbench.ocp.stop import Itinerary

MEASURED = (
    ("position", "contact_max_distance_m"),
    ("velocity", "contact_max_speed_gap_mps"),
    ("heading", "contact_max_heading_error_rad"),
)
"""Contacts whose worst gap is recorded, and the column."""


def asked(found: Sequence[Audit], itinerary: Itinerary) -> list[Audit]:
    """Stops whose contact must be long enough: those that have to be made, and those that the plan claims."""
    return [one for one in found if one.claims.any() or not itinerary.may_skip(one.stop)]


def made(plan: Plan, asked: Sequence[Audit], itinerary: Itinerary) -> Iterator[Check]:
    """Check that as many stops are claimed as asked for, and that fixed ones follow each other."""
    if itinerary.visit == "one":
        names = ", ".join(one.stop.name for one in asked) or "none"
        reason = "" if len(asked) == 1 else f"exactly one stop is asked for, but the plan claims {names}"
        yield Check("stop_choice", len(asked), 1, "stops", len(asked) == 1, reason)
    if itinerary.order == "free":
        return
    there = [one for one in asked if one.window is not None]
    for before, after in pairwise(there):
        (_, last), (first, _) = before.window or (0, 0), after.window or (0, 0)
        reason = (
            f"'{after.stop.name}' is made from t={plan.time[first]:.3f} s on, before '{before.stop.name}' is over at "
            f"t={plan.time[last]:.3f} s, but the order is fixed"
        )
        yield Check(
            "stop_order", plan.time[first], plan.time[last], "s", last < first, "" if last < first else reason
        )


def measures(plan: Plan, found: Sequence[Audit], itinerary: Itinerary) -> dict[str, Any]:
    """Numbers of the record: the whole of all contacts, the shortest of them, the worst gaps; stops in order of time."""
    counted = asked(found, itinerary)
    numbers: dict[str, Any] = {"contact_steps": min((one.steps for one in counted), default=0)}
    visited = sorted((one for one in counted if one.window), key=lambda one: one.window or (0, 0))
    numbers["stops"] = tuple(_spoken(plan, one) for one in visited)
    numbers["reward_s"] = sum((one.stop.reward or 0.0 for one in visited), 0.0)
    if not visited:
        return numbers
    spans = [plan.time[list(one.window or (0, 0))] for one in visited]
    numbers |= {
        "contact_start_s": float(spans[0][0]),
        "contact_end_s": float(spans[-1][1]),
        "contact_duration_s": float(min(stop - start for start, stop in spans)),
    }
    for name, key in MEASURED:
        worst = [one.replayed[name][one.worst_replayed(name)] for one in visited if name in one.replayed]
        if worst:
            numbers[key] = float(max(worst))
    return numbers


def _spoken(plan: Plan, one: Audit) -> str:
    first, last = one.window or (0, 0)
    return f"{one.stop.name} {plan.time[first]:.3f} to {plan.time[last]:.3f} s"
