"""A plan as it is flown, in real time: the views of its picture, with the vehicle where the replay has it."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from benchbench.certificate.replay import Replay
from benchbench.ground.arrays import Array
from benchbench.ground.errors import Unavailable
from benchbench.ocp.motion import sample
from benchbench.ocp.scenario import Scenario
from benchbench.report.contact_window import contact_windows
from benchbench.report.scene import Scene
from benchbench.report.style import ARM, CONTACT, FRAME, INK, RC, TARGET, TOOL
from benchbench.storage.files import write_bytes

MOVING = (".gif", ".mp4")
WIDTH_IN, DPI = 8.0, 100
HOLD_S = 0.5
"""How long the end is shown."""


@dataclass(frozen=True)
class Frames:
    """What moves, a row a frame: times (n,) s, configurations (n, n_q), and the targets' positions (n, 3) m by stop."""

    time: Array
    configuration: Array
    targets: dict[str, Array]

    @classmethod
    def of(cls, scene: Scene, scenario: Scenario, replay: Replay | None, fps: float) -> Frames:
        """Sample the replay, or the plan where there is none, in real time."""
        flown, end = replay or scene.plan, scene.plan.travel_time
        time = np.append(np.arange(0.0, end, 1 / fps), end)
        columns = [np.interp(time, flown.time, column) for column in flown.configuration.T]
        held = np.concatenate([time, np.full(int(HOLD_S * fps), end)])
        rows = np.minimum(np.arange(len(held)), len(time) - 1)
        targets = {stop.name: sample(stop.target, held)[0] for stop in scenario.itinerary.stops}
        return cls(held, np.stack(columns, axis=1)[rows], targets)


def film(path: Path, scene: Scene, scenario: Scenario, replay: Replay | None, title: str, fps: float) -> None:
    """Write the plan as GIF or MP4, by the file's name, with `fps` frames per second.

    Raises Unavailable for an MP4 without imageio-ffmpeg, BadInput where the file system refuses.
    """
    frames = Frames.of(scene, scenario, replay, fps)
    with mpl.rc_context(RC), tempfile.TemporaryDirectory() as folder:
        made = Path(folder, f"film{path.suffix.lower()}")
        figure, views = _page(scene, title)
        writer = _writer(path.suffix.lower(), fps)
        with writer.saving(figure, str(made), DPI):
            for _ in _shown(figure, views, scene, frames):
                writer.grab_frame()
        write_bytes(path, made.read_bytes())


def _writer(kind: str, fps: float) -> AbstractMovieWriter:
    if kind == ".gif":
        return PillowWriter(fps=fps)  # type: ignore[arg-type]
    try:
        from imageio_ffmpeg import get_ffmpeg_exe
    except ImportError:
        raise Unavailable(
            "video: imageio-ffmpeg is not installed; pip install 'benchbench[video]', or write a .gif"
        ) from None
    mpl.rcParams["animation.ffmpeg_path"] = get_ffmpeg_exe()
    return FFMpegWriter(fps=fps, codec="libx264", extra_args=["-pix_fmt", "yuv420p"])  # type: ignore[arg-type]


def _page(scene: Scene, title: str) -> tuple[Figure, dict[tuple[int, int], Axes]]:
    planes = scene.planes
    heights = [float(scene.extent[upward]) for _, upward in planes]
    share = (WIDTH_IN - 1.0) / float(np.max(scene.extent))
    high = (
        np.ceil((share * sum(heights) + 0.75 * len(planes) + 0.4) * DPI / 2) * 2 / DPI
    )  # even, as video wants it
    figure = Figure(figsize=(WIDTH_IN, high), facecolor="white", layout="constrained")
    figure.suptitle(title, fontsize=11, fontweight="bold", x=0.01, ha="left")
    cells = figure.subplots(len(planes), 1, squeeze=False, height_ratios=heights)[:, 0]
    for axes, plane in zip(cells, planes, strict=True):
        _room(axes, scene, plane)
    cells[0].set_title("0.00 s")
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # laid out once, not for every frame
    return figure, dict(zip(planes, cells, strict=True))


def _room(axes: Axes, scene: Scene, plane: tuple[int, int]) -> None:
    """What stands still: paths, outlines, and the room that all poses take."""
    h, v = plane
    lines = [(TARGET, path) for path in scene.targets.values()]
    for colour, line in (*lines, *((colour, line) for _, colour, line in scene.standing)):
        axes.plot(line[:, h], line[:, v], color=colour, linewidth=1.0, alpha=0.6)
    axes.plot(scene.tool[:, h], scene.tool[:, v], color=TOOL, linewidth=0.8, alpha=0.5)
    plant = scene.model.plant()
    drawn = np.concatenate([line for q in scene.plan.configuration for line in plant.skeleton(q).values()])
    axes.update_datalim(drawn[:, plane])
    axes.autoscale_view()
    axes.set(xlabel=f"{'xyz'[h]} [m]", ylabel=f"{'xyz'[v]} [m]")
    axes.set_aspect("equal", adjustable="datalim")


def _shown(
    figure: Figure, views: dict[tuple[int, int], Axes], scene: Scene, frames: Frames
) -> Iterator[None]:
    """Move everything to one frame after the other."""
    plant, plan = scene.model.plant(), scene.plan
    windows = [(plan.time[first], plan.time[last]) for first, last in contact_windows(plan)]
    moving = {plane: _movable(axes, frames.targets) for plane, axes in views.items()}
    clock = next(iter(views.values())).set_title("")
    for row, (time, q) in enumerate(zip(frames.time, frames.configuration, strict=True)):
        touches = any(start <= time <= end for start, end in windows)
        clock.set_text(f"{time:.2f} s{'   contact' if touches else ''}")
        lines = plant.skeleton(q)
        tool = plant.tool(q[None], np.zeros((1, plan.velocity.shape[1])))[0][0]
        for plane, (vehicle, tip, halo, targets) in moving.items():
            vehicle.set_segments([points[:, plane] for points in lines.values()])
            vehicle.set_color([ARM if "arm" in name else FRAME for name in lines])
            for point in (tip, halo):
                point.set_data(*tool[list(plane), None])
            halo.set_visible(touches)
            for name, square in targets.items():
                square.set_data(*frames.targets[name][row, list(plane), None])
        yield


def _movable(
    axes: Axes, targets: Sequence[str] | dict[str, Array]
) -> tuple[LineCollection, Any, Any, dict[str, Any]]:
    vehicle = LineCollection([], linewidths=2.6, capstyle="round", zorder=6)
    axes.add_collection(vehicle, autolim=False)
    (halo,) = axes.plot([], [], "o", color=CONTACT, markersize=30, alpha=0.4, markeredgewidth=0, zorder=1)
    (tip,) = axes.plot(
        [], [], "o", color=TOOL, markersize=6, markeredgecolor=INK, markeredgewidth=0.4, zorder=7
    )
    squares = {name: axes.plot([], [], "s", color=TARGET, markersize=8, zorder=5)[0] for name in targets}
    return vehicle, tip, halo, squares
