"""The vehicle in space, animated."""

from __future__ import annotations

from typing import Any

import numpy as np
import plotly.graph_objects as go

from benchbench.ground.arrays import Array
from benchbench.report.html.charts.chart import CLEAR, FONT, GRID
from benchbench.report.scene import Scene, skeleton
from benchbench.report.style import ARM, CURVES, FAINT, FRAME, INK, LIMIT, TARGET, TOOL

FRAMES = 60
"""About how many instants are shown; those in contact always are."""
MARGIN_M, FLOOR_M = 0.15, 0.4
"""Room around what is drawn; how far below that the floor is drawn, too."""
ABOVE = (0.0, 0.0, 0.6)
"""Where the number of a gate stands, from its centre, m."""
DIAGONAL, LONGEST = 1.95, 1.5
"""Diagonal of the space and its longest axis, in Plotly's unit; more leaves the picture."""
UNDER_SPACE = {"len": 0.35, "x": 0.5, "xanchor": "center", "y": 0.075, "yanchor": "bottom"}
"""Where the colours of a race are explained: between the buttons and the time."""


def view(scene: Scene) -> go.Figure:
    """Return the 3D view: paths, and the vehicle, end effector and target at the time of the slider.

    Frames are named by their time in s; the traces after the paths move.
    """
    nodes = frame_nodes(scene)
    still = _paths(scene)
    moving = list(range(len(still), len(still) + len(_moving(scene, nodes[0]))))
    frames = [go.Frame(name=_name(scene, k), data=_moving(scene, k), traces=moving) for k in nodes]
    made = go.Figure([*still, *_moving(scene, nodes[0])], frames=frames)
    made.update_layout(
        template="none", scene=_space(scene), font={"family": FONT, "color": INK, "size": 12},
        margin={"l": 0, "r": 0, "t": 0, "b": 0}, height=560, paper_bgcolor=CLEAR, modebar={"bgcolor": CLEAR, "color": FAINT, "activecolor": INK},
        legend={"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 0}, uirevision="keep",
        sliders=[_slider([frame.name for frame in frames])], updatemenus=[_buttons(scene, len(frames))],
    )  # fmt: skip
    return made


def frame_nodes(scene: Scene) -> list[int]:
    """Nodes that are shown: evenly spaced, with both ends and every node in contact."""
    even = np.linspace(0, scene.plan.intervals, min(FRAMES, scene.plan.intervals + 1))
    return sorted({*np.rint(even).astype(int).tolist(), *scene.contact_nodes})


def _name(scene: Scene, node: int) -> str:
    return f"{scene.plan.time[node]:.3f}"


def _paths(scene: Scene) -> list[go.Scatter3d]:
    if scene.marks.coloured:
        return [*_marks(scene), *_floor(scene), _coloured_path(scene)]
    lines = [(f"path of {name}", target, TARGET, 3) for name, target in scene.targets.items()]
    lines.append(("end effector, planned", scene.tool, TOOL, 4))
    if scene.flown is not None:
        lines.append(("end effector, replayed", _inside(scene, scene.flown), INK, 2))
    if scene.truth is not None:
        lines.append(("end effector, in flight", _inside(scene, scene.truth[:, 1:4]), CURVES[4], 4))
    paths = [
        _line(points, color, width, name=name, hoverinfo="skip", showlegend=i >= len(scene.targets))
        for i, (name, points, color, width) in enumerate(lines)
    ]
    return [*paths, *_floor(scene), *(_marks(scene) if scene.standing else [])]


def _marks(scene: Scene) -> list[go.Scatter3d]:
    """Outlines of what stands in the room, and what is written there: of a race the gates and their numbers."""
    lines = [
        _line(outline, colour, 3, name=name, hoverinfo="skip", showlegend=i == 0)
        for name, colour, outlines in _groups(scene)
        for i, outline in enumerate(outlines)
    ]
    x, y, z = _above(scene).astype(np.float32).T
    text = {
        "x": x,
        "y": y,
        "z": z,
        "mode": "text",
        "text": [label for label, _, _ in scene.standing],
        "textfont": {"color": INK},
    }
    return [*lines, go.Scatter3d(**text, hoverinfo="skip", showlegend=False)]


def _groups(scene: Scene) -> list[tuple[str, str, list[Array]]]:
    """Name in the legend, colour and outlines of what may be flown to and of what may not."""
    return [
        (of.name, LIMIT if of.forbidden else TARGET, list(of.outlines.values()))
        for of in (scene.marks, scene.obstacles)
    ]


def _above(scene: Scene) -> Array:
    """Where it is written what stands in the room, (n, 3) m; none where nothing does."""
    middles = [np.nanmean(outline[:-1], axis=0) for _, _, outline in scene.standing]
    return np.reshape(middles, (-1, 3)) + np.array(ABOVE)


def _coloured_path(scene: Scene) -> go.Scatter3d:
    """The path of a race in the colours of its speed."""
    x, y, z = np.asarray(scene.tool, np.float32).T
    speed = scene.speed.astype(np.float32)
    bar = {
        "title": {"text": "m/s", "side": "right"},
        "orientation": "h",
        **UNDER_SPACE,
        "thickness": 8,
        "nticks": 4,
    }
    return go.Scatter3d(
        x=x, y=y, z=z, mode="lines", name="path", showlegend=False, customdata=speed,
        line={"color": speed, "colorscale": "Plasma", "cmin": 0.0, "width": 6, "colorbar": bar, "showscale": True},
        hovertemplate="%{customdata:.2f} m/s at x %{x:.2f}, y %{y:.2f}, z %{z:.2f} m<extra></extra>",
    )  # fmt: skip


def _moving(scene: Scene, node: int) -> list[go.Scatter3d]:
    lines = skeleton(scene, node)
    frame = [points for name, points in lines.items() if "arm" not in name]
    arm = [points for name, points in lines.items() if "arm" in name]
    vehicle = _line(_joined(frame), FRAME, 7, name="vehicle", hoverinfo="skip")
    if scene.marks.coloured:
        return [vehicle]
    return [
        vehicle,
        _line(_joined(arm), ARM, 7, name="arm", hoverinfo="skip"),
        _dot(scene.tool[node], TOOL, "circle", "end effector"),
        *(_dot(target[node], TARGET, "square", name) for name, target in scene.targets.items()),
        *_in_flight(scene, node),
    ]


def _in_flight(scene: Scene, node: int) -> list[go.Scatter3d]:
    """End effector and ball of the flight that was recorded, at the time of a node."""
    if scene.truth is None:
        return []
    now = [
        np.interp(scene.plan.time[node], scene.truth[:, 0], column, right=np.nan)
        for column in scene.truth.T[1:]
    ]
    tool, ball = np.reshape(now, (2, 3))
    return [
        _dot(tool, CURVES[4], "circle", "end effector, in flight").update(
            showlegend=False
        ),  # its path has it
        _dot(ball, TARGET, "circle", "ball's centre, in flight"),
    ]


def _line(points: Array, color: str, width: float, **more: Any) -> go.Scatter3d:
    x, y, z = np.asarray(points, np.float32).T
    return go.Scatter3d(x=x, y=y, z=z, mode="lines", line={"color": color, "width": width}, **more)


def _dot(point: Array, color: str, symbol: str, name: str) -> go.Scatter3d:
    x, y, z = ([float(value)] for value in point)
    return go.Scatter3d(
        x=x, y=y, z=z, mode="markers", name=name, marker={"color": color, "size": 5, "symbol": symbol},
        hovertemplate="x %{x:.3f}, y %{y:.3f}, z %{z:.3f} m<extra>" + name + "</extra>",
    )  # fmt: skip


def _joined(lines: list[Array]) -> Array:
    """Several lines (n, 3) as one, with gaps."""
    gap = np.full((1, 3), np.nan)
    return np.concatenate([part for line in lines for part in (line, gap)] or [gap])


def _inside(scene: Scene, path: Array) -> Array:
    """The path without what lies outside the space that is shown."""
    low, high = _box(scene)
    return np.where(np.all((path >= low) & (path <= high), axis=1, keepdims=True), path, np.nan)


def _floor(scene: Scene) -> list[go.Scatter3d]:
    """The edge of the floor below which the vehicle may not be, where it is near."""
    level = float(scene.space[0][2])
    (x0, y0, bottom), (x1, y1, _) = _box(scene)
    if not bottom <= level:
        return []
    edge = np.array([[x0, y0, level], [x1, y0, level], [x1, y1, level], [x0, y1, level], [x0, y0, level]])
    floor = _line(edge, LIMIT, 3, name="lowest for the vehicle", hoverinfo="skip", showlegend=True)
    floor.line.dash = "dash"
    return [floor]


def _box(scene: Scene) -> tuple[Array, Array]:
    drawn = [scene.tool, *scene.targets.values(), *(line for _, _, line in scene.standing), _above(scene)]
    drawn += [*(p for k in frame_nodes(scene) for p in skeleton(scene, k).values())]
    points = np.concatenate(drawn)
    low, high = np.nanmin(points, axis=0) - MARGIN_M, np.nanmax(points, axis=0) + MARGIN_M
    floor = scene.space[0][2]
    if low[2] - FLOOR_M < floor < high[2]:
        low[2] = min(low[2], floor - 0.01)
    return low, high


def _space(scene: Scene) -> dict[str, Any]:
    low, high = _box(scene)
    ticks = np.maximum(np.rint(7 * (high - low) / np.max(high - low)), 2)
    axes = {
        f"{name}axis": {
            "title": {"text": f"{name} [m]"}, "range": [float(low[i]), float(high[i])], "gridcolor": GRID,
            "backgroundcolor": "#FAFAFA", "showbackground": True, "zeroline": False, "nticks": int(ticks[i]), "color": FAINT,
        }
        for i, name in enumerate("xyz")
    }  # fmt: skip
    size = high - low
    share = size * min(DIAGONAL / np.linalg.norm(size), LONGEST / np.max(size))
    return {
        **axes, "aspectmode": "manual", "aspectratio": dict(zip("xyz", share.tolist(), strict=True)),
        "domain": {"x": [0.0, 1.0], "y": [0.14, 1.0]}, "camera": {"eye": {"x": -0.85, "y": -1.4, "z": 0.75}},
    }  # fmt: skip


def _slider(names: list[str]) -> dict[str, Any]:
    at_once = {"mode": "immediate", "frame": {"duration": 0, "redraw": True}, "transition": {"duration": 0}}
    return {
        "steps": [{"method": "animate", "label": name, "args": [[name], at_once]} for name in names],
        "currentvalue": {"prefix": "t = ", "suffix": " s", "font": {"size": 14, "color": INK}, "xanchor": "right"}, "active": 0,
        "x": 0.0, "len": 1.0, "y": 0.0, "yanchor": "bottom", "pad": {"t": 6, "b": 6, "l": 14, "r": 14}, "ticklen": 0, "minorticklen": 0,
        "font": {"color": "rgba(0,0,0,0)", "size": 1},
    }  # fmt: skip


def _buttons(scene: Scene, frames: int) -> dict[str, Any]:
    """Play in real time, and pause."""
    pace = 1000 * scene.plan.travel_time / max(frames, 1)
    play = {"fromcurrent": True, "frame": {"duration": pace, "redraw": True}, "transition": {"duration": 0}}
    stop = {"mode": "immediate", "frame": {"duration": 0, "redraw": False}, "transition": {"duration": 0}}
    return {
        "type": "buttons", "direction": "left", "showactive": False, "x": 0.0, "xanchor": "left", "y": 0.07,
        "yanchor": "bottom", "pad": {"l": 8},
        "buttons": [
            {"label": "▶", "method": "animate", "args": [None, play]},
            {"label": "❚❚", "method": "animate", "args": [[None], stop]},
        ],
    }  # fmt: skip
