"""What every way to know the payload must do: nothing before it hangs there, no negative mass, no memory between flights."""

from __future__ import annotations

import numpy as np

from benchbench.conformance.checks.flying import RIG, hanging, vehicle
from benchbench.conformance.checks.require import require
from benchbench.flight.payload import Payload, Weighing
from benchbench.flight.sensed import Command, Sensed

BALL = RIG.ball_mass


def check_empty(payload: Payload) -> None:
    """Nothing is carried while nothing is attached, whatever accelerates the vehicle."""
    weigh = _begun(payload)
    masses = [weigh(_sensed(k, False), _command(), -1.0) for k in range(100)]
    require(not any(masses), f"{max(masses):.3g} kg are carried though nothing is attached")


def check_carried(payload: Payload) -> None:
    """With the ball attached, and a thrust that falls short by its weight, the mass is between nothing and 1.2 balls.

    The shortfall is that of a model which knows the mass that was told last.
    """
    weigh, total = _begun(payload), vehicle().airframe.total_mass
    mass = 0.0
    for k in range(300):
        thrust = (total + mass) * vehicle().airframe.gravity
        along = thrust / (total + BALL) - thrust / (total + mass)
        mass = weigh(_sensed(k, True), _command(thrust), along)
        require(bool(np.isfinite(mass)) and mass >= 0, f"the mass becomes {mass} kg")
    require(mass <= 1.2 * BALL, f"a ball of {BALL} kg weighs {mass:.3g} kg")


def check_lost(payload: Payload) -> None:
    """A ball that has dropped is not carried."""
    weigh = _begun(payload)
    for k in range(100):
        weigh(_sensed(k, True), _command(), -0.3)
    left = weigh(_sensed(101, False), _command(), 0.0)
    require(left == 0.0, f"{left:.3g} kg are carried after the ball has dropped")


def check_fresh(payload: Payload) -> None:
    """What one flight weighed is not known to the next."""
    first = _begun(payload)
    for k in range(100):
        first(_sensed(k, True), _command(), -0.3)
    mass = _begun(payload)(_sensed(0, False), _command(), 0.0)
    require(mass == 0.0, f"a flight begins with {mass:.3g} kg")


CHECKS = (check_empty, check_carried, check_lost, check_fresh)


def _begun(payload: Payload) -> Weighing:
    return payload.prepare(RIG, vehicle().airframe.total_mass)


def _sensed(k: int, attached: bool) -> Sensed:
    return Sensed(0.02 * k, hanging()[0], attached)


def _command(thrust: float = 20.0) -> Command:
    none = (0.0, 0.0, 0.0)
    return Command(0.0, thrust, none, none, none, (np.pi / 2, 0.0, 0.0))
