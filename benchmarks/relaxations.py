"""Every relaxation on the three handovers, as a Markdown table.

    OMP_NUM_THREADS=1 python benchmarks/relaxations.py              # guess=phases N=100, then guess=line N=50
    OMP_NUM_THREADS=1 python benchmarks/relaxations.py scholtes kadrani

Each run is one child process with 60 s of solver time. Iterations and CPU seconds are those of the whole
run, the guess included, block functions compiled before.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from benchbench.config import compose, folder
from benchbench.errors import BenchBenchError
from benchbench.pipeline import run

BEST_KNOWN = {"static": 2.6881, "linear": 2.6627, "circle": 2.8540}
"""Travel times in s of the best certified plans, N = 100."""
SETTINGS = (("phases", 100), ("line", 50))
TIME_LIMIT = 60.0
HARD_LIMIT = 4 * TIME_LIMIT
"""s; a solver is told what is left when it is built, so a schedule can take twice the time limit."""


def one(relaxation: str, scenario: str, guess: str, intervals: int) -> dict[str, Any]:
    """Run one case here and return the columns of the table."""
    case = compose(
        f"+scenario={scenario}", f"relaxation={relaxation}", f"guess={guess}",
        f"scenario.intervals={intervals}", f"time_limit={TIME_LIMIT}",
    )  # fmt: skip
    wanted = ("status", "certified", "claimed_success", "travel_time_s", "iterations", "solve_cpu_s")
    record = run(case).record
    return {**{k: record[k] for k in wanted}, "reason": (record["reasons"] or [""])[0]}


def child(*arguments: str) -> dict[str, Any]:
    """Run one case in its own process; a crash or a hang is a result too."""
    command = [sys.executable, __file__, "--one", *arguments]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=HARD_LIMIT, check=False)
    except subprocess.TimeoutExpired:
        return {"status": "timeout"}
    if done.returncode:
        return {"status": f"exit {done.returncode}", "reason": done.stderr.strip()[-200:]}
    return dict(json.loads(done.stdout.splitlines()[-1]))


def cell(found: dict[str, Any], best: float) -> str:
    """One entry of the table; travel times of plans that are not certified stand in brackets."""
    if "travel_time_s" not in found:
        return str(found["status"])
    time, effort = found["travel_time_s"], f"{found['iterations']} it, {found['solve_cpu_s']:.1f} s"
    if found["certified"]:
        return f"**{time:.4f}** (+{100 * (time / best - 1):.2f} %), {effort}"
    return f"{found['status']} ({time:.3f}), {effort}"


def names() -> list[str]:
    """All relaxations there are."""
    return sorted(p.stem for p in Path(folder(), "relaxation").glob("*.yaml"))


def main(chosen: list[str]) -> None:
    """Print one table per setting, line by line; details of what failed go to stderr."""
    for guess, intervals in SETTINGS:
        print(
            f"\nguess={guess}, N = {intervals}\n\n| relaxation | {' | '.join(BEST_KNOWN)} |\n|---|---|---|---|"
        )
        for relaxation in chosen or names():
            cells = []
            for scenario, best in BEST_KNOWN.items():
                found = child(relaxation, scenario, guess, str(intervals))
                print(relaxation, scenario, guess, json.dumps(found), file=sys.stderr, flush=True)
                cells.append(cell(found, best))
            print(f"| {relaxation} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    if sys.argv[1:2] != ["--one"]:
        main(sys.argv[1:])
    else:
        try:
            print(json.dumps(one(*sys.argv[2:5], int(sys.argv[5]))))
        except BenchBenchError as error:
            sys.exit(str(error))
