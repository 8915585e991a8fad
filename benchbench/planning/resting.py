"""Targets that come to rest: a contact is made while its target moves, with the nose along its way, or once it stands.

What is asked of the nose ends with a jump where the target stands, which no derivative sees; a flight that is best made just
after it is hardly found from the side where it is asked. So both sides are solved on the coarse grid, each smooth.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchbench.ocp.contact import SLOW, still
from benchbench.ocp.motion import Motion, sample
from benchbench.planning.case import Case

SAMPLES = 301
"""Times at which a target is looked at; the step in which it comes to rest is looked at again as closely."""
LOOKS = 4
"""From 30 s down to a nanosecond."""


def once_they_rest(case: Case) -> Case | None:
    """Return the case in which contacts wait until their targets stand; None where no target comes to rest, or nothing changes.

    Only contacts that ask where the nose points wait. A plan of this case is one of the original.
    """
    latest = case.scenario.travel_time[1]
    asked = [s for s in case.scenario.itinerary.stops if len(still(s.contacts)) < len(s.contacts)]
    found = {stop.name: rest for stop in asked if (rest := at_rest_from(stop.target, latest)) is not None}
    return replace(case, resting=found) if found else None


def at_rest_from(motion: Motion, latest: float) -> float | None:
    """Return from when on a target stands, s; None where it always does, or still moves at `latest`."""
    low, high = 0.0, latest
    for _ in range(LOOKS):
        times = np.linspace(low, high, SAMPLES)
        moving = np.flatnonzero(np.linalg.norm(sample(motion, times)[1][:, :2], axis=1) > SLOW)
        if not len(moving) or moving[-1] == SAMPLES - 1:
            return None
        low, high = times[moving[-1]], times[moving[-1] + 1]
    return float(high)
