"""Speed of the main jobs, one thread, medians: `python benchmarks/speed.py [repeats]`.

Prints a Markdown table. Each repeat is a fresh process; CPU seconds count children (the compiler) too. Before and after
each of them a fixed nonlinear program is solved, the reference of `benchbench regress`: the column of references is the
median of CPU time over that of the reference. It tells a slow machine from slow code, within a factor of two: a busy
host slows the reference, one large interpreted graph, more than our solves. How cost grows with N, and
against other ways to write the problem, is in `benchmarks/growth.py`.
"""

from __future__ import annotations

import os

os.environ["OMP_NUM_THREADS"] = "1"

import argparse
import json
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path

from benchbench.nlp.reference import Reference
from benchbench.run import config

WINDOW = """
import json, sys, time
from benchbench.run import config
from benchbench.nlp.ledger import Ledger
from benchbench.formulation.handover import fixed_window
from benchbench.planning.guess import straight_line
from benchbench.planning.strategy import pose
scenario, node, mode = sys.argv[1:]
case = config.compose(f"+scenario={scenario}", f"compile={mode}")
ledger, began = Ledger(60.0), time.perf_counter()
with ledger.building():
    problem = fixed_window(case, straight_line(case), (int(node), int(node) + 1))
found = pose(problem, case, ledger, "window")
print(json.dumps({"build": ledger.build_cpu, "solve": ledger.solve_cpu, "iterations": ledger.iterations,
                  "wall": time.perf_counter() - began, "travel_time": found.plan.travel_time}))
"""
STRATEGY = """
import json, sys
from benchbench.run import config
from benchbench.nlp.ledger import Ledger
scenario, strategy, mode = sys.argv[1:]
case = config.compose(f"+scenario={scenario}", f"compile={mode}", f"strategy={strategy}")
ledger = Ledger(300.0)
found = case.strategy.solve(case, ledger)
print(json.dumps({"build": ledger.build_cpu, "solve": ledger.solve_cpu, "iterations": ledger.iterations,
                  "travel_time": found.plan.travel_time}))
"""
REPLAN = """
import json, sys, time
from dataclasses import replace
import numpy as np
from benchbench.run import config
from benchbench.planning.replan import Replanner
scenario, intervals = sys.argv[1:]
case = config.compose(f"+scenario={scenario}", f"scenario.intervals={intervals}", "scenario.contact_seconds=0.05")
replanner, target, cpu, wall, iterations = Replanner(case), case.scenario.target, [], [], []
field = {"static": "position_m", "linear": "start_m", "circle": "centre_m"}[scenario]
draw = np.random.default_rng(0)
for _ in range(15):
    plan = replanner.last.plan
    q, v = (np.array([np.interp(0.05, plan.time, c) for c in a.T]) for a in (plan.configuration, plan.velocity))
    shifted = np.array(getattr(target, field)) + 0.05 * np.array(getattr(target, "velocity_mps", (0, 0, 0)))
    changes = {field: tuple(shifted + draw.normal(0, 0.003, 3))}
    if scenario == "circle":
        changes["phase_rad"] = target.phase_rad + 0.05 * target.rate_radps
    target = replace(target, **changes)
    began = time.process_time()
    answer = replanner.plan(target, q, v, 0.05)
    cpu.append(time.process_time() - began)
    wall.append(answer.seconds)
    iterations.append(answer.result.solved.outcome.iterations)
print(json.dumps({"cpu": cpu, "wall": wall, "iterations": iterations}))
"""
NODES = {"static": 42, "linear": 43, "circle": 48}
MODES = {"auto": "compiled", "never": "interpreted"}
REFERENCES: list[float] = []
"""CPU seconds of the reference beside each measurement."""


