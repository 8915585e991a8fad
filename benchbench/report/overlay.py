"""Two plans in one picture: their paths, and over time everything that has a limit, in a colour each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D

from benchbench.certificate.replay import Replay
from benchbench.ocp.model import Model
from benchbench.ocp.plan import Plan
from benchbench.ocp.scenario import Scenario
from benchbench.report.contact_window import contact_windows
from benchbench.report.panel import Panel, span
from benchbench.report.panels import panels
from benchbench.report.png import Picture
from benchbench.report.scene import Scene, scene, skeleton
from benchbench.report.style import CURVES, LIMIT, RC, TARGET
from benchbench.report.views import VIEWS

COLOURS = CURVES[:2]
"""Blue and vermilion keep apart for red-green blind readers, and as greys."""
STYLES: tuple[Any, Any] = ("-", (0, (5, 1.5)))
WIDTH_IN, ROW_IN, COLUMNS = 14.0, 1.9, 4
LABELS_IN, HIGHEST_IN = 0.8, 7.0
"""What title and labels of a view take, and how high it gets, in."""


@dataclass(frozen=True)
class Side:
    """One of the two plans, and what it is called."""

    name: str
    plan: Plan
    scenario: Scenario
    model: Model
    replay: Replay | None

    def scene(self) -> Scene:
        """Return what its views draw."""
        return scene(self.plan, self.scenario, self.model, self.replay)

    def panels(self) -> dict[str, Panel]:
        """Return what has a limit, by a title that no other has."""
        found = panels(self.scenario, self.plan, self.model, self.replay)
        titles = [panel.title for panel in found]
        return {_title(panel, titles.count(panel.title) > 1): panel for panel in found}


def _title(panel: Panel, several: bool) -> str:
    whose = f" of {', '.join(curve.label for curve in panel.curves)}" if several else ""
    return f"{panel.title}{whose}  [{panel.unit}]"


def overlay(one: Side, other: Side) -> Figure:
    """Return the figure; what only one of them has is drawn, too."""
    with mpl.rc_context(RC):
        scenes, found = [side.scene() for side in (one, other)], [side.panels() for side in (one, other)]
        titles = list(dict.fromkeys([*found[0], *found[1]]))
        planes = [plane for plane in VIEWS if any(plane in scene.planes for scene in scenes)]
        rows = ceil(len(titles) / COLUMNS)
        views = [_height(scenes, plane) for plane in planes]
        heights = [0.55, sum(views), ROW_IN * rows]
        figure = Picture(figsize=(WIDTH_IN, sum(heights)), facecolor="white", layout="constrained")
        header, top, bottom = figure.subfigures(3, 1, height_ratios=heights, squeeze=False)[:, 0]
        _header(header, (one, other))
        for axes, plane in zip(
            top.subplots(len(planes), 1, squeeze=False, sharex=True, height_ratios=views)[:, 0],
            planes,
            strict=True,
        ):
            _paths(axes, scenes, plane)
        _grid(bottom, titles, found, (one, other))
        return figure


def _height(scenes: Sequence[Scene], plane: tuple[int, int]) -> float:
    """Height (in) of a view in which both are drawn to the scale of the width, within reason."""
    wide, high = (max(float(scene.extent[axis]) for scene in scenes) for axis in plane)
    return float(np.clip(LABELS_IN + WIDTH_IN * high / wide, 2.6, HIGHEST_IN))


def _header(figure: SubFigure, sides: Sequence[Side]) -> None:
    keys = [
        Line2D(
            [],
            [],
            color=colour,
            linestyle=style,
            linewidth=2.2,
            label=f"{side.name}: {side.plan.travel_time:.4f} s",
        )
        for side, colour, style in zip(sides, COLOURS, STYLES, strict=True)
    ]
    keys += [
        Line2D([], [], color=TARGET, label="target"),
        Line2D([], [], color=LIMIT, linestyle=(0, (4, 3)), label="limit"),
    ]
    figure.legend(
        handles=keys, loc="center left", ncols=len(keys), frameon=False, fontsize=11, handlelength=3
    )


def _paths(axes: Axes, scenes: Sequence[Scene], plane: tuple[int, int]) -> None:
    h, v = plane
    axes.set_title(VIEWS[plane])
    for shown, colour, style in zip(scenes, COLOURS, STYLES, strict=True):
        lines = [(TARGET, path) for path in shown.targets.values()]
        for mark, line in (*lines, *((mark, line) for _, mark, line in shown.standing)):
            axes.plot(line[:, h], line[:, v], color=mark, linewidth=1.0)
        axes.plot(shown.tool[:, h], shown.tool[:, v], color=colour, linestyle=style, linewidth=1.6)
        inside = shown.tool[shown.contact_nodes]
        axes.plot(inside[:, h], inside[:, v], "o", color=colour, markersize=9, alpha=0.35, markeredgewidth=0)
        for node in (0, *(first for first, _ in contact_windows(shown.plan)), shown.plan.intervals):
            for points in skeleton(shown, node).values():
                axes.plot(points[:, h], points[:, v], color=colour, linewidth=1.2, alpha=0.6)
    axes.set(xlabel=f"{'xyz'[h]} [m]", ylabel=f"{'xyz'[v]} [m]")
    axes.set_aspect("equal", adjustable="datalim")


def _grid(
    figure: SubFigure, titles: Sequence[str], found: Sequence[dict[str, Panel]], sides: Sequence[Side]
) -> None:
    if not titles:
        return
    cells = figure.subplots(ceil(len(titles) / COLUMNS), COLUMNS, squeeze=False).ravel()
    for axes in cells[len(titles) :]:
        axes.set_axis_off()
    end = max(side.plan.travel_time for side in sides)
    for axes, title in zip(cells, titles, strict=False):
        axes.set_title(title)
        axes.set_xlim(0.0, end)
        there = [drawn[title] for drawn in found if title in drawn]
        for drawn, colour, style in zip(found, COLOURS, STYLES, strict=True):
            if title in drawn:
                _curves(axes, drawn[title], colour, style)
        spans = np.array([span(panel) for panel in there])
        axes.set_ylim(spans[:, 0].min(), spans[:, 1].max())
        if all(panel.logarithmic for panel in there):
            axes.set_yscale("log", nonpositive="clip")
    for axes in cells[max(0, len(titles) - COLUMNS) : len(titles)]:
        axes.set_xlabel("time [s]")


def _curves(axes: Axes, panel: Panel, colour: str, style: Any) -> None:
    for curve in panel.curves:
        axes.plot(*curve.line, color=colour, linestyle=style, linewidth=1.0)
        for level in (curve.lower, curve.upper):
            if np.isfinite(level) and curve.band is None:
                axes.axhline(level, color=LIMIT, linewidth=0.9, linestyle=(0, (4, 3)))
