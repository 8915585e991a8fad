"""The picture of a front: what success costs in travel time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl

from benchbench.analysis.front import Candidate, front
from benchbench.report.png import Picture, write_png
from benchbench.report.style import BAD, FAINT, FRAME, GOOD, INK, LIMIT, RC
from benchbench.storage.files import replacing

SIZE_IN = (8.5, 5.0)


def draw_front(path: Path, found: Sequence[Candidate], target: float, title: str) -> None:
    """Write the picture as PNG: each candidate with its Wilson interval, those that prove the target filled, the front as steps.

    Raises BadInput("output", ...) when the file system refuses.
    """
    with mpl.rc_context(RC), replacing(path) as temporary:
        figure = Picture(figsize=SIZE_IN, facecolor="white", layout="constrained")
        axes = figure.subplots()
        figure.suptitle(title, x=0.01, ha="left", fontsize=11, fontweight="bold", color=INK)
        for one in found:
            low, high = one.interval
            proved = one.low >= target
            axes.plot([one.travel_time] * 2, [100 * low, 100 * high], color=FAINT, linewidth=0.8)
            axes.plot(
                one.travel_time, 100 * one.rate, "o" if proved else "s", color=GOOD if proved else BAD,
                markerfacecolor=GOOD if proved else "white", markersize=6,
            )  # fmt: skip
        best = front(found)
        axes.plot(
            [one.travel_time for one in best], [100 * one.rate for one in best], color=FRAME, drawstyle="steps-post",
            linewidth=1.2, zorder=0,
        )  # fmt: skip
        axes.axhline(100 * target, color=LIMIT, linestyle="--", linewidth=0.8)
        axes.annotate(f"{100 * target:g} % asked", (0.995, 100 * target), xycoords=("axes fraction", "data"),
                      ha="right", va="bottom", fontsize=8, color=LIMIT)  # fmt: skip
        axes.set(xlabel="travel time of the certified plan [s]", ylim=(-3, 103))
        axes.set_ylabel("flights that succeed [%]")
        axes.set_title(
            "bars: 95 % Wilson interval; filled: proves what is asked; line: no other is faster and better"
        )
        write_png(figure, temporary)
