"""Where order, number or choice of contacts is open: sequences, relaxations and the integer solver, as Markdown tables.

    OMP_NUM_THREADS=1 python benchmarks/open_order.py [--output DIR] [--with OVERRIDE ...]

Three sets of ordinary, resumable sweeps (docs/sweeps.md): on each scenario's own grid the enumeration over sequences; on
N = 40, kappa_init = 2 relaxations from a start that takes no side (`neutral`), from the sequence as it is listed, and from
the one that is best (`right`); on N = 12, kappa_init = 1 the integer solver as well. Costs are those of claimed plans,
rewards taken off.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from benchbench.storage.table import read

SCENARIOS = "two_free,first_robot,detour"
RIGHT = {"two_free": "[bench,cart]", "first_robot": "[far]", "detour": "[cart]"}
"""The sequences that the enumeration finds best."""
BOTH = "strategy=relax strategy.margin=0 relaxation=scholtes,fischer_burmeister"
SWEEPS = {
    "own grid": {
        "sequences": f"+scenario=delivery,{SCENARIOS} strategy=sequences",
    },
    "N = 40, kappa_init = 2": {
        "sequences": f"+scenario={SCENARIOS} strategy=sequences strategy.margin=0",
        "neutral": f"+scenario={SCENARIOS} {BOTH} guess=neutral",
        "listed": f"+scenario={SCENARIOS} {BOTH} guess=phases",
        **{
            f"right {name}": f"+scenario={name} {BOTH} guess=phases guess.sequence={sequence}"
            for name, sequence in RIGHT.items()
        },
    },
    "N = 12, kappa_init = 1": {
        "sequences": f"+scenario={SCENARIOS} strategy=sequences strategy.margin=0",
        "scholtes": f"+scenario={SCENARIOS} strategy=relax strategy.margin=0 relaxation=scholtes guess=neutral,phases",
        "bonmin": f"+scenario={SCENARIOS} strategy=relax strategy.margin=0 relaxation=direct solver=bonmin guess=neutral,phases",
    },
}
"""Overrides by table and method."""
GRIDS = {
    "own grid": "",
    "N = 40, kappa_init = 2": "scenario.intervals=40 scenario.kappa_init=2",
    "N = 12, kappa_init = 1": "scenario.intervals=12 scenario.kappa_init=1",
}
HEAD = "| scenario | start | strategy | relaxation | solver | made | cost s | travel time s | status | iterations | CPU s |"


def sweep(folder: Path, overrides: str) -> pd.DataFrame:
    """Run what is missing of one sweep; its last row per run."""
    command = [sys.executable, "-m", "benchbench", "-m", *overrides.split(), f"output={folder}"]
    subprocess.run(command, stdout=sys.stderr, check=False)  # exit code 1: something was not certified
    return read(folder).drop_duplicates("config_hash", keep="last")


def line(row: pd.Series, method: str) -> str:
    """One line of a table."""
    start = method.split()[0] if method.split()[0] in ("neutral", "listed", "right") else row["guess"]
    stops = [] if row["stops"] is None else list(row["stops"])
    made = ", ".join(str(stop) for stop in stops) or "nothing"
    relaxed = row["relaxation"] if row["strategy"] == "relax" else "-"
    numbers = " | ".join("-" if pd.isna(row[c]) else f"{row[c]:.3f}" for c in ("objective", "travel_time_s"))
    count = "-" if pd.isna(row["iterations"]) else f"{row['iterations']:.0f}"
    spent = "-" if pd.isna(row["solve_cpu_s"]) else f"{row['solve_cpu_s']:.1f}"
    names = f"{row['scenario']} | {start} | {row['strategy']} | {relaxed} | {row['solver']}"
    return f"| {names} | {made} | {numbers} | {row['status']} | {count} | {spent} |"


def main(root: Path, more: Sequence[str]) -> None:
    """Sweep and print table after table."""
    for title, methods in SWEEPS.items():
        lines = []
        for method, overrides in methods.items():
            folder = root / "_".join((title + " " + method).replace("=", "").replace(",", "").split())
            rows = sweep(folder, " ".join((overrides, GRIDS[title], *more)))
            lines += [(row["scenario"], line(row, method)) for _, row in rows.iterrows()]
        order = ["delivery", *SCENARIOS.split(",")]
        lines.sort(key=lambda pair: order.index(pair[0]))
        print(f"\n{title}\n\n{HEAD}\n|{'---|' * HEAD.count(' | ')}---|", flush=True)
        print("\n".join(text for _, text in lines), flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--output", type=Path, default=Path("results", "open_order"))
    parser.add_argument("--with", nargs="+", default=[], dest="more", metavar="OVERRIDE")
    asked = parser.parse_args()
    main(asked.output, asked.more)
