"""What the pictures show of a plan in space: the vehicle's poses, targets, and what stands in the room."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import singledispatch

import numpy as np

from benchbench.certificate.passing import as_passed
from benchbench.certificate.replay import Replay
from benchbench.ground.arrays import Array
from benchbench.ocp.contact import Contact, Standing
from benchbench.ocp.model import Model
from benchbench.ocp.motion import sample
from benchbench.ocp.plan import Plan
from benchbench.ocp.race import Race
from benchbench.ocp.scenario import Scenario
from benchbench.ocp.touching import TouchingModel
from benchbench.report.contact_window import contact_windows
from benchbench.report.gates import outlines
from benchbench.report.style import LIMIT, TARGET

POSES = 16
"""How many poses are drawn besides start, end and contact."""
FLAT_M = 0.02
"""Sideways motion (m) below which a plan is drawn in the x-z plane only."""
SIDE, TOP = (0, 2), (0, 1)
"""The two world axes of each view, 0 for x, 1 for y, 2 for z."""


@dataclass(frozen=True)
class Marks:
    """What stands in the room all the time: outlines (n, 3) m, by what is written there, and their name in a legend.

    coloured: what matters is how fast the vehicle is where, so its path has the colours of its speed.
    forbidden: nothing to fly to, but what may not be touched; drawn as limits are, not as targets.
    """

    name: str = ""
    outlines: Mapping[str, Array] = field(default_factory=dict)
    coloured: bool = False
    forbidden: bool = False


@dataclass(frozen=True)
class Scene:
    """A plan with what the views need.

    End effector and the target of each stop at the nodes, each (N + 1, 3) m, and the end effector on the replay
    (m, 3) m.
    """

    plan: Plan
    model: Model
    tool: Array
    targets: Mapping[str, Array]
    flown: Array | None
    truth: Array | None = None
    """Of the flight that was recorded: time s, end effector and ball m, (m, 7)."""
    marks: Marks = field(default_factory=Marks)
    obstacles: Marks = field(default_factory=Marks)
    space: tuple[Array, Array] = (np.full(3, -np.inf), np.full(3, np.inf))
    """Limits of the vehicle's position (x, y, z), m, infinite where there are none: floor, ceiling, walls."""

    @property
    def standing(self) -> tuple[tuple[str, str, Array], ...]:
        """All outlines, each with what is written there and its colour."""
        both = (self.marks, self.obstacles)
        return tuple(
            (label, LIMIT if of.forbidden else TARGET, line)
            for of in both
            for label, line in of.outlines.items()
        )

    @property
    def speed(self) -> Array:
        """Speed of the vehicle at the nodes, (N + 1,) m/s."""
        return np.asarray(np.linalg.norm(self.plan.velocity[:, :3], axis=1))

    @property
    def sideways(self) -> bool:
        """Whether anything moves in y."""
        return bool(np.ptp(np.concatenate([self.tool, *self.targets.values()])[:, 1]) > FLAT_M)

    @property
    def planes(self) -> tuple[tuple[int, int], ...]:
        """Views that show a motion: the top one alone where nothing of the robot has a height, the side one where it has."""
        level = np.ptp(np.concatenate([*self.bodies, *self.targets.values()])[:, 2]) < FLAT_M
        return (TOP,) if level and self.sideways else (SIDE, TOP) if self.sideways else (SIDE,)

    @property
    def bodies(self) -> list[Array]:
        """The end effector's path, and the robot wherever it is drawn."""
        nodes = [0, *self.pose_nodes, *self.contact_nodes]
        return [self.tool, *(line for k in nodes for line in skeleton(self, k).values())]

    @property
    def extent(self) -> Array:
        """Size (3,) m of all that is drawn, with room for labels."""
        drawn = np.concatenate([*self.bodies, *self.targets.values(), *self.obstacles.outlines.values()])
        return np.asarray((np.nanmax(drawn, axis=0) - np.nanmin(drawn, axis=0)) * (1.06, 1.15, 1.35) + 1e-3)

    @property
    def contact_nodes(self) -> list[int]:
        """All nodes claimed to be in contact."""
        return [k for first, last in contact_windows(self.plan) for k in range(first, last + 1)]

    @property
    def contact_poses(self) -> list[int]:
        """First, middle and last node of each contact: all of a long one would be a blot."""
        return sorted({k for a, b in contact_windows(self.plan) for k in (a, (a + b) // 2, b)})

    @property
    def pose_nodes(self) -> list[int]:
        """Nodes at about equal times at which the vehicle is drawn, those beside a contact left out."""
        times = np.linspace(0.0, self.plan.travel_time, POSES + 2)
        nodes = np.unique(np.abs(self.plan.time[None, :] - times[:, None]).argmin(axis=1))
        apart = times[1] / 2
        contact = self.plan.time[self.contact_nodes]
        return [int(k) for k in nodes if np.all(np.abs(contact - self.plan.time[k]) > apart)]


def scene(
    plan: Plan, scenario: Scenario, model: Model, replay: Replay | None, truth: Array | None = None
) -> Scene:
    """Evaluate what the views draw; truth: of the flight that was recorded, as in `Scene`."""
    plant = model.plant()
    tool, _ = plant.tool(plan.configuration, plan.velocity)
    flown = None if replay is None else plant.tool(replay.configuration, replay.velocity)[0]
    targets = {stop.name: sample(stop.target, plan.time)[0] for stop in scenario.itinerary.stops}
    touched = model.surroundings if isinstance(model, TouchingModel) else {}
    obstacles = Marks("obstacles", {**standing_lines(scenario.obstacles.items()), **touched}, forbidden=True)
    limits = scenario.limits(model)
    bounds = {name: pair for name, *pair in zip(limits.names, limits.lower, limits.upper, strict=True)}
    low, high = np.array([bounds.get(name, (-np.inf, np.inf)) for name in "xyz"]).T
    return Scene(plan, model, tool, targets, flown, truth, marks(scenario, plan), obstacles, (low, high))


@singledispatch
def marks(scenario: Scenario, plan: Plan) -> Marks:
    """Return what stands in the room, by kind of scenario; unless it says otherwise, what its contacts are about."""
    contacts = {
        id(one): (name, one) for stop in scenario.itinerary.stops for name, one in stop.contacts.items()
    }
    found = standing_lines(contacts.values())
    return Marks("obstacles" if found else "", found, forbidden=True)


def standing_lines(contacts: Iterable[tuple[str, Contact]]) -> dict[str, Array]:
    """Lines of those that stand in the room, by their own label, else by the name of the contact."""
    return {
        f"{name} {label}" if label else name: line
        for name, one in contacts
        if isinstance(one, Standing)
        for label, line in one.outlines().items()
    }


@marks.register
def _(scenario: Race, plan: Plan) -> Marks:
    return Marks("gates", outlines(as_passed(plan, scenario, 0.0).goals), coloured=True)


def skeleton(scene: Scene, node: int) -> dict[str, Array]:
    """Lines of the vehicle at a node."""
    return scene.model.plant().skeleton(scene.plan.configuration[node])
