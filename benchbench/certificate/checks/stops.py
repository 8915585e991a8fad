"""Are the stops made that have to be, in the order asked for?"""

from __future__ import annotations

from itertools import pairwise

from benchbench.certificate.audit import ContactEvidence
from benchbench.certificate.check import Check, Checks


def stop_choice(evidence: ContactEvidence) -> Checks:
    """Check that exactly one stop is made where that is asked for."""
    if evidence.scenario.itinerary.visit == "one":
        made = evidence.asked
        names = ", ".join(one.stop.name for one in made) or "none"
        reason = "" if len(made) == 1 else f"exactly one stop is asked for, but the plan claims {names}"
        yield Check("stop_choice", len(made), 1, "stops", len(made) == 1, reason)


def stop_order(evidence: ContactEvidence) -> Checks:
    """Check that stops of a fixed order follow each other."""
    if evidence.scenario.itinerary.order == "free":
        return
    time = evidence.plan.time
    for before, after in pairwise(one for one in evidence.asked if one.window is not None):
        (_, last), (first, _) = before.window or (0, 0), after.window or (0, 0)
        reason = (
            f"'{after.stop.name}' is made from t={time[first]:.3f} s on, before '{before.stop.name}' is over at "
            f"t={time[last]:.3f} s, but the order is fixed"
        )
        yield Check("stop_order", time[first], time[last], "s", last < first, "" if last < first else reason)
