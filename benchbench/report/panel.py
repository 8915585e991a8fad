"""One small plot over time: planned nodes as dots, replay as a line, limits dashed, contact shaded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.offsetbox import AnchoredOffsetbox, HPacker, TextArea

from benchbench.ground.arrays import Array
from benchbench.report.grid import TICKS_IN, label_axes
from benchbench.report.style import CONTACT, CURVES, INK, LIMIT

Points = tuple[Array, Array]
"""Times (n,) in s and values (n,)."""

PERIOD = 12.0
"""Length of the dashes of curves that coincide, in line widths."""
COINCIDE, MOST = 0.01, 0.5
"""Curves coincide where they are nearer than this share of the panel's height for more than that share of the time."""


@dataclass(frozen=True)
class Band:
    """Limits that change: times (m,) s and both limits (m,)."""

    time: Array
    lower: Array
    upper: Array


@dataclass(frozen=True)
class Curve:
    """One quantity: what is planned at nodes (dots), how it runs in between (line), its limits (may be infinite).

    Where limits change, `band` says how, and `lower`, `upper` are the widest.
    """

    label: str
    dots: Points | None
    line: Points
    lower: float
    upper: float
    band: Band | None = None


@dataclass(frozen=True)
class Panel:
    """Curves of one unit; `logarithmic` for gaps, which matter most where they are small; a `note` at the right."""

    title: str
    unit: str
    curves: tuple[Curve, ...]
    logarithmic: bool = False
    note: str = ""


def dashes(panel: Panel, period: float) -> list[tuple[float, float] | None]:
    """Return on and off lengths for each curve that lies on others, None for a solid line.

    Those that coincide take turns: the first is solid, each later one covers less of the period, so that all colours are seen.
    """
    groups: list[list[int]] = []
    low, high = span(panel)
    for i, curve in enumerate(panel.curves):
        same = (
            group for group in groups if _coincide(panel.curves[group[0]], curve, COINCIDE * (high - low))
        )
        group = next(same, None)
        if group is None:
            groups.append([i])
        else:
            group.append(i)
    found: list[tuple[float, float] | None] = [None] * len(panel.curves)
    for group in groups:
        for place, i in enumerate(group[1:], 1):
            on = period * (len(group) - place) / len(group)
            found[i] = (on, period - on)
    return found


def _coincide(one: Curve, other: Curve, near: float) -> bool:
    """Whether a curve is drawn over another one for most of its time."""
    if one.line[1].shape != other.line[1].shape:
        return False
    return bool(np.mean(np.abs(one.line[1] - other.line[1]) < near) > MOST)


def draw_panel(axes: Axes, panel: Panel, windows: Sequence[tuple[float, float]], travel_time: float) -> None:
    """Draw a panel; `windows` are the times (s) in contact."""
    axes.set_title(f"{panel.title}  [{panel.unit}]", y=1.0)  # y given: not looked for above the ticks
    shade(axes, windows)
    for curve, color, dash in zip(panel.curves, _colors(panel), dashes(panel, PERIOD), strict=True):
        axes.plot(*curve.line, color=color, linewidth=1.1, zorder=3, linestyle=(0, dash) if dash else "-")
        if curve.dots is not None:
            size = np.clip(150 / len(curve.dots[0]), 2.5, 5.5)
            axes.plot(*curve.dots, ".", color=color, markersize=size, markeredgewidth=0, zorder=3)
    _draw_limits(axes, panel)
    _label_curves(axes, panel)
    axes.set_xlim(0.0, travel_time)
    label_axes(axes, TICKS_IN)
    _zoom(axes, panel)


def shade(axes: Axes, windows: Sequence[tuple[float, float]]) -> None:
    """Mark the contact windows; the edge keeps very short ones visible."""
    for start, end in windows:
        axes.axvspan(start, end, facecolor=CONTACT, edgecolor=CONTACT, linewidth=1.6, alpha=0.35, zorder=1)


def _colors(panel: Panel) -> list[str]:
    return [CURVES[i % len(CURVES)] for i in range(len(panel.curves))]


def _draw_limits(axes: Axes, panel: Panel) -> None:
    """One grey line where all curves share a limit, lines in the colours of the curves where they differ."""
    limits = [(curve.lower, curve.upper) for curve in panel.curves]
    shared = len(set(limits)) == 1
    for curve, pair, color in zip(panel.curves, limits, _colors(panel), strict=True):
        look: dict[str, Any] = {
            "color": LIMIT if shared else color, "linewidth": 1.1, "linestyle": (0, (4, 3)), "zorder": 4
        }  # fmt: skip
        if curve.band is not None:
            for limit in (curve.band.lower, curve.band.upper):
                axes.plot(curve.band.time, limit, **look)
        else:
            for level in filter(np.isfinite, pair):
                axes.axhline(level, **look)
        if shared:
            return


def _label_curves(axes: Axes, panel: Panel) -> None:
    """Names in the colours of their curves (or the note), above the plot, where they hide nothing."""
    labels = [
        (curve.label.replace("_", " "), color)
        for curve, color in zip(panel.curves, _colors(panel), strict=True)
    ]
    if len(labels) == 1:
        labels = [(panel.note, INK)]
    texts: list[Artist] = [
        TextArea(text, textprops={"color": color, "fontsize": 8}) for text, color in labels
    ]
    row = HPacker(children=texts, align="baseline", pad=0, sep=6)
    box = AnchoredOffsetbox(
        "lower right", child=row, pad=0.25, borderpad=0.1, frameon=False,
        bbox_to_anchor=(1.0, 1.0), bbox_transform=axes.transAxes,
    )  # fmt: skip
    axes.add_artist(box)


def _zoom(axes: Axes, panel: Panel) -> None:
    axes.set_ylim(span(panel))
    if panel.logarithmic:  # zeros stay at the lower edge
        axes.set_yscale("log", nonpositive="clip", subs=(2, 5))


def span(panel: Panel) -> tuple[float, float]:
    """Range that shows plan and limits whole; a replay that runs away may leave the plot."""
    planned = np.concatenate([(curve.dots or curve.line)[1] for curve in panel.curves])
    limits = [limit for curve in panel.curves for limit in (curve.lower, curve.upper)]
    shown = np.concatenate([planned, limits])
    low, high = np.min(shown[np.isfinite(shown)]), np.max(shown[np.isfinite(shown)])
    if panel.logarithmic:
        return min(curve.upper for curve in panel.curves) / 20, float(2 * high)
    replayed = np.clip(np.concatenate([curve.line[1] for curve in panel.curves]), *_stretch(low, high, 0.3))
    low, high = np.nanmin([low, *replayed]), np.nanmax([high, *replayed])
    return _stretch(low, high, 0.08)


def _stretch(low: float, high: float, share: float) -> tuple[float, float]:
    more = share * (high - low) or 1.0
    return low - more, high + more
