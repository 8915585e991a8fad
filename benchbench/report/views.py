"""The vehicle in space: side view x-z and top view x-y, as in the paper's Fig. 8 and 10."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from benchbench.ground.arrays import Array
from benchbench.ocp.model import travels
from benchbench.report.contact_window import stop_windows
from benchbench.report.grid import NUMBERS_IN, TICKS_IN, label_axes
from benchbench.report.scene import SIDE, TOP, Scene, skeleton
from benchbench.report.style import ARM, CONTACT, FRAME, INK, LIMIT, TARGET, TOOL

FAR_M = 1e3
"""Beyond any picture, m."""
VIEWS = {SIDE: "Side view", TOP: "Top view"}
"""Their titles. Numbers along x stand below the lower one."""
LABEL_M = 0.17
"""About half the width (m) of a time label."""


def draw_view(axes: Axes, scene: Scene, plane: tuple[int, int]) -> None:
    """Draw one projection; `plane` are the two world axes, 0 for x, 1 for y, 2 for z."""
    h, v = plane
    axes.set_title(VIEWS[plane], y=1.0)
    for target in scene.targets.values():
        axes.plot(target[:, h], target[:, v], color=TARGET, linewidth=1.4, zorder=2)
    for _, colour, outline in scene.standing:
        axes.plot(outline[:, h], outline[:, v], color=colour, linewidth=1.4, zorder=2)
    axes.plot(scene.tool[:, h], scene.tool[:, v], color=TOOL, linewidth=1.8, zorder=2)
    if scene.flown is not None:
        # An artist, unlike a plot, leaves the axis limits alone: a replay that runs away must not set the scale.
        axes.add_artist(Line2D(scene.flown[:, h], scene.flown[:, v], color=INK, linewidth=0.7, zorder=3))
    axes.update_datalim(np.concatenate(scene.bodies)[:, plane])
    _draw_space(axes, scene, plane)
    _draw_poses(axes, scene, scene.pose_nodes, plane, strong=False)
    _draw_poses(axes, scene, scene.contact_poses, plane, strong=True)
    _draw_target(axes, scene, plane)
    axes.set_xlabel(f"{'xyz'[h]} [m]")
    axes.set_ylabel(f"{'xyz'[v]} [m]")
    label_axes(axes, 0.08 if plane != scene.planes[-1] else TICKS_IN, NUMBERS_IN)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.03, 0.12)


def _draw_space(axes: Axes, scene: Scene, plane: tuple[int, int]) -> None:
    """Lines beyond which the vehicle may not be, shaded behind; artists leave the axis limits alone, so far ones are not seen."""
    for bounds, beyond in zip(scene.space, (-FAR_M, FAR_M), strict=True):
        for across, axis in enumerate(plane):
            level = float(bounds[axis])
            if np.isfinite(level):
                corner, size = [-FAR_M, -FAR_M], [2 * FAR_M, 2 * FAR_M]
                corner[across], size[across] = min(level, level + beyond), FAR_M
                look: dict[str, Any] = {"facecolor": LIMIT, "alpha": 0.12, "edgecolor": "none", "zorder": 0.5}
                axes.add_artist(Rectangle((corner[0], corner[1]), size[0], size[1], **look))
                ends = np.array([[-FAR_M, FAR_M], [level, level]])
                x, y = ends if across else ends[::-1]
                axes.add_artist(Line2D(x, y, color=LIMIT, linewidth=1.1, linestyle=(0, (4, 3)), zorder=1.5))


def label_times(axes: Axes, scene: Scene, plane: tuple[int, int]) -> None:
    """Write the time at start, contact and end above all poses drawn there; of a robot that stays in its place, above its hand."""
    h, v = plane
    names = scene.plan.stop_names
    first_contacts = {
        first: names[stop].replace("_", " ") if len(names) > 1 else "contact"
        for stop, first, _ in stop_windows(scene.plan)
    }
    ends = [0, scene.plan.intervals]
    nodes = [*ends, *scene.pose_nodes, *scene.contact_nodes]
    drawn = np.concatenate([line for k in nodes for line in skeleton(scene, k).values()])
    labels: dict[tuple[float, float], list[int]] = {}
    for node in dict.fromkeys([*first_contacts, *ends]):
        place, top = scene.tool[node, [h, v]]
        if travels(scene.model):
            place = np.concatenate(list(skeleton(scene, node).values())).mean(axis=0)[h]
            top = drawn[np.abs(drawn[:, h] - place) < LABEL_M][:, v].max()
        labels.setdefault((round(float(place), 3), round(float(top), 3)), []).append(node)
    for anchor, at in labels.items():
        contact = any(node in first_contacts for node in at)
        axes.annotate(
            ", ".join(f"{first_contacts.get(node, '')} {scene.plan.time[node]:.2f} s".strip() for node in at), anchor,
            xytext=(0, 6), textcoords="offset points", ha="center", va="bottom",
            fontsize=9, fontweight="bold" if contact else "normal", color=INK, zorder=8,
        )  # fmt: skip


def legend_handles(targets: bool, obstacles: bool = False) -> list[Line2D]:
    """Keys of what the views show; `targets`, `obstacles`: whether there are any."""
    target = Line2D([], [], color=TARGET, linewidth=1.4, marker="s", markersize=5, label="target")
    return [
        Line2D([], [], color=FRAME, linewidth=2.2, label="vehicle"),
        Line2D([], [], color=ARM, linewidth=2.2, label="arm"),
        Line2D([], [], color=TOOL, linewidth=1.2, marker="o", markersize=5, label="end effector"),
        *([target] if targets else []),
        *([Line2D([], [], color=LIMIT, linewidth=1.4, label="obstacle")] if obstacles else []),
    ]


def _draw_poses(axes: Axes, scene: Scene, nodes: Sequence[int], plane: tuple[int, int], strong: bool) -> None:
    alpha, width, order = (1.0, 2.6, 6) if strong else (0.5, 1.4, 4)
    drawn = [(name, points) for node in nodes for name, points in skeleton(scene, node).items()]
    lines = LineCollection(
        [points[:, plane] for _, points in drawn], colors=[ARM if "arm" in name else FRAME for name, _ in drawn],
        linewidths=width, alpha=alpha, zorder=order, capstyle="round",
    )  # fmt: skip
    axes.add_collection(lines)
    axes.plot(
        *scene.tool[list(nodes)][:, plane].T, "o", color=TOOL, markersize=6 if strong else 4,
        markeredgecolor="white", markeredgewidth=0.5, alpha=1.0 if strong else 0.8, zorder=order + 1,
    )  # fmt: skip


def _draw_target(axes: Axes, scene: Scene, plane: tuple[int, int]) -> None:
    """Small squares where the targets are when a pose is drawn, large ones at contact."""
    for target in scene.targets.values():
        _squares(axes, target[scene.pose_nodes], plane, 4.0, 0.5)
    for stop, first, last in stop_windows(scene.plan):
        touched = scene.targets[scene.plan.stop_names[stop]][first : last + 1]
        _squares(axes, touched, plane, 9.0, 1.0)
        h, v = (touched[:, axis].mean() for axis in plane)
        axes.plot(h, v, "o", color=CONTACT, markersize=30, alpha=0.3, markeredgewidth=0, zorder=1)


def _squares(axes: Axes, points: Array, plane: tuple[int, int], size: float, alpha: float) -> None:
    h, v = plane
    axes.plot(
        points[:, h],
        points[:, v],
        "s",
        color=TARGET,
        markersize=size,
        alpha=alpha,
        markeredgewidth=0,
        zorder=5,
    )
