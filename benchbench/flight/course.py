"""What is flown at the moment: one plan to its end, or a plan that is made anew while it is flown."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, final

from benchbench.flight.reference import Reference
from benchbench.flight.sensed import Command, Sensed

Control = Callable[[Sensed, float], Command]


class Course(Protocol):
    """The reference of the whole flight as it is known by now, and who follows it."""

    @property
    def reference(self) -> Reference:
        """What was followed until now, and is from now on."""

    def control(self, now: float) -> Control:
        """Return the controller for a time, asked for before each command; what it costs is not the controller's."""


@final
@dataclass(frozen=True)
class Steady:
    """One plan to its end."""

    reference: Reference
    step: Control

    def control(self, now: float) -> Control:
        """The same at all times."""
        return self.step
