"""Every relaxation on a folder of NOSBENCH problems, as Markdown tables: what is claimed, and what is true.

    OMP_NUM_THREADS=1 python benchmarks/nosbench.py ../shared/nosbench
    OMP_NUM_THREADS=1 python benchmarks/nosbench.py ../shared/nosbench strategy=continuation,relax relaxation=scholtes

The runs are `benchbench collection FOLDER relaxation=... time_limit=60`, which resumes. The judge stands outside: it
reads the problem and the solution from their files and uses nothing of ours. A problem is solved if the violation of
bounds, constraints and signs is below 1e-6, the largest G H below 1e-7, and f at most max(2 f_best, f_best + 1e-6);
f_best is manifest.json's, where it has one.
"""

from __future__ import annotations

import argparse
import gzip
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pandas as pd

from benchbench.storage.files import RECORD, SOLUTION

OUTPUT = Path("results", "nosbench")
TIME_LIMIT = 60
RELAXATIONS = (
    "augmented_lagrangian,chen_chen_kanzow,direct,elastic,fischer_burmeister,kadrani,kanzow_schwartz,l1_penalty,"
    "lin_fukushima,natural_residual,paper,scholtes,steffensen_ulbrich"
)


def solved(problem: Path, x: np.ndarray, best: float | None) -> bool:
    """Judge a solution by the problem's file alone; what is no number solves nothing."""
    stored = problem.read_bytes()
    told = json.loads(gzip.decompress(stored) if problem.suffix == ".gz" else stored)
    p = np.ravel(told["p0"])
    keys = ("augmented_objective_fun", "g_fun", "G_fun", "H_fun")
    f, g, G, H = (np.asarray(ca.Function.deserialize(told[key])(x, p)).ravel() for key in keys)
    low, high, below, above = (np.asarray(np.ravel(told[k]), float) for k in ("lbw", "ubw", "lbg", "ubg"))
    broken = np.concatenate((low - x, x - high, below - g, g - above, -G, -H))
    good = np.isfinite(f[0]) and (best is None or f[0] <= max(2 * best, best + 1e-6))
    return bool(broken.max(initial=0.0) < 1e-6 and np.max(G * H, initial=0.0) < 1e-7 and good)


def file_of(name: str, folder: Path) -> Path:
    """File of a problem, packed or not."""
    packed = folder / f"{name}.json.gz"
    return packed if packed.is_file() else folder / f"{name}.json"


def rows(folder: Path) -> pd.DataFrame:
    """One row per run of a problem of this folder, with the judge's word."""
    manifest = folder / "manifest.json"
    best = (
        {e["name"]: e["best_known_objective"] for e in json.loads(manifest.read_text())}
        if manifest.is_file()
        else {}
    )
    found = []
    for path in OUTPUT.rglob(RECORD):
        record: dict[str, Any] = json.loads(path.read_text())
        name, solution = record["scenario"], path.with_name(SOLUTION)
        problem = file_of(name, folder)
        if not problem.is_file():
            continue  # of another folder
        true = solution.is_file() and solved(
            problem, np.ravel(json.loads(solution.read_text())["w"]), best.get(name)
        )
        found.append({**record, "verified": true})
    if not found:
        sys.exit(f"{OUTPUT} has no run of a problem of {folder}")
    return (
        pd.DataFrame(found)
        .sort_values("started_at")
        .drop_duplicates(["scenario", "relaxation", "strategy"], keep="last")
    )


def summary(runs: pd.DataFrame) -> None:
    """Print one line per relaxation and strategy."""
    count = runs.scenario.nunique()
    print(
        f"| relaxation | strategy | claimed | certified | verified (of {count}) | S | B | iterations | CPU s, median | most |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|")
    lines = []
    for (relaxation, strategy), group in runs.groupby(["relaxation", "strategy"]):
        true = group[group.verified]
        lines.append((
            -len(true), f"| {relaxation} | {strategy} | {group.claimed_success.sum()} | {group.certified.sum()} | "
            f"**{len(true)}** | {(true.stationarity == 'S').sum()} | {(true.b_stationary == 'yes').sum()} | "
            f"{group.iterations.sum():.0f} | {group.solve_cpu_s.median():.2f} | {group.solve_cpu_s.max():.1f} |",
        ))  # fmt: skip
    print("\n".join(text for _, text in sorted(lines)))


def matrix(runs: pd.DataFrame) -> None:
    """Print who solved what: the objective where verified, else the status in brackets."""
    for strategy, group in runs.groupby("strategy"):
        names = sorted(group.relaxation.unique())
        print(f"\nstrategy={strategy}\n\n| problem | {' | '.join(names)} |\n|{'---|' * (len(names) + 1)}")
        for problem, entries in group.groupby("scenario"):
            by_name = {e["relaxation"]: e for e in entries.to_dict("records")}
            print(f"| {problem.split('_')[0]} | {' | '.join(_cell(by_name.get(name)) for name in names)} |")


def _cell(entry: dict[str, Any] | None) -> str:
    if entry is None:
        return "-"
    return f"{entry['objective']:.4g}" if entry["verified"] else f"({entry['status']})"


def main(folder: Path, overrides: list[str]) -> None:
    """Run what is missing, judge, print."""
    asked = (
        overrides
        if any(o.startswith("relaxation=") for o in overrides)
        else [f"relaxation={RELAXATIONS}", *overrides]
    )
    command = [
        sys.executable, "-m", "benchbench", "collection", str(folder), f"time_limit={TIME_LIMIT}", f"output={OUTPUT}",
        *asked,
    ]  # fmt: skip
    done = subprocess.run(command, stdout=sys.stderr, check=False)  # code 1: something was not certified
    if done.returncode == 2:
        sys.exit(2)
    runs = rows(folder)
    summary(runs)
    matrix(runs)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, help="with the problems, .json or .json.gz")
    parser.add_argument("overrides", nargs="*", metavar="OVERRIDE", help="as for the main command")
    asked = parser.parse_args()
    main(asked.folder, asked.overrides)
