"""Targets of handovers: one that is where it shall be met when a vehicle can be there."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, final

from pydantic import AfterValidator, ConfigDict
from pydantic.dataclasses import dataclass

from benchbench.ocp.task_family import AboveZero, AtLeastZero, Between, Draws, Shares, rounded

KINDS = ("braking", "circle", "fixed", "linear")
MOTIONS = "benchbench_plugins.motions"
Triple = tuple[float, float, float]


def _known(shares: Mapping[str, float]) -> Mapping[str, float]:
    if unknown := sorted(set(shares) - set(KINDS)):
        raise ValueError(f"there is no target '{unknown[0]}', only {', '.join(KINDS)}")
    return shares


@final
@dataclass(frozen=True, config=ConfigDict(extra="forbid"))
class Targets:
    """How targets move, all of them level.

    kinds          how often each kind of motion is drawn
    speed_mps      of those that move (a braking one: at first), m/s
    direction_rad  of the motion where the target is met, from the x axis, rad
    radius_m       of circles, m
    brake_s        when a braking target stands, s after the start of the flight
    """

    kinds: Annotated[Shares, AfterValidator(_known)]
    speed_mps: AtLeastZero
    direction_rad: Between
    radius_m: AboveZero
    brake_s: AboveZero

    def draw(self, draws: Draws, name: str, place: Triple, time: float) -> dict[str, Any]:
        """Return a motion, as YAML has it, that is at `place` m at `time` s; a braking one stops there, when it does."""
        kind = draws.one_of(f"{name} kind", self.kinds)
        if kind == "fixed":
            return {"_target_": f"{MOTIONS}.Fixed", "position_m": [rounded(x) for x in place]}
        speed = draws.number(f"{name} speed", self.speed_mps)
        way = draws.number(f"{name} direction", self.direction_rad)
        if kind == "circle":
            return self._circle(draws, name, place, time, speed, way)
        velocity = [rounded(speed * math.cos(way)), rounded(speed * math.sin(way)), 0.0]
        if kind == "linear":
            return {
                "_target_": f"{MOTIONS}.Linear",
                "start_m": _before(place, velocity, time),
                "velocity_mps": velocity,
            }
        stop = draws.number(f"{name} brake", self.brake_s)
        start = _before(place, velocity, stop / 2)
        return {"_target_": f"{MOTIONS}.Braking", "start_m": start, "velocity_mps": velocity, "stop_s": stop}

    def _circle(
        self, draws: Draws, name: str, place: Triple, time: float, speed: float, way: float
    ) -> dict[str, Any]:
        radius = draws.number(f"{name} radius", self.radius_m)
        turn = 1.0 if draws.chance(f"{name} left", 0.5) else -1.0
        rate = rounded(turn * speed / radius)
        there = way - turn * math.pi / 2  # angle on the circle at which the target moves that way
        centre = (place[0] - radius * math.cos(there), place[1] - radius * math.sin(there), place[2])
        return {
            "_target_": f"{MOTIONS}.Circle", "centre_m": [rounded(x) for x in centre], "radius_m": radius,
            "rate_radps": rate, "phase_rad": rounded(math.remainder(there - rate * time, math.tau)),
        }  # fmt: skip


def _before(place: Triple, velocity: list[float], seconds: float) -> list[float]:
    """Where a target was so many seconds before, m."""
    return [rounded(x - v * seconds) for x, v in zip(place, velocity, strict=True)]
