"""A world: what the vehicle really does, moved on one step at a time."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

from benchbench.flight.mismatch import Drawn
from benchbench.flight.reference import Reference
from benchbench.flight.rig import Rig
from benchbench.ground.arrays import Array
from benchbench.ocp.airframe import Airframe

STEP = 0.002
"""s, of a world; autopilots run once in each."""


@dataclass(slots=True)
class Actuators:
    """What motors and servo are told.

    motors  (4,) N
    arm     angle rad, rate rad/s, torque N m: the servo adds its own loop about angle and rate to the torque
    """

    motors: Array
    arm: tuple[float, float, float]


@dataclass(slots=True)
class Truth:
    """What is, after a step.

    time      s, as the plan counts
    state     (15,): position m, quaternion w x y z, arm rad; velocity m/s (world), body rates rad/s, arm rate rad/s
    ball      (6,): position of its centre m, velocity m/s
    attached  the ball touches the magnet
    touched   names of what else the vehicle touches, "" for nothing
    """

    time: float
    state: Array
    ball: Array
    attached: bool
    touched: str


class World(ABC):
    """Moves a vehicle, a ball on a moving stand, and a magnet. Written apart from any planner's model."""

    @abstractmethod
    def prepare(
        self, reference: Reference, airframe: Airframe, rig: Rig, mismatch: Drawn
    ) -> Callable[[Actuators], Truth]:
        """Return a step: a world at rest at the reference's first state, which `STEP` s later tells what is.

        The ball lies on a stand that carries it along the reference's target.
        """