def main(repeats: int) -> None:
    """Measure and print."""
    print("| what | scenario | CPU s, median (min to max) | references | note |\n|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as scratch:
        for name, node in NODES.items():
            for mode in MODES:
                _windows(name, node, mode, repeats, scratch)
        strategies = [s for s in ("phases", "enumeration", "relax") if s in config.choices("strategy")]
        for strategy in strategies:
            for name in NODES:
                for mode in MODES if strategy == "phases" else ("auto",):
                    _strategies(name, strategy, mode, repeats, scratch)
        for name in NODES:
            for intervals in (50, 25):
                _replans(name, intervals, scratch)
        for name in NODES:
            runs = [_beside(lambda name=name: _whole(name, scratch)) for _ in range(repeats)]
            note = f"{max(r['memory'] for r in runs):.0f} MB, exit code {runs[0]['code']}"
            _row("whole default run, imports included", name, runs, ("cpu",), note)
    _row("the reference", "", [{"cpu": cpu, "reference": cpu} for cpu in REFERENCES], ("cpu",), "")


def _windows(name: str, node: int, mode: str, repeats: int, scratch: str) -> None:
    with tempfile.TemporaryDirectory(dir=scratch) as empty:
        cold = _run(WINDOW, empty, name, str(node), mode)
    runs = [_run(WINDOW, scratch, name, str(node), mode) for _ in range(repeats + 1)][1:]
    note = f"cold {cold['build']:.2f} s CPU, {cold['wall'] - cold['solve']:.2f} s wall"
    _row(f"build N=100, from the cache, {MODES[mode]}", name, runs, ("build",), note)
    note = f"{runs[0]['iterations']} iterations, {runs[0]['travel_time']:.4f} s"
    _row(f"one window solve N=100, {MODES[mode]}", name, runs, ("solve",), note)


def _strategies(name: str, strategy: str, mode: str, repeats: int, scratch: str) -> None:
    runs = [_run(STRATEGY, scratch, name, strategy, mode) for _ in range(repeats + 1)][1:]
    note = f"{runs[0]['iterations']} iterations, {runs[0]['travel_time']:.4f} s"
    what = f"strategy={strategy} N=100, build and solve, {MODES[mode]}"
    _row(what, name, runs, ("build", "solve"), note)


def _replans(name: str, intervals: int, scratch: str) -> None:
    found = _run(REPLAN, scratch, name, str(intervals))
    middle, wall = (statistics.median(found[k]) for k in ("iterations", "wall"))
    runs = [{"cpu": cpu, "reference": found["reference"]} for cpu in found["cpu"]]
    _row(f"one replan N={intervals}", name, runs, ("cpu",), f"{middle:.0f} iterations, wall {wall:.3f} s")


def _environment(scratch: str) -> dict[str, str]:
    return {**os.environ, "OMP_NUM_THREADS": "1", "BENCHBENCH_CACHE": str(Path(scratch, "cache"))}


def _run(code: str, scratch: str, *arguments: str) -> dict:
    command = [sys.executable, "-c", code, *arguments]

    def run() -> dict:
        done = subprocess.run(command, env=_environment(scratch), check=True, capture_output=True, text=True)
        return json.loads(done.stdout)

    return _beside(run)


def _beside(run: Callable[[], dict]) -> dict:
    """Run one measurement between two solves of the reference in this process."""
    before = _reference().cpu_s()
    found = run()
    REFERENCES.append((before + _reference().cpu_s()) / 2)
    return {**found, "reference": REFERENCES[-1]}


@cache
def _reference() -> Reference:
    return Reference()


def _whole(name: str, scratch: str) -> dict[str, float]:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    options = [f"+scenario={name}", "solver=ipopt", f"output={scratch}/results"]
    command = [sys.executable, "-m", "benchbench", *options]
    began = time.perf_counter()
    done = subprocess.run(command, env=_environment(scratch), capture_output=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    record = max(Path(scratch, "results").glob("**/record.json"), key=lambda p: p.stat().st_mtime)
    memory = json.loads(record.read_text())["peak_memory_mb"]
    return {"cpu": cpu, "wall": time.perf_counter() - began, "memory": memory, "code": done.returncode}


def _row(what: str, scenario: str, runs: list[dict], keys: tuple[str, ...], note: str) -> None:
    """One line; `keys` name the CPU times of a run that add up."""
    values = [sum(run[key] for key in keys) for run in runs]
    middle, low, high = statistics.median(values), min(values), max(values)
    ratio = statistics.median(value / run["reference"] for value, run in zip(values, runs, strict=True))
    print(
        f"| {what} | {scenario} | {middle:.3f} ({low:.3f} to {high:.3f}) | {ratio:.2f} | {note} |", flush=True
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("repeats", nargs="?", type=int, default=5, help="of each measurement, at least 1")
    repeats = parser.parse_args().repeats
    if repeats < 1:
        parser.error(f"argument repeats: {repeats} was given, allowed: at least 1")
    main(repeats)
