"""The picture of a race: the track in space coloured by speed, and over time everything that is limited."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from mpl_toolkits.mplot3d.art3d import Line3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D

from benchbench.certificate.gates import passes
from benchbench.certificate.race import as_passed
from benchbench.certificate.replay import Replay
from benchbench.model import Model
from benchbench.plan import Array, Plan, bezier
from benchbench.race.scenario import Race
from benchbench.race.track import Gate
from benchbench.report.style import BAD, CURVES, GOOD, INK, LIMIT, TARGET

WIDTH_IN, HEIGHT_IN = 14.0, 8.2
SPEEDS = "plasma"
RATES = ("wx", "wy", "wz")
NEAR = 0.01
"""A gate is marked where it is passed with at most this beyond its edge, m."""


@dataclass(frozen=True)
class Flight:
    """What is drawn: times (m,) s, positions (m, 3) m, rates (m, n_v + n_y); times at gates."""

    plan: Plan
    race: Race
    model: Model
    time: Array
    position: Array
    velocity: Array
    marks: Array

    @property
    def speed(self) -> Array:
        """Speed in m/s."""
        return np.asarray(np.linalg.norm(self.velocity[:, :3], axis=1))


def race_figure(
    plan: Plan, race: Race, model: Model, replay: Replay | None, title: str, verdict: str
) -> Figure:
    """Lay the page out."""
    flown = plan if replay is None else replay
    race = as_passed(plan, race, NEAR)
    found = passes(flown.time, flown.configuration[:, :3], race.goals, NEAR)
    marks = np.array([one.time for one in found if one.inside])
    rates = np.hstack([flown.velocity, model.plant().output(flown.configuration, flown.velocity)])
    flight = Flight(plan, race, model, flown.time, flown.configuration[:, :3], rates, marks)
    layout = ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.04)
    figure = Figure(figsize=(WIDTH_IN, HEIGHT_IN), layout=layout, facecolor="white")
    header, body = figure.subfigures(2, 1, height_ratios=[0.75, HEIGHT_IN - 0.75], squeeze=False)[:, 0]
    left, right = body.subfigures(1, 2, width_ratios=[1.35, 1], squeeze=False)[0]
    header.text(0.008, 0.92, title, fontsize=17, fontweight="bold", va="top")
    text = f"{race.name}:  travel time {plan.travel_time:.3f} s   |   {len(race.goals) - 1} gates and the end"
    header.text(0.008, 0.35, f"{text}   |   N = {plan.intervals} intervals", fontsize=11, va="top", color=INK)
    box = {
        "boxstyle": "round,pad=0.45",
        "facecolor": GOOD if verdict == "certified" else BAD,
        "edgecolor": "none",
    }
    said = verdict if len(verdict) < 90 else f"{verdict[:87]}..."
    header.text(
        0.988,
        0.9,
        said,
        fontsize=11,
        fontweight="bold",
        va="top",
        ha="right",
        color="white",
        bbox=box,
        wrap=True,
    )
    axes: Axes3D = left.add_subplot(projection="3d")
    _track(axes, flight)
    colours = axes.collections[0]
    left.colorbar(colours, ax=axes, label="speed [m/s]", shrink=0.6, pad=0.06)
    panels = right.subplots(4, 1, sharex=True, height_ratios=[1, 1.3, 1.3, 1])
    _speed(panels[0], flight)
    _forces(panels[1], flight)
    _rates(panels[2], flight)
    _height(panels[3], flight)
    for panel in panels:
        for mark in marks:
            panel.axvline(mark, color=TARGET, linewidth=0.8, alpha=0.6, zorder=1)
        panel.set_xlim(0.0, plan.travel_time)
    panels[-1].set_xlabel("time [s]; vertical lines: gates, dashed: limits")
    return figure


def _track(axes: Axes3D, flight: Flight) -> None:
    pieces = np.stack([flight.position[:-1], flight.position[1:]], axis=1)
    speed = flight.speed
    lines = Line3DCollection(
        list(pieces), cmap=SPEEDS, norm=Normalize(0.0, float(np.max(speed))), linewidth=2.4
    )
    lines.set_array((speed[:-1] + speed[1:]) / 2)
    axes.add_collection3d(lines)
    gates = flight.race.goals
    labels: dict[tuple[float, float, float], list[str]] = {}
    for number, gate in enumerate(gates, 1):
        labels.setdefault(gate.position, []).append("end" if number == len(gates) else str(number))
        _gate(axes, gate)
    labels.setdefault(flight.race.start_position, []).append("start")
    for place, names in labels.items():
        axes.text(place[0], place[1], place[2] + 0.55, ", ".join(names), color=INK, fontsize=9, ha="center")
    axes.scatter(*flight.race.start_position, color=INK, s=18)
    points = np.array([flight.race.start_position, *(gate.position for gate in gates), *flight.position])
    low, high = points.min(axis=0) - 0.5, points.max(axis=0) + 0.5
    low[2] = min(low[2], 0.0)
    axes.plot(flight.position[:, 0], flight.position[:, 1], low[2], color=INK, alpha=0.18, linewidth=1.2)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low)
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    axes.view_init(elev=32, azim=-62)


def _gate(axes: Axes3D, gate: Gate) -> None:
    """A ball, or a rectangle with an arrow in the direction that is asked for."""
    if gate.opening is None:
        _ball(axes, np.array(gate.position), gate.radius)
        return
    frame = np.array([*gate.corners, gate.corners[0]])
    axes.plot(*frame.T, color=TARGET, linewidth=1.6)
    sign = {"along": 1.0, "against": -1.0, "either": 0.0}[gate.opening.direction]
    if sign:
        axes.quiver(
            *gate.position, *(sign * x for x in gate.opening.normal), color=TARGET, length=0.9, linewidth=1.0
        )


def _ball(axes: Axes3D, centre: Array, radius: float) -> None:
    u, v = np.mgrid[0 : 2 * np.pi : 13j, 0 : np.pi : 7j]
    ball = np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)])
    x, y, z = centre[:, None, None] + radius * ball
    axes.plot_wireframe(x, y, z, color=TARGET, linewidth=0.5, alpha=0.8)


def _speed(axes: Axes, flight: Flight) -> None:
    axes.set_title("Speed  [m/s]")
    axes.plot(flight.time, flight.speed, color=INK, linewidth=1.3)
    axes.set_ylim(bottom=0.0)


def _forces(axes: Axes, flight: Flight) -> None:
    plan = flight.plan
    share = np.array([0.0, 1.0])
    time = (plan.time[:-1, None] + np.diff(plan.time)[:, None] * share).ravel()
    force = bezier(plan.input_pieces[:, None], share).reshape(len(time), -1)
    nodes = flight.race.flown(flight.model, len(plan.time))
    low, high = flight.model.input_limits(np.repeat(nodes[:-1], 2))
    axes.set_title(f"Motor forces  [{plan.input_units[0]}]")
    for i in range(force.shape[1]):
        axes.plot(time, force[:, i], color=CURVES[i % len(CURVES)], linewidth=1.1, label=plan.input_names[i])
    for limit in (low[:, 0], high[:, 0]):
        axes.plot(time, limit, color=LIMIT, linewidth=1.2, linestyle=(0, (4, 3)))
    _key(axes)


def _rates(axes: Axes, flight: Flight) -> None:
    names = (*flight.plan.velocity_names, *flight.model.outputs.names)
    node = np.interp(flight.time, flight.plan.time, flight.race.flown(flight.model, len(flight.plan.time)))
    limits = zip(flight.model.velocity_limits(node), flight.model.output_limits(node), strict=True)
    low, high = (np.hstack(pair) for pair in limits)
    axes.set_title("Body rates  [rad/s]")
    for i, name in enumerate(n for n in RATES if n in names):
        column = names.index(name)
        axes.plot(flight.time, flight.velocity[:, column], color=CURVES[i], linewidth=1.1, label=name)
        for limit in (low[:, column], high[:, column]):
            axes.plot(flight.time, limit, color=LIMIT, linewidth=1.0, linestyle=(0, (4, 3)))
    _key(axes)


def _height(axes: Axes, flight: Flight) -> None:
    box = flight.race.limits(flight.model)
    axes.set_title("Height  [m]")
    axes.plot(flight.time, flight.position[:, 2], color=INK, linewidth=1.3)
    if np.isfinite(box.lower[2]):
        axes.axhline(box.lower[2], color=LIMIT, linewidth=1.2, linestyle=(0, (4, 3)))


def _key(axes: Axes) -> None:
    axes.legend(
        loc="lower right", bbox_to_anchor=(1.0, 0.98), ncols=4, frameon=False, fontsize=8, borderpad=0.1
    )
