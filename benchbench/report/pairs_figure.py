"""Two folders of runs against each other, a dot for each task: travel time, and what it cost."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchbench.analysis.pairs import Row
from benchbench.analysis.suite import cpu
from benchbench.report.png import Picture
from benchbench.report.style import CURVES, FAINT, RC

BOTH, ONE = CURVES[:2]


def pairs_figure(pairs: Sequence[tuple[Row, Row]], names: tuple[str, str]) -> Figure:
    """Return the figure; names: of the two sides."""
    with mpl.rc_context(RC):
        figure = Picture(figsize=(9.0, 4.6), facecolor="white", layout="constrained")
        times, costs = figure.subplots(1, 2)
        _dots(
            times,
            "Travel time [s]",
            [(a["travel_time_s"], b["travel_time_s"], _certified(a, b)) for a, b in pairs],
        )
        _dots(costs, "CPU: build, solve, check [s]", [(cpu(a), cpu(b), _certified(a, b)) for a, b in pairs])
        costs.loglog()
        for axes in (times, costs):
            axes.set(xlabel=names[0], ylabel=names[1])
        times.legend(frameon=False, fontsize=8, loc="upper left")
        return figure


def _certified(one: Row, other: Row) -> bool:
    return one["certified"] is True and other["certified"] is True


def _dots(axes: Axes, title: str, found: Sequence[tuple[float | None, float | None, bool]]) -> None:
    axes.set_title(title)
    for wanted, colour, mark, label in ((True, BOTH, "o", "both certified"), (False, ONE, "x", "not both")):
        dots = np.array([(a, b) for a, b, both in found if both is wanted and a and b and np.isfinite(a + b)])
        if len(dots):
            axes.plot(*dots.T, mark, color=colour, markersize=5, alpha=0.8, label=label)
    shown = [value for a, b, _ in found if a and b and np.isfinite(a + b) for value in (a, b)]
    ends = np.array([min(shown), max(shown)]) * (0.95, 1.05) if shown else np.array([0.1, 1.0])
    axes.plot(ends, ends, color=FAINT, linewidth=0.8, zorder=1)
    axes.set(xlim=ends, ylim=ends)
