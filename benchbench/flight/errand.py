"""What a flight is about, by kind of scenario: a ball that is to be taken from a moving stand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch

from benchbench.ground.errors import IncompatibleCase
from benchbench.ocp.handover import Handover
from benchbench.ocp.motion import Motion

ALLOWED = "a handover with one target, or flights=0"


@dataclass(frozen=True)
class Errand:
    """Where the ball's top is, how large the ball is, how far the magnet reaches, how far off the plan may touch (all m)."""

    target: Motion
    ball_radius: float
    reach: float
    farthest: float


@singledispatch
def errand(scenario: object) -> Errand:
    """Return what a scenario sends the vehicle for; each kind that can be flown registers how.

    `@errand.register` on a function whose first parameter has the class of the scenario. Raises IncompatibleCase.
    """
    name = getattr(scenario, "name", type(scenario).__name__)
    raise IncompatibleCase(
        "flights", f"'{name}' has no ball to be taken from a stand, which is what is flown", ALLOWED
    )


@errand.register
def _(scenario: Handover) -> Errand:
    """One target; the contact with the shortest reach says how far off the plan may touch."""
    stops = scenario.itinerary.stops
    if len(stops) != 1:
        raise IncompatibleCase("flights", f"'{scenario.name}' has {len(stops)} targets", ALLOWED)
    reaches = [c.reach for c in stops[0].contacts.values() if c.reach is not None]
    return Errand(stops[0].target, scenario.ball_radius, scenario.magnet_reach, min(reaches, default=0.0))
