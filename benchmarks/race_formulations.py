"""Progress variables, cold and warm, against phases on the first gates of the public track, as a Markdown table.

    OMP_NUM_THREADS=1 python benchmarks/race_formulations.py docs/race_figure.csv

Flat limits, RK4, 40 nodes per gate, one thread; CPU s are all-in (construction, guess, every solve), medians of three.
Rows are kept in the CSV file, which may be that of `race_figure.py`, and not run again. All forms keep a gate to its radius
at a node, so the radii are matched; `miss` is the largest distance beyond one on the replay.
"""

from __future__ import annotations

import sys
from pathlib import Path

from race_runs import Run, append, child, middle, read

FORMS = ("phases", "RK4-CPC", "RK4-CPC warm")
GATES, NODES, REPEATS, CPU_LIMIT = (1, 2, 3, 4), 40, 3, 150.0
HEAD = (
    "gates", "phases: s, iterations, CPU", "cold: s, iterations, CPU", "warm: s, iterations, CPU", "warm / cold",
    "warm above phases", "largest miss mm", "certified",
)  # fmt: skip


def main(path: Path, prefix: list[str]) -> None:
    """Run what is missing, print the table."""
    for repeat in range(REPEATS):
        for gates in GATES:
            for method in FORMS:
                if (method, gates, NODES, repeat) not in {run.key for run in read(path)}:
                    append(path, child(method, gates, NODES, repeat, CPU_LIMIT, prefix))
    print(f"| {' | '.join(HEAD)} |\n{'|---' * len(HEAD)}|")
    for gates in GATES:
        runs = [run for run in read(path) if (run.gates, run.nodes) == (gates, NODES)]
        print(line(*(middle([run for run in runs if run.method == form]) for form in FORMS)))


def line(phases: Run, cold: Run, warm: Run) -> str:
    """One row of the table."""
    forms = (phases, cold, warm)
    cells = [
        f"{phases.gates}",
        *(f"{run.travel_time_s:.4f}, {run.iterations}, {run.cpu_s:.2f}" for run in forms),
        f"{warm.cpu_s / cold.cpu_s:.2f}",
        f"{100 * (warm.travel_time_s / phases.travel_time_s - 1):+.2f} %",
        f"{1e3 * max(run.miss_m for run in forms):.2g}",
        "all" if all(run.certified for run in forms) else "not all",
    ]
    return f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
