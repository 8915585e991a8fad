"""The paper's comparison of racing planners, at equal nodes and at equal certified accuracy.

    python benchmarks/race_figure.py docs/race_figure.csv docs/race_figure.png
    python benchmarks/race_figure.py docs/race_figure.csv docs/race_figure.png --plot

Travel time and CPU time against the number of gates (before the end) for each method of `race_runs`: (a) with 40 nodes
per gate, as the paper; (b) with the fewest of `NODES` that replay each gate to 1 cm. Runs stand in the CSV file, one
row as soon as it is done; the same command again goes on where it stopped, `--plot` only draws what is there and prints
it. A run is stopped when its process has spent `--cpu-limit` seconds, and no finer grid is tried then for (b). Runs above
`--repeat-below` seconds are not repeated. Before the first run of a new file each method begins the largest race and is
stopped, so that no run that counts pays for a compiler. 6 gates are left out: the sixth is where the end is.
`--prefix` is put before each child's command.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path

from race_picture import draw
from race_runs import METHODS, STOPPED, Key, Results, Run, append, child, read
from race_table import tables

GATES = (1, 2, 3, 4, 5, 7, 19)
NODES = (10, 20, 40, 80)
EQUAL = 40
WARM_UP = 30.0
"""CPU time in which all blocks are compiled, s."""


def following(runs: Sequence[Run], repeats: int, repeat_below: float) -> Key | None:
    """Return what is to be run next, None if nothing is: first once for everything, small grids first."""
    done = {run.key for run in runs}
    missing = [key for key in wanted(runs, repeats, repeat_below) if key not in done]
    return min(missing, key=lambda key: (key[3], key[2] * (key[1] + 1)), default=None)


def wanted(runs: Sequence[Run], repeats: int, repeat_below: float) -> Iterator[Key]:
    """All that the runs so far ask for."""
    for gates in GATES:
        for method in METHODS:
            first = {r.nodes: r for r in runs if (r.method, r.gates, r.repeat) == (method, gates, 0)}
            for nodes in needed(first):
                yield method, gates, nodes, 0
                if nodes in first and first[nodes].cpu_s < repeat_below:
                    yield from ((method, gates, nodes, repeat) for repeat in range(1, repeats))


def needed(first: dict[int, Run]) -> set[int]:
    """Nodes per gate to run: `EQUAL`, and finer and finer until the accuracy or the limit of CPU time is reached."""
    found = {EQUAL}
    for nodes in NODES:
        found.add(nodes)
        if nodes not in first or first[nodes].accurate or first[nodes].status == STOPPED:
            break
    return found


def main() -> None:
    """Run what is missing, then draw, and print tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("csv", type=Path)
    parser.add_argument("picture", type=Path)
    parser.add_argument("--plot", action="store_true")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--repeat-below", type=float, default=10.0)
    parser.add_argument("--cpu-limit", type=float, default=150.0)
    parser.add_argument("--prefix", default="", help="command put before each run's, such as 'nice -n 10'")
    said = parser.parse_args()
    prefix = said.prefix.split()
    for method in () if said.plot or said.csv.is_file() else METHODS:
        child(method, GATES[-1], EQUAL, 0, WARM_UP, prefix)
    while not said.plot and (key := following(read(said.csv), said.repeats, said.repeat_below)):
        run = child(*key, said.cpu_limit, prefix)
        append(said.csv, run)
        print(run, flush=True)
    results = Results(read(said.csv), GATES)
    draw(results, EQUAL, said.picture)
    print(tables(results, EQUAL))


if __name__ == "__main__":
    main()
