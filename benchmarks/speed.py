"""Speed of the main job, one thread, medians: `python benchmarks/speed.py [repeats]`.

Prints a Markdown table. Each repeat is a fresh process; CPU seconds count children (the compiler) too.
"""

from __future__ import annotations

import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

WINDOW = """
import json, sys, time
from benchbench import config
from benchbench.case import Ledger
from benchbench.formulation import fixed_window
from benchbench.guess import straight_line
from benchbench.strategy import pose
scenario, node, mode = sys.argv[1:]
case = config.compose(f"+scenario={scenario}", f"compile={mode}")
ledger = Ledger(60.0)
with ledger.building():
    problem = fixed_window(case, straight_line(case), (int(node), int(node) + 1))
found = pose(problem, case, ledger, "window")
print(json.dumps({"build": ledger.build_cpu, "solve": ledger.solve_cpu, "iterations": ledger.iterations,
                  "travel_time": found.plan.travel_time}))
"""
NODES = {"static": 42, "linear": 43, "circle": 48}


def main() -> None:
    """Measure and print."""
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    environment = dict(os.environ, OMP_NUM_THREADS="1")
    print("| what | scenario | CPU s, median (min to max) | note |\n|---|---|---|---|")
    with tempfile.TemporaryDirectory() as scratch:
        for name, node in NODES.items():
            for mode in ("auto", "never"):
                runs = [_window(name, node, mode, environment, scratch) for _ in range(repeats + 1)]
                cold, warm = runs[0], runs[1:]
                how = "compiled" if mode == "auto" else "interpreted"
                _row(
                    f"build N=100, from the cache, {how}",
                    name,
                    [r["build"] for r in warm],
                    f"cold {cold['build']:.2f} s",
                )
                note = f"{warm[0]['iterations']} iterations, {warm[0]['travel_time']:.4f} s"
                _row(f"one window solve N=100, {how}", name, [r["solve"] for r in warm], note)
        for name in NODES:
            runs = [_whole(name, environment, scratch) for _ in range(repeats)]
            note = f"{max(r['memory'] for r in runs):.0f} MB, exit code {runs[0]['code']}"
            _row("whole default run, imports included", name, [r["cpu"] for r in runs], note)


def _window(name: str, node: int, mode: str, environment: dict[str, str], scratch: str) -> dict[str, float]:
    environment = environment | {"BENCHBENCH_CACHE": str(Path(scratch, f"cache-{mode}"))}
    command = [sys.executable, "-c", WINDOW, name, str(node), mode]
    return json.loads(
        subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout
    )


def _whole(name: str, environment: dict[str, str], scratch: str) -> dict[str, float]:
    environment = environment | {"BENCHBENCH_CACHE": str(Path(scratch, "cache-auto"))}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [
        sys.executable,
        "-m",
        "benchbench",
        f"+scenario={name}",
        "solver=ipopt",
        f"output={scratch}/results",
    ]
    began = time.perf_counter()
    done = subprocess.run(command, env=environment, capture_output=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    record = max(Path(scratch, "results").glob("**/record.json"), key=lambda p: p.stat().st_mtime)
    memory = json.loads(record.read_text())["peak_memory_mb"]
    return {"cpu": cpu, "wall": time.perf_counter() - began, "memory": memory, "code": done.returncode}


def _row(what: str, scenario: str, values: list[float], note: str) -> None:
    print(
        f"| {what} | {scenario} | {statistics.median(values):.2f} ({min(values):.2f} to {max(values):.2f}) | {note} |",
        flush=True,
    )


if __name__ == "__main__":
    main()
