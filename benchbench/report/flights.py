"""The picture of many flights of one plan: paths, distance to the target, errors, and how the ball was met (paper Figs. 16 to 21)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from benchbench.flight.campaign import Flown
from benchbench.flight.limits import FlightLimits
from benchbench.flight.reference import Reference, entry, matrices, tip
from benchbench.ground.arrays import Array
from benchbench.ocp.airframe import Airframe
from benchbench.report.png import Picture, write_png
from benchbench.report.style import (
    ARM,
    BAD,
    CONTACT,
    CURVES,
    FAINT,
    FRAME,
    GOOD,
    INK,
    LIMIT,
    RC,
    TARGET,
    TOOL,
)
from benchbench.storage.files import replacing

POSES = 9
"""Of one vehicle along its way, the later the darker."""
THIN: dict[str, Any] = {"linewidth": 0.8, "alpha": 0.55}
SIZE_IN = (14.0, 9.6)
PANELS: list[Any] = [["side", "side", "apart"], ["above", "above", "errors"], ["met", "inputs", "inputs"]]
"""Ways are wide and low: at one scale for both axes they need two columns."""
EVERY = 10
"""Steps of 2 ms over which motor forces are averaged, those of one command: the rate loop's answer to the gyro's noise is a band."""


def draw_flights(
    path: Path, reference: Reference, flown: Sequence[Flown], airframe: Airframe, limits: FlightLimits, title: str
) -> None:  # fmt: skip
    """Write the picture as PNG. Raises BadInput("output", ...) when the file system refuses."""
    with mpl.rc_context(RC), replacing(path) as temporary:
        write_png(flights_figure(reference, flown, airframe, limits, title), temporary)


def flights_figure(
    reference: Reference, flown: Sequence[Flown], airframe: Airframe, limits: FlightLimits, title: str
) -> Figure:
    """Return the figure: six panels, each flight a line, successes and failures in colours of their own."""
    figure = Picture(figsize=SIZE_IN, facecolor="white", layout="constrained")
    axes = figure.subplot_mosaic(PANELS)
    figure.suptitle(title, x=0.01, ha="left", fontsize=11, fontweight="bold", color=INK)
    arm = (airframe.arm_offset, airframe.arm_length)
    planned, _ = tip(reference.state, *arm)
    tips = [tip(one.log.state, *arm)[0] for one in flown]
    _side(axes["side"], reference, flown[0], tips[0], planned, airframe)
    _above(axes["above"], reference, flown, tips, planned)
    _distance(axes["apart"], reference, flown, tips, planned)
    _errors(axes["errors"], reference, flown)
    _met(axes["met"], reference, flown, limits, entry(reference, *arm))
    _inputs(axes["inputs"], reference, flown[0], airframe)
    return figure


def _colour(one: Flown) -> str:
    return GOOD if one.verdict.success else BAD


def _flying(reference: Reference) -> Array:
    """Samples within the plan's own time."""
    return np.asarray((reference.time >= 0) & (reference.time <= reference.travel_time))


def _side(
    axes: Axes, reference: Reference, one: Flown, place: Array, planned: Array, airframe: Airframe
) -> None:
    """The vehicle's poses in x and z, the first flight."""
    axes.set_title(f"Side view, flight {one.number}  [m]")
    inside = _flying(reference)
    axes.plot(
        planned[inside, 0], planned[inside, 2], "--", color=FAINT, linewidth=1.0, label="plan, end effector"
    )
    axes.plot(place[:, 0], place[:, 2], color=TOOL, linewidth=1.0, label="end effector")
    axes.plot(one.log.ball[:, 0], one.log.ball[:, 2], color=TARGET, linewidth=1.0, label="ball")
    if not len(place):
        axes.text(0.5, 0.5, "it was not flown", transform=axes.transAxes, ha="center", color=INK)
        return
    rows = np.unique(
        np.searchsorted(one.log.time, np.linspace(0, reference.travel_time, POSES)).clip(0, len(place) - 1)
    )
    for k, row in enumerate(rows):
        state, fade = one.log.state[row], 0.25 + 0.75 * (k + 1) / len(rows)
        turn = matrices(state[None, 3:7])[0]
        mount = state[:3] + turn @ np.array([0.0, 0.0, -airframe.arm_offset])
        rotors = state[:3] + airframe.rotors @ turn.T
        for pair in (rotors[:2], rotors[2:]):
            axes.plot(pair[:, 0], pair[:, 2], color=FRAME, linewidth=2.0, alpha=fade)
        axes.plot(*np.stack([mount, place[row]])[:, [0, 2]].T, color=ARM, linewidth=1.6, alpha=fade)
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="upper right", frameon=False, fontsize=8)


