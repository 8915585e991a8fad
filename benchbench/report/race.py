"""The picture of a race: the track in space coloured by speed, and over time everything that is limited."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure, SubFigure
from mpl_toolkits.mplot3d.art3d import Line3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D

from benchbench.certificate.passing import as_passed
from benchbench.certificate.replay import Replay
from benchbench.ground.arrays import Array
from benchbench.ocp.gates import passes
from benchbench.ocp.model import Model
from benchbench.ocp.plan import Plan
from benchbench.ocp.race import Race
from benchbench.ocp.track import Gate, Triple
from benchbench.report.grid import TITLE_IN, Margins
from benchbench.report.panel import draw_panel
from benchbench.report.png import Picture
from benchbench.report.race_panels import race_panels
from benchbench.report.scene import standing_lines
from benchbench.report.style import INK, LIMIT, TARGET, verdict_colour

WIDTH_IN, HEIGHT_IN, HEADER_IN = 14.0, 9.0, 0.75
SPACE, COLOURS = (0.015, 0.08, 0.755, 0.88), (0.9, 0.25, 0.0165, 0.5)
"""Where the track, without its numbers, and the scale of its colours stand: (left, bottom, width, height) as shares of their
half of the page."""
LIMITS = Margins(left=0.62, between_rows=TITLE_IN + 0.08)
VERDICT_LETTERS = 90
SPEEDS = "plasma"
NEAR = 0.01
"""A gate is marked where it is passed with at most this beyond its edge, m."""


@dataclass(frozen=True)
class DrawnFlight:
    """What is drawn: planned positions (N + 1, 3) m; the path in straight pieces (m, 2, 3) m and its speeds (m,) m/s.

    Where the replay starts again, the piece starts at the planned state.
    """

    race: Race
    planned: Array
    pieces: Array
    speed: Array


def race_figure(
    race: Race, plan: Plan, model: Model, replay: Replay | None, title: str, verdict: str
) -> Figure:
    """Lay the page out."""
    race = as_passed(plan, race, NEAR)
    figure = Picture(figsize=(WIDTH_IN, HEIGHT_IN), facecolor="white")
    shares = [HEADER_IN, HEIGHT_IN - HEADER_IN]
    header, body = figure.subfigures(2, 1, height_ratios=shares, squeeze=False, hspace=0)[:, 0]
    left, right = body.subfigures(1, 2, width_ratios=[1.35, 1], squeeze=False, wspace=0)[0]
    _header(header, plan, race, title, verdict)
    space: Axes3D = left.add_axes(SPACE, projection="3d")
    colours = _track(space, _flight(plan, race, replay))
    _fit(left, space)
    left.colorbar(colours, cax=left.add_axes(COLOURS), label="speed [m/s]")
    _limits(right, plan, race, model, replay)
    return figure


def _flight(plan: Plan, race: Race, replay: Replay | None) -> DrawnFlight:
    flown = plan if replay is None else replay
    position, planned = flown.configuration[:, :3], plan.configuration[:, :3]
    speed = np.linalg.norm(flown.velocity[:, :3], axis=1)
    pieces = np.stack([position[:-1], position[1:]], axis=1)
    if replay is not None:
        again = list(replay.restarts)
        pieces[replay.nodes[again], 0] = planned[again]
    return DrawnFlight(race, planned, pieces, (speed[:-1] + speed[1:]) / 2)


def _header(figure: SubFigure, plan: Plan, race: Race, title: str, verdict: str) -> None:
    count = len(race.goals) - 1
    gates = f"{count} gate{'s' if count > 1 else ''} and the end"
    text = f"travel time {plan.travel_time:.3f} s   |   {gates}"
    figure.text(
        0.008, 0.92, textwrap.shorten(title, 72, placeholder=" ..."), fontsize=14, fontweight="bold", va="top"
    )
    figure.text(0.008, 0.35, text, fontsize=11, va="top", color=INK)
    look = {
        "boxstyle": "round,pad=0.45",
        "facecolor": verdict_colour(verdict),
        "edgecolor": "none",
    }
    said = textwrap.shorten(verdict, VERDICT_LETTERS, placeholder=" ...")
    figure.text(
        0.988, 0.9, said, fontsize=11, fontweight="bold", va="top", ha="right", color="white", bbox=look
    )  # fmt: skip


def _limits(figure: SubFigure, plan: Plan, race: Race, model: Model, replay: Replay | None) -> None:
    """Panels over time, with a line where a gate is passed."""
    panels = race_panels(race, plan, model, replay)
    flown = plan if replay is None else replay
    found = passes(flown.time, flown.configuration[:, :3], race.goals, NEAR)
    shares = [1.0 if panel.unit in ("m", "m/s") else 1.3 for panel in panels]
    place = LIMITS.grid(figure, len(panels), 1)
    column = figure.subplots(len(panels), 1, sharex=True, height_ratios=shares, gridspec_kw=place)
    for axes, panel in zip(column, panels, strict=True):
        draw_panel(axes, panel, (), plan.travel_time)
        for mark in (one.time for one in found if one.inside):
            axes.axvline(mark, color=TARGET, linewidth=0.8, alpha=0.6, zorder=1)
    column[-1].set_xlabel("time [s]; dots: planned, lines: flown; vertical: gates; dashed: limits")


def _track(axes: Axes3D, flight: DrawnFlight) -> Line3DCollection:
    """Draw it, return what has the colours."""
    norm = Normalize(0.0, float(np.nanmax(flight.speed)))
    lines = Line3DCollection(list(flight.pieces), cmap=SPEEDS, norm=norm, linewidth=2.4, clip_on=False)
    lines.set_array(flight.speed)
    axes.add_collection3d(lines)
    axes.plot(*flight.planned.T, ".", color=INK, markersize=1.5, alpha=0.6)
    gates, start = flight.race.goals, flight.race.start_position
    for gate in gates:
        _gate(axes, gate)
    obstacles = standing_lines(flight.race.obstacles.items())
    for line in obstacles.values():
        axes.plot(*line.T, color=LIMIT, linewidth=1.0)
    axes.scatter(*start, color=INK, s=18)
    for (x, y, z), names in _labels(gates, start).items():
        axes.text(x, y, z + 0.55, ", ".join(names), color=INK, fontsize=9, ha="center")
    points = np.array(
        [
            start,
            *(gate.position for gate in gates),
            *flight.planned,
            *flight.pieces[:, 1],
            *(p for line in obstacles.values() for p in line),
        ]
    )
    low, high = np.nanmin(points, axis=0) - 0.5, np.nanmax(points, axis=0) + 0.5
    low[2] = min(low[2], 0.0)
    shadow = flight.pieces * (1.0, 1.0, 0.0) + (0.0, 0.0, low[2])
    axes.add_collection3d(Line3DCollection(list(shadow), color=INK, alpha=0.18, linewidth=1.2))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low, zoom=1.15)
    axes.locator_params(axis="z", nbins=4)
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    axes.view_init(elev=32, azim=-62)
    return lines


def _fit(figure: SubFigure, axes: Axes3D) -> None:
    """Make the track's box fill SPACE: seen as it is, it stands somewhere in the square that its axes take."""
    size = figure.bbox.size
    left, bottom, width, height = np.array(SPACE) * [*size, *size]
    limits = (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())
    corners = np.array([[x, y, z, 1.0] for x in limits[0] for y in limits[1] for z in limits[2]])
    seen = corners @ axes.get_proj().T
    low, high = (seen[:, :2] / seen[:, 3:]).min(axis=0), (seen[:, :2] / seen[:, 3:]).max(axis=0)
    (x0, x1), (y0, y1) = axes.viewLim.intervalx, axes.viewLim.intervaly
    side = min(width * (x1 - x0) / (high[0] - low[0]), height * (y1 - y0) / (high[1] - low[1]))
    middle = ((low + high) / 2 - (x0, y0)) / (x1 - x0, y1 - y0)
    corner = np.array([left + width / 2, bottom + height / 2]) - side * middle
    axes.set_position((*(corner / size), *(side / size)))


def _labels(gates: Sequence[Gate], start: Triple) -> dict[Triple, list[str]]:
    """What is written at each place; a gate of several laps has several numbers."""
    labels: dict[Triple, list[str]] = {}
    for number, gate in enumerate(gates, 1):
        labels.setdefault(gate.position, []).append("end" if number == len(gates) else str(number))
    labels.setdefault(start, []).append("start")
    return labels


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
