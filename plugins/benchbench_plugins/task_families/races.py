"""Races through gates that are spread over a hall."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any, final

from pydantic import ConfigDict
from pydantic.dataclasses import dataclass

from benchbench.ground.errors import BadInput
from benchbench.ocp.task_family import AboveZero, Between, Chance, Counts, Draws, TaskFamily, rounded

TRIES = 1000
"""Places that are drawn for a gate before there is none far and near enough."""
Triple = tuple[float, float, float]


@final
@dataclass(frozen=True, config=ConfigDict(extra="forbid"))
class Races(TaskFamily):
    """Gates anywhere in a box, so that turns may be tight; some are rectangles, ask a speed or a heading.

    gates              how many before the end
    x_m, y_m, z_m      the box of start, gates and end, m
    leg_m              from each of them to the next, m
    rectangle          how often a gate is a rectangle, else it is a ball
    radius_m           of balls, m
    width_m, height_m  of rectangles, m; they stand upright
    turned_rad         by how much a rectangle is turned from the way between the gates before and behind it, rad
    speed              how often a gate asks a speed
    speed_mps          m/s that it asks, give or take `speed_off_mps`
    heading            how often a gate asks a heading
    heading_rad        rad from the x axis
    rest               how often the flight ends at rest, else as it likes
    """

    gates: Counts
    x_m: Between
    y_m: Between
    z_m: Between
    leg_m: AboveZero
    rectangle: Chance
    radius_m: AboveZero
    width_m: AboveZero
    height_m: AboveZero
    turned_rad: Between
    speed: Chance
    speed_mps: AboveZero
    speed_off_mps: AboveZero
    heading: Chance
    heading_rad: Between
    rest: Chance

    def draw(self, draws: Draws) -> dict[str, Any]:
        """Return start, end, track and end_velocity; raises BadInput for a box without room for a leg."""
        count = draws.whole("gates", self.gates)
        places = [self._somewhere(draws, "start 0")]
        for number in range(1, count + 1):
            places.append(self._after(draws, f"gate {number}", places[-1]))
        places.append(self._after(draws, "end", places[-1]))
        ends = {name: dict(zip("xyz", places[i], strict=True)) for name, i in (("start", 0), ("end", -1))}
        around = [(one[0], two[1]) for one, two in pairwise(pairwise(places))]
        track = [self._gate(draws, f"gate {i}", places[i], *around[i - 1]) for i in range(1, count + 1)]
        return {**ends, "track": track, "end_velocity": "rest" if draws.chance("rest", self.rest) else "free"}

    def _gate(self, draws: Draws, name: str, place: Triple, before: Triple, behind: Triple) -> dict[str, Any]:
        gate: dict[str, Any] = dict(zip("xyz", place, strict=True))
        if draws.chance(f"{name} rectangle", self.rectangle):
            way = math.atan2(behind[1] - before[1], behind[0] - before[0])
            gate["width"] = draws.number(f"{name} width", self.width_m)
            gate["height"] = draws.number(f"{name} height", self.height_m)
            gate["yaw"] = rounded(
                math.remainder(way + draws.number(f"{name} turned", self.turned_rad), math.tau)
            )
        else:
            gate["radius"] = draws.number(f"{name} radius", self.radius_m)
        if draws.chance(f"{name} asks speed", self.speed):
            speed, off = (
                draws.number(f"{name} {k}", r)
                for k, r in (("speed", self.speed_mps), ("off", self.speed_off_mps))
            )
            gate["speed"] = [rounded(max(speed - off, 0.0)), rounded(speed + off)]
        if draws.chance(f"{name} asks heading", self.heading):
            gate["heading"] = draws.number(f"{name} heading", self.heading_rad)
        return gate

    def _after(self, draws: Draws, name: str, last: Triple) -> Triple:
        """The first of the places drawn that is a leg away from the last."""
        low, high = self.leg_m
        tried = (self._somewhere(draws, f"{name} {i}") for i in range(TRIES))
        found = next((place for place in tried if low <= math.dist(place, last) <= high), None)
        if found is None:
            raise BadInput(
                "scenario.family.leg_m",
                f"no place in the box is {low:g} to {high:g} m from {name}'s neighbour",
                "a larger box, or other legs",
            )
        return found

    def _somewhere(self, draws: Draws, name: str) -> Triple:
        x, y, z = (
            draws.number(f"{name} {axis}", box)
            for axis, box in zip("xyz", (self.x_m, self.y_m, self.z_m), strict=True)
        )
        return x, y, z
