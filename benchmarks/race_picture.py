"""The figure of `race_figure.py`: travel time and CPU time by gates, work and precision."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from race_runs import ACCURACY, METHODS, STOPPED, Results, Run, growth

COLOURS = dict(zip(METHODS, ("#0072b2", "#d55e00", "#e69f00", "#009e73", "#cc79a7"), strict=True))
SHAPES = dict(zip(METHODS, "osD^v", strict=True))
GREY = "#555555"


def draw(results: Results, equal: int, path: Path) -> None:
    """Write the picture: (a) at equal nodes, (b) at equal accuracy; at the right work and precision of two races."""
    figure = Figure(figsize=(15.0, 9.0), layout="constrained")
    grid = figure.subplots(2, 3)
    limit = max((run.cpu_s for run in results.runs if run.status == STOPPED), default=None)
    rows = (
        (f"(a) {equal} nodes per gate, as the paper", {m: results.equal(m, equal) for m in METHODS}),
        (f"(b) fewest nodes that replay to {100 * ACCURACY:g} cm", {m: results.accurate(m) for m in METHODS}),
    )
    for axes, (title, lines), strict in zip(grid, rows, (False, True), strict=True):
        _travel(axes[0], lines, results.gates, strict)
        _work(axes[1], lines, results.gates, strict)
        for panel in axes[:2]:
            panel.set_title(title, loc="left", fontsize=11)
    for axes, count in zip(grid[:, 2], (2, 4), strict=True):
        _precision(axes, results, count)
    figure.legend(handles=_key(limit), loc="outside lower center", ncols=5, frameon=False)
    figure.savefig(path, dpi=150)


def _travel(axes: Axes, lines: dict[str, list[Run]], gates: Sequence[int], strict: bool) -> None:
    """Travel time above that of phases with the most nodes, which is written along the axis in seconds."""
    best = {run.gates: run.travel_time_s for run in lines["phases"]}
    for method, line in lines.items():
        shown = [run for run in line if run.gates in best and run.planned]
        shown = [run for run in shown if run.accurate or not strict]
        above = [100 * (run.travel_time_s / best[run.gates] - 1) for run in shown]
        _points(axes, [run.gates for run in shown], above, shown, method)
    axes.set(ylabel="travel time above phases [%]")
    _by_gates(axes, gates, [f"{n}\n{best[n]:.2f}" if n in best else f"{n}" for n in gates])
    axes.set_xlabel("gates before the end; below: travel time of phases [s]")


def _work(axes: Axes, lines: dict[str, list[Run]], gates: Sequence[int], strict: bool) -> None:
    """CPU time; crosses where runs were stopped, hollow ones where no accuracy was reached."""
    for place, (method, line) in enumerate(lines.items()):
        shown = [run for run in line if run.planned]
        shown = [run for run in shown if run.accurate or not strict]
        _points(axes, [run.gates for run in shown], [run.cpu_s for run in shown], shown, method)
        aside = 1 + 0.035 * (place - 2)
        stopped = [run for run in line if run.status == STOPPED]
        missed = [run for run in line if strict and not run.accurate and run.status != STOPPED]
        for lost, sign in ((stopped, "x"), (missed, "$?$")):
            x, y = [aside * run.gates for run in lost], [run.cpu_s for run in lost]
            axes.plot(x, y, linestyle="", marker=sign, color=COLOURS[method], markersize=8)
        grown = growth(shown)
        if grown is not None:
            axes.annotate(
                f"$n^{{{grown:.1f}}}$", (shown[-1].gates, shown[-1].cpu_s), (6, 4), textcoords="offset points",
                color=COLOURS[method], fontsize=11,
            )  # fmt: skip
    axes.set(yscale="log", ylabel="CPU time, construction and solves [s]")
    _by_gates(axes, gates, [str(n) for n in gates])
    axes.set_xlabel("gates before the end")


def _precision(axes: Axes, results: Results, gates: int) -> None:
    """CPU time over the error of the replay, a point for each grid."""
    for method in METHODS:
        line = [run for run in results.of(method, gates).values() if np.isfinite(run.drift_m)]
        _points(axes, [run.drift_m for run in line], [run.cpu_s for run in line], line, method)
        for run in line:
            axes.annotate(
                f"{run.nodes}", (run.drift_m, run.cpu_s), (4, 4), textcoords="offset points", fontsize=8,
                color=COLOURS[method],
            )  # fmt: skip
    axes.axvline(ACCURACY, color=GREY, linestyle=(0, (4, 3)), linewidth=1)
    axes.set(xscale="log", yscale="log", xlabel="error of the replay from gate to gate [m]")
    axes.set_ylabel("CPU time, construction and solves [s]")
    axes.set_title(f"{gates} gates, by nodes per gate; dashed: 1 cm", loc="left", fontsize=11)
    axes.grid(color="#e6e6e6", linewidth=0.6)


def _points(axes: Axes, x: Sequence[float], y: Sequence[float], runs: Sequence[Run], method: str) -> None:
    """Draw a curve; hollow where the plan is not certified."""
    axes.plot(x, y, "-", color=COLOURS[method], linewidth=1.2)
    fill = [COLOURS[method] if run.certified else "white" for run in runs]
    axes.scatter(x, y, c=fill, edgecolors=COLOURS[method], marker=SHAPES[method], s=34, zorder=3)


def _by_gates(axes: Axes, gates: Sequence[int], labels: Sequence[str]) -> None:
    axes.set_xscale("log")
    axes.set_xticks(gates, labels, minor=False, fontsize=8)
    axes.minorticks_off()
    axes.set_xlim(0.88 * gates[0], 1.25 * gates[-1])
    axes.grid(color="#e6e6e6", linewidth=0.6)


def _key(limit: float | None) -> list[Line2D]:
    methods = [
        Line2D([], [], color=COLOURS[m], marker=SHAPES[m], label=f"{m} (RK4)" if m == "phases" else m)
        for m in METHODS
    ]
    marks = [
        ("o", GREY, "certified"),
        ("o", "white", "not certified"),
        ("$?$", GREY, "1 cm not reached: CPU of the finest grid tried"),
    ]
    if limit is not None:
        marks.append(("x", GREY, f"stopped after {limit:g} s of CPU, there or on a coarser grid"))
    signs = [
        Line2D([], [], color=GREY, marker=shape, markerfacecolor=fill, linestyle="", label=label)
        for shape, fill, label in marks
    ]
    growth = Line2D([], [], linestyle="", marker="$n$", color=GREY, label="growth of CPU with n = gates + 1")
    return [*methods, *signs, growth]
