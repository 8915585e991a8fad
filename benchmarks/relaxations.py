"""Every relaxation on the three handovers, as Markdown tables.

    OMP_NUM_THREADS=1 python benchmarks/relaxations.py
    OMP_NUM_THREADS=1 python benchmarks/relaxations.py scholtes kadrani

First from the guess `phases` at N = 100, then from the guess `line` at N = 50. Each run is one child process
with 60 s for its solves. Travel times of certified plans are bold, with what they are above the plan of
strategy=phases at N = 100; others stand in brackets behind what happened. Iterations and CPU seconds of solvers
are those of the whole run, the guess included.
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

SCENARIOS = ("static", "linear", "circle")
SETTINGS = (("phases", 100), ("line", 50))
TIME_LIMIT = 60.0
HARD_LIMIT = 4 * TIME_LIMIT
"""Wall s of a child, in case a solver does not stop."""


def one(*overrides: str) -> dict[str, Any]:
    """Run one case here and return what the table needs."""
    record = run(compose(f"time_limit={TIME_LIMIT}", *overrides)).record
    wanted = ("status", "certified", "travel_time_s", "iterations", "solve_cpu_s")
    return {**{k: record[k] for k in wanted}, "reason": (record["reasons"] or [""])[0]}


def child(*overrides: str) -> dict[str, Any]:
    """Run one case in its own process; a crash or a hang is a result too. Details go to stderr."""
    command = [sys.executable, __file__, "--one", *overrides]
    found: dict[str, Any] = {"status": "timeout"}
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=HARD_LIMIT, check=False)
        found = {"status": f"exit {done.returncode}", "reason": done.stderr.strip()[-200:]}
        if done.returncode == 0:
            found = json.loads(done.stdout.splitlines()[-1])
    except subprocess.TimeoutExpired:
        pass
    print(*overrides, json.dumps(found), file=sys.stderr, flush=True)
    return found


def cell(found: dict[str, Any], best: float) -> str:
    """One entry of the table."""
    if "travel_time_s" not in found:
        return str(found["status"])
    time, effort = found["travel_time_s"], f"{found['iterations']} it, {found['solve_cpu_s']:.1f} s"
    if found["certified"]:
        return f"**{time:.4f}** (+{100 * (time / best - 1):.2f} %), {effort}"
    return f"{found['status']} ({time:.3f}), {effort}"


def names() -> list[str]:
    """All relaxations there are, without the one that leaves the pairs to the solver."""
    return sorted(p.stem for p in Path(folder(), "relaxation").glob("*.yaml") if p.stem != "none")


def main(chosen: list[str]) -> None:
    """Print one table per setting, line by line."""
    reference = [child(f"+scenario={s}", "strategy=phases", "scenario.intervals=100") for s in SCENARIOS]
    best = [found["travel_time_s"] for found in reference]
    for guess, intervals in SETTINGS:
        print(f"\nguess={guess}, N = {intervals}\n")
        print(f"| relaxation | {' | '.join(SCENARIOS)} |\n|---|---|---|---|")
        if guess == "phases":
            cells = [cell(found, b) for found, b in zip(reference, best, strict=True)]
            print(f"| (strategy=phases) | {' | '.join(cells)} |", flush=True)
        for name in chosen or names():
            settings = (f"relaxation={name}", f"guess={guess}", f"scenario.intervals={intervals}")
            found = [child(f"+scenario={s}", *settings) for s in SCENARIOS]
            cells = [cell(f, b) for f, b in zip(found, best, strict=True)]
            print(f"| {name} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    if sys.argv[1:2] != ["--one"]:
        main(sys.argv[1:])
    else:
        try:
            print(json.dumps(one(*sys.argv[2:])))
        except BenchBenchError as error:
            sys.exit(str(error))
