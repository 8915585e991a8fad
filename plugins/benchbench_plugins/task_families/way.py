"""The straight way of a handover from start to end, and places beside it."""

from __future__ import annotations

import math
from typing import Any, final

from pydantic import ConfigDict
from pydantic.dataclasses import dataclass

from benchbench.ocp.scenario import Positive
from benchbench.ocp.task_family import AtLeastZero, Between, Draws, rounded

Triple = tuple[float, float, float]


@final
@dataclass(frozen=True, config=ConfigDict(extra="forbid"))
class Way:
    """Where a flight starts and ends, and where targets are met.

    distance_m       over ground from start to end, m
    bearing_rad      direction of the end from the start; the nose points along x at both, rad
    height_m         of the vehicle at start and end, each drawn, m
    aside_m          how far beside the way a target is met, m to the left
    target_height_m  of targets, m
    pace_mps         at which the vehicle is thought to come: when a target is where it is met, m/s
    """

    distance_m: AtLeastZero
    bearing_rad: Between
    height_m: Between
    aside_m: Between
    target_height_m: Between
    pace_mps: Positive

    def ends(self, draws: Draws) -> dict[str, Any]:
        """Return start and end, the start above the origin."""
        distance, bearing = self._straight(draws)
        return {
            "start": {"z": draws.number("start height", self.height_m)},
            "end": {
                "x": rounded(distance * math.cos(bearing)), "y": rounded(distance * math.sin(bearing)),
                "z": draws.number("end height", self.height_m),
            },
        }  # fmt: skip

    def beside(self, draws: Draws, name: str, along: float) -> tuple[Triple, float]:
        """Return a place in m at this share of the way, and when the vehicle may be there, s."""
        distance, bearing = self._straight(draws)
        ahead, aside = along * distance, draws.number(f"{name} aside", self.aside_m)
        cos, sin = math.cos(bearing), math.sin(bearing)
        height = draws.number(f"{name} height", self.target_height_m)
        return (ahead * cos - aside * sin, ahead * sin + aside * cos, height), ahead / self.pace_mps

    def _straight(self, draws: Draws) -> tuple[float, float]:
        return draws.number("distance", self.distance_m), draws.number("bearing", self.bearing_rad)