def _above(
    axes: Axes, reference: Reference, flown: Sequence[Flown], tips: Sequence[Array], planned: Array
) -> None:
    """End effectors in x and y, the target, and where the magnet reaches the ball."""
    axes.set_title("End effector from above  [m]")
    inside = _flying(reference)
    for one, place in zip(flown, tips, strict=True):
        axes.plot(place[:, 0], place[:, 1], color=_colour(one), **THIN)
    axes.plot(planned[inside, 0], planned[inside, 1], "-.", color=INK, linewidth=1.1)
    axes.plot(reference.target[inside, 0], reference.target[inside, 1], "--", color=TARGET, linewidth=1.1)
    row = reference.row(reference.window[0])
    around = np.linspace(0, 2 * np.pi, 60)
    radius = reference.ball_radius + reference.reach
    centre = reference.target[row]
    axes.plot(centre[0] + radius * np.cos(around), centre[1] + radius * np.sin(around), color=CURVES[4])
    axes.set_aspect("equal", adjustable="datalim")
    lines = [
        Line2D([], [], color=INK, linestyle="-."), Line2D([], [], color=GOOD), Line2D([], [], color=BAD),
        Line2D([], [], color=TARGET, linestyle="--"), Line2D([], [], color=CURVES[4]),
    ]  # fmt: skip
    axes.legend(lines, ["plan", "success", "failure", "target", "magnet's reach"], frameon=False, fontsize=8)


def _distance(
    axes: Axes, reference: Reference, flown: Sequence[Flown], tips: Sequence[Array], planned: Array
) -> None:
    """Distance between end effector and the place where the stand holds the ball's top."""
    axes.set_title("End effector to handover position  [m]")
    _window(axes, reference)
    for one, place in zip(flown, tips, strict=True):
        gap = np.linalg.norm(place - one.reference.target[1 : len(place) + 1, :3], axis=1)
        axes.plot(one.log.time, gap, color=_colour(one), **THIN)
    axes.plot(
        reference.time,
        np.linalg.norm(planned - reference.target[:, :3], axis=1),
        "-.",
        color=INK,
        linewidth=1.1,
    )
    axes.axhline(reference.reach, color=CURVES[4], linewidth=1.0, label="magnet's reach")
    axes.legend(frameon=False, fontsize=8)
    axes.set_yscale("log")
    axes.set_xlim(0, reference.travel_time)
    axes.set_xlabel("s")


def _errors(axes: Axes, reference: Reference, flown: Sequence[Flown]) -> None:
    """Position of the vehicle less that of what it followed, which is longer than the plan where a target is predicted."""
    axes.set_title("Tracking error  [mm]")
    _window(axes, reference)
    for one in flown:
        wanted = one.reference.state[1 : len(one.log.time) + 1, :3]
        error = np.linalg.norm(one.log.state[:, :3] - wanted, axis=1)
        axes.plot(one.log.time, 1e3 * error, color=_colour(one), **THIN)
    axes.set_xlim(0, reference.time[-1])
    axes.set_ylim(bottom=0)
    axes.set_xlabel("s")


def _met(
    axes: Axes, reference: Reference, flown: Sequence[Flown], limits: FlightLimits, begins: float
) -> None:
    """First attachment and speed where the magnet begins to act, of each flight; begins: s, when the plan is within reach."""
    axes.set_title("Speed of touch  [m/s] at the first attachment")
    _window(axes, reference)
    marks = [
        axes.axhline(limits.touch_speed, color=LIMIT, linestyle="--", linewidth=1.0, label="limit of speed")
    ]
    if np.isfinite(begins):
        place = begins - limits.early
        marks.append(axes.axvline(place, color=CURVES[4], linewidth=1.0, label="plan within reach"))
    for one in flown:
        axes.plot(
            one.verdict.attached_s, one.verdict.touch_speed, "o", color=_colour(one), markersize=4, alpha=0.7
        )
    axes.margins(x=0.1)
    axes.set_ylim(0, 1.25 * max(axes.get_ylim()[1], limits.touch_speed))
    axes.legend(handles=marks, loc="upper right", ncols=2, frameon=False, fontsize=8)
    axes.set_xlabel("s")


def _inputs(axes: Axes, reference: Reference, one: Flown, airframe: Airframe) -> None:
    """Motor forces of the first flight, asked for in each 20 ms, and the planner's limits."""
    axes.set_title(f"Motor forces asked, flight {one.number}  [N]")
    _window(axes, reference)
    count = len(one.log.motors) // EVERY
    means = one.log.motors[: count * EVERY].reshape(count, EVERY, one.log.motors.shape[1]).mean(axis=1)
    for i, column in enumerate(means.T):
        axes.plot(
            one.log.time[: count * EVERY : EVERY],
            column,
            color=CURVES[i],
            linewidth=1.0,
            label=f"motor {i + 1}",
        )
    for limit in airframe.motor_force:
        axes.axhline(limit, color=LIMIT, linestyle="--", linewidth=1.0)
    axes.set_ylim(top=1.15 * axes.get_ylim()[1])
    axes.legend(handles=axes.lines[: means.shape[1]], loc="upper right", ncols=4, frameon=False, fontsize=8)
    axes.set_xlim(0, reference.time[-1])
    axes.set_xlabel("s")


def _window(axes: Axes, reference: Reference) -> None:
    axes.axvspan(*reference.window, color=CONTACT, alpha=0.25, linewidth=0, label="planned contact")
