"""A predictor: from where a target was seen to how it will move."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ocp.motion import Motion


@dataclass(frozen=True)
class Seen:
    """What was seen of a target, oldest first, one every `EYE` s; noise included.

    time      (n,) s, counted from the beginning of the plan that is to be made, so below 0
    position  (n, 3) m, of the ball's top, world
    heading   (n,) rad, level direction in which the target points; it points where it moves, NaN before it ever moved
    """

    time: Array
    position: Array
    heading: Array


class Predictor(ABC):
    """Tells how a target moves on."""

    @abstractmethod
    def predict(self, seen: Seen) -> Motion | None:
        """Return its motion, with time counted as `seen` counts it; None where the scenario's own is right.

        All motions that one predictor returns are of one kind: they differ in their parameters.
        """
