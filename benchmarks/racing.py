"""Speed of races, one thread, medians: `python benchmarks/racing.py [repeats]`.

Prints Markdown tables. Each repeat is a fresh process; CPU seconds are user and system, children (the compiler)
counted. "plan" is construction, point-mass start and solve; "process" adds interpreter, imports, certificate.
"""

from __future__ import annotations

import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from typing import Any

import numpy as np

ONE = """
import json, sys
from resource import RUSAGE_CHILDREN, RUSAGE_SELF, getrusage
from benchbench.run import pipeline
from benchbench.run import config
def cpu():
    return sum(x.ru_utime + x.ru_stime for x in map(getrusage, (RUSAGE_SELF, RUSAGE_CHILDREN)))
case = config.compose(*sys.argv[1:])
spent, kind = {}, type(case.strategy)
solve = kind.solve
def timed(self, case, ledger):
    before = cpu()
    result = solve(self, case, ledger)
    spent.update(plan=cpu() - before, race=result.solved.outcome.iterations)
    return result
kind.solve = timed
done = pipeline.run(case)
keep = ("travel_time_s", "iterations", "replay_drift_position_m", "gate_worst_miss_m")
print(json.dumps({**{k: done.record[k] for k in keep}, **spent, "certified": done.certificate.certified}))
"""
RAMP, FLAT = "vehicle=race_ramp", "vehicle=race_quadrotor"
GATES = (1, 2, 3, 4, 7, 12)
ACCURACY = (
    ("rk4", 20),
    ("rk4", 40),
    ("lie_verlet dynamics.forces=simpson", 20),
    ("lie_verlet dynamics.forces=simpson", 40),
    ("lie_verlet", 40),
    ("lie_verlet", 50),
    ("verlet", 40),
    ("verlet", 120),
)


def main() -> None:
    """Measure and print."""
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    with tempfile.TemporaryDirectory() as scratch:
        environment = dict(os.environ, OMP_NUM_THREADS="1", BENCHBENCH_CACHE=scratch)
        cold = _run(["scenario.gates=1", RAMP], environment)
        warm = _run(["scenario.gates=1", RAMP], environment)
        print(
            f"empty cache: {cold['plan']:.1f} s CPU for one gate, compiler counted; then {warm['plan']:.1f} s"
        )
        for vehicle in (RAMP, FLAT):
            print(f"\nrk4, 40 nodes per gate, {vehicle}\n\n{_head('gates')}")
            cpu = {n: _row(f"{n}", [vehicle, f"scenario.gates={n}"], repeats, environment) for n in GATES}
            print(f"\nCPU of the plan grows with (gates + 1)^{_exponent(cpu):.2f}")
        print(f"\nrk4, 20 nodes per gate, 19 gates\n\n{_head('vehicle')}")
        for vehicle in (RAMP, FLAT):
            long = [vehicle, "scenario.gates=19", "scenario.nodes_per_gate=20"]
            _row(vehicle.split("=")[1], long, repeats, environment)
        print(f"\n4 gates, {RAMP}, {RAMP}_euler for verlet\n\n{_head('dynamics, nodes per gate')}")
        for dynamics, nodes in ACCURACY:
            vehicle = f"{RAMP}_euler" if dynamics == "verlet" else RAMP
            chosen = [
                vehicle,
                *f"dynamics={dynamics}".split(),
                f"scenario.nodes_per_gate={nodes}",
                "scenario.gates=4",
            ]
            _run(chosen, environment)  # compiles
            _row(f"`{dynamics}`, {nodes}", chosen, repeats, environment)


def _head(first: str) -> str:
    columns = (
        first, "travel time s", "iterations, start + race", "plan CPU s, median (min to max)", "process CPU s",
        "replay from gate to gate, mm", "certified",
    )  # fmt: skip
    return f"| {' | '.join(columns)} |\n{'|---' * len(columns)}|"


def _row(label: str, overrides: list[str], repeats: int, environment: dict[str, str]) -> float:
    """Print one row; returns the median CPU of planning."""
    runs = [_run(overrides, environment) for _ in range(repeats)]
    first, plan = runs[0], [run["plan"] for run in runs]
    median = statistics.median(plan)
    cells = (
        label,
        f"{first['travel_time_s']:.4f}",
        f"{first['iterations'] - first['race']} + {first['race']}",
        f"{median:.2f} ({min(plan):.2f} to {max(plan):.2f})",
        f"{statistics.median(run['process'] for run in runs):.2f}",
        f"{1000 * first['replay_drift_position_m']:.3g}",
        "yes" if first["certified"] else "no",
    )
    print(f"| {' | '.join(cells)} |", flush=True)
    return median


def _run(overrides: list[str], environment: dict[str, str]) -> dict[str, Any]:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [sys.executable, "-c", ONE, "+scenario=race", *overrides]
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {**json.loads(done.stdout.splitlines()[-1]), "process": spent}


def _exponent(cpu: dict[int, float]) -> float:
    """Slope of log CPU over log segments, by least squares."""
    segments, seconds = np.log([n + 1 for n in cpu]), np.log(list(cpu.values()))
    return float(np.polyfit(segments, seconds, 1)[0])


if __name__ == "__main__":
    main()
