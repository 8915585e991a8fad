"""Do strategies, and relaxations, end certified and with the best known travel time, from any start?

    OMP_NUM_THREADS=1 python benchmarks/robustness.py
    OMP_NUM_THREADS=1 python benchmarks/robustness.py --strategies phases --grids 100 --seeds 1 2 3
    OMP_NUM_THREADS=1 python benchmarks/robustness.py --strategies relaxation=scholtes,paper --by method
    OMP_NUM_THREADS=1 python benchmarks/robustness.py --only-table --by method N
    python benchmarks/robustness.py --output references/relaxations.csv --only-table --by method scenario

One ordinary, isolated, resumable sweep per strategy: scenarios x N x seeds; a seed above 0 disturbs contact time, travel
time, path and inputs of the start. A strategy may be any overrides: `relaxation=NAME` takes strategy=relax and guess=phases
with it, so its seeds disturb the plan of phases. A run counts as done only for the commit that made it (docs/sweeps.md):
where commits go on, run this in a clone of its own.

`--keep FILE.csv` writes what the tables are made of, and `--output FILE.csv --only-table` makes them from it.

Prints a Markdown table of the runs in the folder with these N and seeds, one line per method, scenario and N, or per `--by`.
The best known travel time of a task is the best certified one of these runs and of references/best_known.yaml; travel times and
their spread are those of claimed plans, certified or not; "claimed near it" counts those of them that are within 0.5 % of
that best one: the contact was found, whatever the certificate says. CPU seconds and iterations are those of a run's solvers, guess
included.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Hashable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
from nosbench import RELAXATIONS

from benchbench.storage.table import read

SCENARIOS = ("static", "linear", "circle")
GRIDS, SEEDS = (100, 150, 200), tuple(range(1, 11))
RELAXING = ("relax", "warm", "continuation")
"""Strategies, or parts of their names, in which the relaxation plays a part."""
ALLOWED = 0.005
TASK = {"scenario", "N"}
BY = {"method": "method", "scenario": "scenario", "N": "intervals", "seed": "seed"}
"""What lines of the table can be told apart by, and its column."""
KEPT = (
    "scenario", "intervals", "seed", "strategy", "relaxation", "guess", "status", "claimed_success", "certified",
    "travel_time_s", "best_known_s", "iterations", "solve_cpu_s", "started_at", "git_commit", "config_hash", "task_hash",
)  # fmt: skip
"""Columns of `--keep`."""
COUNTS = (
    "runs", "claimed", "claimed near it", "certified", "within 0.5 %", "largest gap", "iterations", "CPU s", "most",
)  # fmt: skip
TIMES = ("travel time s", "spread")
"""For lines that are about one task."""


def sweep(root: Path, strategy: str, grids: Sequence[int], seeds: Sequence[int], more: Sequence[str]) -> None:
    """Run one strategy on all scenarios, grids and seeds."""
    asked = strategy if "=" in strategy else f"strategy={strategy}"
    command = [
        sys.executable, "-m", "benchbench", "-m", f"+scenario={','.join(SCENARIOS)}",
        *asked.replace("relaxation=all", f"relaxation={RELAXATIONS}").split(),
        f"scenario.intervals={','.join(map(str, grids))}", f"seed={','.join(map(str, seeds))}", *more, f"output={root}",
    ]  # fmt: skip
    subprocess.run(command, check=False)


def judged(rows: pd.DataFrame) -> pd.DataFrame:
    """The latest row of each configuration, with `method`, `near`, and `gap` of a certified one to the best of its task."""
    runs = rows.sort_values("started_at").drop_duplicates("config_hash", keep="last")
    runs = runs.assign(certified=runs.certified.fillna(False), claimed=runs.claimed_success.fillna(False))
    times = runs.travel_time_s.where(runs.certified.astype(bool))
    best = times.groupby(runs.task_hash).transform("min").combine(runs.best_known_s, min_of)
    method = [_method(*names) for names in zip(runs.strategy, runs.relaxation, strict=True)]
    near = runs.claimed.astype(bool) & ((runs.travel_time_s / best - 1).abs() <= ALLOWED)
    return runs.assign(method=method, gap=times / best - 1, near=near)


def min_of(one: float, other: float) -> float:
    """The smaller of two numbers, the other one where one is NaN."""
    return min((x for x in (one, other) if not pd.isna(x)), default=float("nan"))


def table(runs: pd.DataFrame, by: Sequence[str]) -> str:
    """One line per combination of `by`."""
    groups = runs.groupby([BY[name] for name in by], sort=True, dropna=False)
    one_task = set(by) >= TASK
    head = [*by, *COUNTS, *(TIMES if one_task else ())]
    lines = [_line(head), "|---" * len(head) + "|"]
    lines += [
        _line([*names, *_counts(group), *(_times(group) if one_task else ())]) for names, group in groups
    ]
    return "\n".join(lines)


def wide(runs: pd.DataFrame) -> str:
    """One line per method, one cell per scenario with every run: its travel time, bold if certified, else what happened."""
    lines = [_line(["method", *SCENARIOS]), "|---" * (1 + len(SCENARIOS)) + "|"]
    for method, group in runs.sort_values(["intervals", "seed"]).groupby("method"):
        cells = ["; ".join(map(_cell, group[group.scenario == s].to_dict("records"))) for s in SCENARIOS]
        lines.append(_line([method, *(cell or "-" for cell in cells)]))
    return "\n".join(lines)


def _line(cells: Sequence[object]) -> str:
    return f"| {' | '.join(map(str, cells))} |"


def _cell(run: Mapping[Hashable, Any]) -> str:
    if pd.isna(run["travel_time_s"]):
        return str(run["status"])
    effort = f"{run['iterations']} it, {run['solve_cpu_s']:.1f} s"
    if run["certified"]:
        return f"**{run['travel_time_s']:.4f}**, {effort}"
    return f"{run['status']} ({run['travel_time_s']:.3f}), {effort}"


def _method(strategy: object, relaxation: object) -> str:
    """The strategy, and the relaxation where it plays a part."""
    name = str(strategy)
    return f"{name}: {relaxation}" if any(part in name for part in RELAXING) else name


def _counts(group: pd.DataFrame) -> tuple[object, ...]:
    gaps = group.gap.dropna()
    return (
        len(group), int(group.claimed.sum()), int(group.near.sum()), int(group.certified.sum()), int((gaps <= ALLOWED).sum()),
        f"{100 * gaps.max():.3f} %" if len(gaps) else "-",
        f"{group.iterations.median():.0f}", f"{group.solve_cpu_s.median():.2f}", f"{group.solve_cpu_s.max():.2f}",
    )  # fmt: skip


def _times(group: pd.DataFrame) -> tuple[str, str]:
    times = group[group.claimed.astype(bool)].travel_time_s
    if times.empty:
        return "-", "-"
    return f"{times.median():.4f}", f"{100 * (times.max() / times.min() - 1):.3f} %"


def main() -> None:
    """Run what has no row yet, print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--output", type=Path, default=Path("results/robustness"))
    parser.add_argument("--strategies", nargs="+", default=["phases", "enumeration"], metavar="OVERRIDES")
    parser.add_argument("--grids", nargs="+", type=int, default=GRIDS, metavar="N")
    parser.add_argument("--seeds", nargs="+", type=int, default=SEEDS, metavar="SEED")
    parser.add_argument("--with", nargs="+", default=[], dest="more", metavar="OVERRIDE")
    parser.add_argument("--by", nargs="+", default=["method", "scenario", "N"], choices=BY)
    parser.add_argument("--wide", action="store_true", help="a column per scenario with every run")
    parser.add_argument("--keep", type=Path, metavar="FILE.csv", help="write the runs of the table")
    parser.add_argument("--only-table", action="store_true", help="run nothing")
    asked = parser.parse_args()
    if asked.output.suffix == ".csv" and not asked.only_table:
        parser.error(f"--output: {asked.output} holds rows; with them --only-table, for runs a folder")
    for strategy in [] if asked.only_table else asked.strategies:
        sweep(asked.output, strategy, asked.grids, asked.seeds, asked.more)
    if not asked.output.exists():
        parser.error(
            f"--output: {asked.output} does not exist; allowed: a folder of results or rows of --keep"
        )
    runs = judged(pd.read_csv(asked.output) if asked.output.suffix == ".csv" else read(asked.output))
    wanted = runs[runs.intervals.isin(asked.grids) & runs.seed.isin(asked.seeds)]
    if asked.keep:
        wanted[list(KEPT)].to_csv(asked.keep, index=False, float_format="%.7g")
    print(wide(wanted) if asked.wide else table(wanted, asked.by))


if __name__ == "__main__":
    main()
