"""Progress variables, cold and warm, against phases on the first gates of the public track, as a Markdown table.

    OMP_NUM_THREADS=1 python benchmarks/race_formulations.py docs/race_figure.csv

Flat limits, 40 nodes per gate, one thread; CPU s are all-in (construction, guess, every solve), medians of three. Rows
are kept in the CSV file, which may be that of `race_figure.py`, and not run again. All forms keep a gate to its radius at a node, so the radii are matched; `miss`
is the largest distance beyond one on the replay.
"""

from __future__ import annotations

import sys
from pathlib import Path

from race_runs import METHODS, Run, append, child, middle, read

GATES, NODES, REPEATS, CPU_LIMIT = (1, 2, 3, 4), 40, 3, 300.0


def main(path: Path, prefix: list[str]) -> None:
    """Run what is missing, print the table."""
    for repeat in range(REPEATS):
        for gates in GATES:
            for method in METHODS:
                if (method, gates, NODES, repeat) not in {run.key for run in read(path)}:
                    append(path, child(method, gates, NODES, repeat, CPU_LIMIT, prefix))
    runs = [run for run in read(path) if run.nodes == NODES]
    print(
        "| gates | method | travel time s | above phases | iterations | CPU s | of cold | miss mm | drift mm | |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|")
    for gates in GATES:
        found = {m: middle([r for r in runs if (r.method, r.gates) == (m, gates)]) for m in METHODS}
        for method, run in found.items():
            print(line(run, found["phases"], found["RK4-CPC"] if method == "RK4-CPC warm" else None))


def line(run: Run, phases: Run, cold: Run | None) -> str:
    """One row of the table."""
    above = 100 * (run.travel_time_s / phases.travel_time_s - 1)
    share = f"{run.cpu_s / cold.cpu_s:.2f}" if cold else ""
    verdict = "certified" if run.certified else f"{run.status}: {run.reason}"
    return (
        f"| {run.gates} | {run.method} | {run.travel_time_s:.4f} | {above:+.2f} % | {run.iterations} | {run.cpu_s:.2f} | "
        f"{share} | {1e3 * run.miss_m:.3f} | {1e3 * run.drift_m:.2f} | {verdict} |"
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
