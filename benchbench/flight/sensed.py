"""What passes between sensors, controller and autopilot."""

from __future__ import annotations

from dataclasses import dataclass

from benchbench.ground.arrays import Array

Triple = tuple[float, float, float]


@dataclass(slots=True)
class Sensed:
    """What a controller is told.

    time      s, when it was so; older than now by the delay
    state     (15,) as `Truth.state`, with noise
    attached  the magnet's contact switch
    """

    time: float
    state: Array
    attached: bool


@dataclass(slots=True)
class Command:
    """What autopilot and servo are told, until the next.

    time    s, when it was given
    thrust  N, of all motors
    rates   rad/s, body rates at that time; spin: rad/s^2, by which they are to change
    torque  N m, body torques that the plan, and a payload, need by themselves
    arm     rad, rad/s, N m: angle at that time, rate, torque
    """

    time: float
    thrust: float
    rates: Triple
    spin: Triple
    torque: Triple
    arm: Triple
