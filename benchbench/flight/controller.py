"""A controller: from what is sensed to what autopilot and servo are told, fifty times a second."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

from benchbench.flight.payload import Weighing
from benchbench.flight.reference import Reference
from benchbench.flight.residual import Correction
from benchbench.flight.rig import Rig
from benchbench.flight.sensed import Command, Sensed
from benchbench.ocp.airframe import Airframe

PERIOD = 0.02
"""s, from one command to the next."""


@dataclass(frozen=True)
class Known:
    """What a controller knows of its vehicle and task; nothing of what is different in the world.

    before  the step of the same controller that followed another reference until now, None at first: what it remembers goes on
    """

    reference: Reference
    airframe: Airframe
    rig: Rig
    before: Callable[[Sensed, float], Command] | None = None


class Controller(ABC):
    """Follows a reference."""

    @abstractmethod
    def prepare(
        self, known: Known, correction: Correction, weighing: Weighing
    ) -> Callable[[Sensed, float], Command]:
        """Return a step, called every `PERIOD` s with what is sensed and the time now.

        It tells the correction of each acceleration it did not expect, and adds to its model what the correction predicts.
        """
