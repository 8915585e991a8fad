"""Do strategies end certified, and with the best known travel time, from any start?

    OMP_NUM_THREADS=1 python benchmarks/robustness.py
    OMP_NUM_THREADS=1 python benchmarks/robustness.py --strategies phases --grids 100 --seeds 3

One ordinary, isolated, resumable sweep per strategy: scenarios x N x seeds; a seed above 0 disturbs contact time, travel
time, path and inputs of the start. Prints a Markdown table: runs certified, runs within 0.5 % of the best known, the
largest gap, the median and the largest CPU time of a run's solves. The best known of a task is the best certified one of
these runs and of results/best_known.yaml.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

import pandas as pd

from benchbench.storage.table import read

SCENARIOS = ("static", "linear", "circle")
ALLOWED = 0.005


def sweep(root: Path, strategy: str, grids: list[int], seeds: int) -> None:
    """Run one strategy on all scenarios, grids and seeds."""
    command = [
        sys.executable, "-m", "benchbench", "-m", f"+scenario={','.join(SCENARIOS)}", *strategy.split(),
        f"scenario.intervals={','.join(map(str, grids))}", f"seed={','.join(map(str, range(1, seeds + 1)))}",
        f"output={root}",
    ]  # fmt: skip
    subprocess.run(command, check=False)


def table(runs: pd.DataFrame) -> str:
    """One line per strategy, scenario and grid."""
    lines = [
        "| strategy | scenario | N | certified | within 0.5 % | best known s | largest gap | solve CPU s, median | largest |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    certified = runs[runs.certified.fillna(False)]
    for (strategy, scenario, n), group in runs.groupby(["strategy", "scenario", "intervals"], sort=False):
        same = certified[(certified.scenario == scenario) & (certified.intervals == n)].travel_time_s.min()
        best = min(same, group.best_known_s.min()) if group.best_known_s.notna().any() else same
        good = group[group.certified.fillna(False)]
        gaps = good.travel_time_s / best - 1
        near, worst = int((gaps <= ALLOWED).sum()), f"{100 * gaps.max():.3f} %" if len(gaps) else "-"
        cpu = group.solve_cpu_s
        lines.append(
            f"| {strategy} | {scenario} | {n} | {len(good)}/{len(group)} | {near}/{len(group)} | {best:.4f} | {worst} "
            f"| {cpu.median():.2f} | {cpu.max():.2f} |"
        )
    return "\n".join(lines)


def main() -> None:
    """Run what has no row yet, print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--output", type=Path, default=Path("results/robustness"))
    parser.add_argument(
        "--strategies", nargs="+", default=["strategy=phases", "strategy=enumeration"], metavar="OVERRIDES"
    )
    parser.add_argument("--grids", nargs="+", type=int, default=[100, 150, 200])
    parser.add_argument("--seeds", type=int, default=10)
    asked = parser.parse_args()
    for strategy in asked.strategies:
        sweep(asked.output, strategy if "=" in strategy else f"strategy={strategy}", asked.grids, asked.seeds)
    print(table(read(asked.output)))


if __name__ == "__main__":
    main()
