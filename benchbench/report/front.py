"""The picture of a front: what success costs in travel time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes

from benchbench.analysis.front import Candidate, fastest, front, proves
from benchbench.report.png import Picture, write_png
from benchbench.report.style import BAD, FAINT, FRAME, GOOD, INK, LIMIT, RC
from benchbench.storage.files import replacing

SIZE_IN = (8.5, 5.0)
HEADING = "bars: 95 % Wilson interval; filled: proves what is asked; line: no other plan is faster and better"


def draw_front(
    path: Path, found: Sequence[Candidate], target: float, title: str, name: Callable[[Candidate], str]
) -> None:
    """Write the picture as PNG: each candidate with its Wilson interval, those that prove the target filled, the front as steps.

    name: what the fastest that proves it is called. Raises BadInput("output", ...) when the file system refuses.
    """
    with mpl.rc_context(RC), replacing(path) as temporary:
        figure = Picture(figsize=SIZE_IN, facecolor="white", layout="constrained")
        axes = figure.subplots()
        figure.suptitle(title, x=0.01, ha="left", fontsize=11, fontweight="bold", color=INK)
        best = front(found)
        for one in found:
            _point(axes, one, proves(one, target), one in best)
        axes.plot(
            [one.travel_time for one in best], [100 * one.rate for one in best], color=FRAME, drawstyle="steps-post",
            linewidth=1.2, zorder=0,
        )  # fmt: skip
        axes.axhline(100 * target, color=LIMIT, linestyle="--", linewidth=0.8)
        axes.annotate(f"{100 * target:g} % asked", (0.005, 100 * target), xycoords=("axes fraction", "data"),
                      ha="left", va="bottom", fontsize=8, color=LIMIT)  # fmt: skip
        if chosen := fastest(found, target):
            _name(axes, chosen, name(chosen))
        axes.set(xlabel="travel time of the certified plan [s]", ylim=(-3, 106))
        axes.set_ylabel("flights that succeed [%]")
        axes.set_title(HEADING, fontsize=9)
        write_png(figure, temporary)


def _point(axes: Axes, one: Candidate, proved: bool, best: bool) -> None:
    """One candidate; those that another beats are smaller."""
    whole = one.whole
    low, high = whole.low, whole.high
    axes.plot([one.travel_time] * 2, [100 * low, 100 * high], color=FAINT, linewidth=0.8, zorder=1)
    axes.plot(
        one.travel_time, 100 * one.rate, "o" if proved else "s", color=GOOD if proved else BAD,
        markerfacecolor=GOOD if proved else "white", markersize=7 if best else 4,
    )  # fmt: skip


def _name(axes: Axes, one: Candidate, said: str) -> None:
    """Where no front goes: slow plans that seldom succeed."""
    there = f", {one.again.succeeded} of {one.again.flights} in other worlds" if one.again else ""
    axes.annotate(
        f"{one.travel_time:.3f} s, {one.succeeded} of {one.flights}{there}\n{said}".strip(), (one.travel_time, 100 * one.rate),
        xytext=(0.99, 0.06), textcoords="axes fraction", ha="right", va="bottom", fontsize=8, color=INK,
        arrowprops={"arrowstyle": "-", "color": FAINT, "linewidth": 0.8},
    )  # fmt: skip
