"""The race: fly from the start through ordered gates to the end in least time (paper Sec. IV.A)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Self, final

import numpy as np
from pydantic import model_validator

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.ocp.model import Model
from benchbench.ocp.scenario import Ends, Scenario, at_rest, point
from benchbench.ocp.stop import Itinerary
from benchbench.ocp.track import Gate, Track
from benchbench.ocp.track_file import TRACKS, is_point, read
from benchbench.ocp.values import Finite, RaceValues

AXES = ("x", "y", "z")
HANDOVERS_OWN = (
    "target",
    "stops",
    "visit",
    "contacts",
    "kappa_init",
    "contact_seconds",
    "contact_guess",
    "contact_margin",
    "intervals",
)
"""Fields of a handover: who gives one to a race is told that it means nothing there."""
END_VELOCITIES = "free, rest, [vx, vy, vz] in m/s"
MOST_FREE = 8
"""Gates whose order may be free: 40320 orders."""


@final
class Race(RaceValues, Scenario):
    """Fly from `start` through all gates, in order, to `end` in least time.

    What it has that is a plain value stands in `RaceValues`; besides, it has

    track         gates of one lap: a list, or the path of a YAML or CSV file (see `benchbench.ocp.track_file.read`); what
                  a file says of start, end, radius and gates counts where the scenario leaves it out
    end_velocity  "free"; "rest": exactly at the end, upright and at rest; or [vx, vy, vz] in m/s
    """

    planning: ClassVar[tuple[str, ...]] = (*Scenario.planning, "speed_guess", "gate_margin")

    track: str | Path | tuple[Any, ...]
    end_velocity: str | tuple[Finite, Finite, Finite] = "free"

    @model_validator(mode="before")
    @classmethod
    def _only_what_a_race_has(cls, data: dict[str, Any]) -> dict[str, Any]:
        for name in HANDOVERS_OWN:
            if data.get(name):
                allowed = "nodes_per_gate" if name == "intervals" else "a handover, such as +scenario=circle"
                raise BadInput(f"scenario.{name}", "means nothing in a race", allowed)
        track, velocity = data.get("track", ()), data.get("end_velocity", "free")
        if not isinstance(track, str | Path | Sequence):
            raise BadInput("scenario.track", f"{track!r} was given", TRACKS)
        if not isinstance(velocity, str) and not is_point(velocity):
            raise BadInput("scenario.end_velocity", f"{velocity!r} was given", END_VELOCITIES)
        return {key: value for key, value in data.items() if key not in HANDOVERS_OWN}

    @model_validator(mode="after")
    def _consistent(self) -> Race:
        if isinstance(self.end_velocity, str) and self.end_velocity not in ("free", "rest"):
            raise BadInput("scenario.end_velocity", f"'{self.end_velocity}' was given", END_VELOCITIES)
        self._check_order()
        here = np.array(self.start_position)
        for number, goal in enumerate(self.goals, 1):
            there = np.array(goal.position)
            if np.array_equal(here, there):
                name = "the end" if number == len(self.goals) else f"gate {number}"
                place = ", ".join(f"{x:g}" for x in there)
                before = f"gate {number - 1}" if number > 1 else "the start"
                allowed = (
                    "another number of gates, or another scenario.end" if name == "the end" else "gates apart"
                )
                raise BadInput("scenario.gates", f"{name} is where {before} is, at {place}", allowed)
            here = there
        return self

    def _check_order(self) -> None:
        """Raise BadInput where order and sequence mean nothing on this track."""
        count = len(self.listed)
        if self.sequence and sorted(self.sequence) != list(range(1, count + 1)):
            problem = f"{list(self.sequence)} was given"
            raise BadInput("scenario.sequence", problem, f"each of the numbers 1 to {count} once, or []")
        if self.order == "fixed":
            return
        if count > MOST_FREE:
            problem = f"there are {count} gates, too many to try all orders"
            raise BadInput("scenario.order", problem, f"fixed, or at most {MOST_FREE} gates")
        places = {self.start_position, *(goal.position for goal in self.goals)}
        if len(places) < count + 2:
            raise BadInput("scenario.order", "two of start, gates and end are at one place", "fixed")

    def flown_in(self, sequence: Sequence[int]) -> Race:
        """Return the same race with its gates in a fixed order, numbered as the track lists them."""
        said = {name: getattr(self, name) for name in self.model_fields_set}
        return Race(**{**said, "order": "fixed", "sequence": tuple(sequence)})

    @cached_property
    def course(self) -> Track:
        """The track as it was given."""
        return read(self.track, self.radius, "radius" in self.model_fields_set)

    @cached_property
    def goals(self) -> tuple[Gate, ...]:
        """All gates in order and the end, each a ball."""
        gates = self.listed
        end = Gate(self._position(self.course.end, self.end), self.end_radius or self.radius)
        return (*(gates[i - 1] for i in self.sequence or range(1, len(gates) + 1)), end)

    @cached_property
    def listed(self) -> tuple[Gate, ...]:
        """All gates as the track lists them, laps repeated, without the end."""
        lap = self.course.lap
        return tuple(lap[i % len(lap)] for i in range(self.gates or self.course.gates or len(lap)))

    @property
    def start_position(self) -> tuple[float, float, float]:
        """Where the flight starts, m."""
        return self._position(self.course.start, self.start)

    @property
    def grid_intervals(self) -> int:
        """`nodes_per_gate` for each gate and the end."""
        return self.nodes_per_gate * len(self.goals)

    def on_grid(self, intervals: int) -> Self:
        """Return the same with so many intervals, or as near as the same number for each segment comes."""
        return self.model_copy(update={"nodes_per_gate": max(1, round(intervals / len(self.goals)))})

    @property
    def itinerary(self) -> Itinerary:
        """Nothing is touched; gates are flown through."""
        return Itinerary()

    def start_point(self, model: Model) -> Array:
        """Return the start configuration (n_q,)."""
        return self._placed(point(self.start, model, "scenario.start"), model, self.start_position)

    def end_point(self, model: Model) -> Array:
        """Return the end configuration (n_q,): in the middle of where the flight may end."""
        return self._placed(point(self.end, model, "scenario.end"), model, self.goals[-1].position)

    def ends(self, model: Model) -> Ends:
        """Bounds of the last node; that it is near the end is a condition like that of the gates."""
        box, whole = self.limits(model), np.array([np.sum(self.segments)])
        if self.end_velocity == "rest":
            return at_rest(self.end_point(model), box, model)
        low_v, high_v = (bound[0] for bound in self.planned_rates_at(model, whole))
        if not isinstance(self.end_velocity, str):
            low_v[:3] = high_v[:3] = self.end_velocity
        return Ends(box.lower, box.upper, low_v, high_v)

    def flown(self, model: Model, nodes: int) -> Array:
        """Nominal metres flown at each node, (nodes,): equal numbers of nodes for each straight line between gates."""
        corners = np.concatenate([[0.0], np.cumsum(self.segments)])
        return np.interp(np.linspace(0, len(corners) - 1, nodes), np.arange(len(corners)), corners)

    @property
    def segments(self) -> Array:
        """Distances from each gate to the next, start and end included, (gates + 1,) m."""
        points = np.array([self.start_position, *(goal.position for goal in self.goals)])
        return np.asarray(np.linalg.norm(np.diff(points, axis=0), axis=1))

    def gate_nodes(self) -> tuple[int, ...]:
        """Nodes at which the gates are passed when each segment has `nodes_per_gate` intervals, end included."""
        return tuple(self.nodes_per_gate * (i + 1) for i in range(len(self.goals)))

    def _position(
        self, named: tuple[float, float, float] | None, field: Mapping[str, float]
    ) -> tuple[float, float, float]:
        x, y, z = named if named and not field else (field.get(axis, 0.0) for axis in AXES)
        return x, y, z

    def _placed(self, q: Array, model: Model, position: tuple[float, float, float]) -> Array:
        for axis, value in zip(AXES, position, strict=True):
            if axis in model.configuration.names:
                q[model.configuration.index(axis)] = value
        return q
