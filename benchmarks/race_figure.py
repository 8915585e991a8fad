"""The paper's comparison of racing planners, at equal nodes and at equal certified accuracy.

    python benchmarks/race_figure.py results/race_figure.csv docs/race_figure.png
    python benchmarks/race_figure.py results/race_figure.csv docs/race_figure.png --plot

Travel time and CPU time against the number of gates (before the end) for each method of `race_runs`: (a) with 40 nodes
per gate, as the paper; (b) with the fewest of `NODES` that replay each gate to 1 cm. Runs stand in the CSV file, one
row as soon as it is done; the same command again goes on where it stopped, `--plot` only draws what is there.
6 gates are left out: the sixth is where the end is. `--prefix` is put before each child's command.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator, Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from race_runs import METHODS, Run, append, child, middle, read

GATES = (1, 2, 3, 4, 5, 7, 19)
NODES = (10, 20, 40, 80, 160, 320)
EQUAL = 40
ACCURACY = 0.01
"""Largest error of the replay from gate to gate, m."""
COLOURS = dict(zip(METHODS, ("#0072b2", "#d55e00", "#e69f00", "#009e73", "#cc79a7"), strict=True))


def wanted(runs: Sequence[Run], repeats: int) -> Iterator[tuple[str, int, int, int]]:
    """What is still to be run, in order: first once for everything, small problems first."""
    for repeat in range(repeats):
        for gates in GATES:
            for method in METHODS:
                for nodes in needed([r for r in runs if r.method == method and r.gates == gates]):
                    if (method, gates, nodes, repeat) not in {run.key for run in runs}:
                        yield method, gates, nodes, repeat


def needed(found: Sequence[Run]) -> Iterator[int]:
    """Nodes per gate to run: finer and finer until the accuracy is reached or nothing is found in time, and `EQUAL`."""
    first = {run.nodes: run for run in found if run.repeat == 0}
    for nodes in NODES:
        yield nodes
        run = first.get(nodes)
        if (
            run is None
            or accurate(run)
            or (nodes >= EQUAL and run.status not in ("certified", "uncertified"))
        ):
            break
    if EQUAL not in NODES[: NODES.index(nodes) + 1]:
        yield EQUAL


def accurate(run: Run) -> bool:
    """Whether a run is certified and accurate enough."""
    return run.certified and run.drift_m <= ACCURACY


def curves(runs: Sequence[Run], method: str, equal: bool) -> list[Run]:
    """One run for each number of gates: with `EQUAL` nodes, or the coarsest accurate one."""
    found = []
    for gates in GATES:
        mine = [run for run in runs if run.method == method and run.gates == gates]
        levels = [EQUAL] if equal else sorted({run.nodes for run in mine if accurate(run)})[:1]
        same = [run for run in mine if run.nodes in levels and math.isfinite(run.cpu_s)]
        found += [middle(same)] if same else []
    return found


def draw(runs: Sequence[Run], path: Path) -> None:
    """Four panels by gates, and work against precision at 2 gates."""
    figure = Figure(figsize=(14.0, 8.0), layout="constrained")
    grid = figure.subplots(2, 3)
    titles = (f"{EQUAL} nodes per gate, as the paper", f"replay within {100 * ACCURACY:g} cm at each gate")
    for row, equal, title in zip(grid, (True, False), titles, strict=True):
        for method in METHODS:
            line = curves(runs, method, equal)
            for axes, values in zip(row, ("travel_time_s", "cpu_s"), strict=False):
                points(axes, line, values, method)
        for axes, label in zip(row, ("travel time [s]", "CPU time [s]"), strict=False):
            axes.set(xlabel="gates before the end", ylabel=label, title=title, xscale="log")
            axes.set_xticks(GATES, [str(n) for n in GATES], minor=False)
            axes.minorticks_off()
        row[1].set_yscale("log")
    for axes, gates in zip(grid[:, 2], (2, 4), strict=True):
        for method in METHODS:
            mine = [r for r in runs if r.method == method and r.gates == gates and math.isfinite(r.drift_m)]
            levels = [middle([r for r in mine if r.nodes == n]) for n in sorted({r.nodes for r in mine})]
            axes.plot([r.drift_m for r in levels], [r.cpu_s for r in levels], ".-", color=COLOURS[method])
        axes.axvline(ACCURACY, color="grey", linestyle=(0, (4, 3)))
        axes.set(xscale="log", yscale="log", xlabel="error of the replay from gate to gate [m]")
        axes.set(ylabel="CPU time [s]", title=f"work and precision, {gates} gates")
    grid[0, 0].legend(frameon=False)
    figure.savefig(path, dpi=150)


def points(axes: Axes, line: Sequence[Run], values: str, method: str) -> None:
    """Draw a curve; hollow where the plan is not certified."""
    x, y = [run.gates for run in line], [getattr(run, values) for run in line]
    axes.plot(x, y, "-", color=COLOURS[method], label=method, linewidth=1.2)
    fill = [COLOURS[method] if run.certified else "white" for run in line]
    axes.scatter(x, y, c=fill, edgecolors=COLOURS[method], s=28, zorder=3)


def main() -> None:
    """Run what is missing, then draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("csv", type=Path)
    parser.add_argument("picture", type=Path)
    parser.add_argument("--plot", action="store_true")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--time-limit", type=float, default=300.0)
    parser.add_argument("--prefix", default="", help="command put before each run's, such as 'nice -n 10'")
    said = parser.parse_args()
    while not said.plot:
        following = next(wanted(read(said.csv), said.repeats), None)
        if following is None:
            break
        run = child(*following, said.time_limit, said.prefix.split())
        append(said.csv, run)
        print(run, flush=True)
    draw(read(said.csv), said.picture)


if __name__ == "__main__":
    main()
