"""Runs of races for the benchmarks: each in a child process with a limit of CPU time, kept in a CSV file that is resumed."""

from __future__ import annotations

import csv
import json
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

METHODS: dict[str, tuple[str, ...]] = {
    "phases": ("strategy=phases",),
    "RK4-CPC": ("strategy=relax", "strategy.margin=0", "guess=line"),
    "RK4-CPC warm": ("strategy=warm",),
    "lie_verlet-DMCC": (
        "dynamics=lie_verlet", "dynamics.forces=simpson", "strategy=relax", "strategy.margin=0", "guess=line",
    ),
    "Verlet-DMCC": (
        "dynamics=verlet", "vehicle=race_quadrotor_euler", "strategy=relax", "strategy.margin=0", "guess=line",
    ),
}  # fmt: skip
"""One grid each (`strategy.margin=0`), whatever the certificate says of it.

Cold means the public planner's start: straight lines, progress that switches where they pass the gates.
"""
SCHEDULE = "relaxation.schedule=[1e-2,1e-4,1e-9]"
"""A gate's ball is 15 times wider than a handover's, so that sigma = 1e-7 may leave pairs above 1e-6."""
ACCURACY = 0.01
"""Largest error of the replay from gate to gate of a plan that counts as accurate, m."""
Key = tuple[str, int, int, int]
"""Method, gates, nodes per gate, number of the repeat."""
STOPPED = "cpu_limit"
"""Status of a run that was stopped when its process had spent its CPU time; `cpu_s` is then that limit."""


@dataclass(frozen=True)
class Run:
    """One run: a method on the first gates of the public track and its end; CPU s are all-in, build and guess included."""

    method: str
    gates: int
    nodes: int
    repeat: int
    status: str
    certified: bool = False
    travel_time_s: float = float("nan")
    cpu_s: float = float("nan")
    iterations: int = 0
    drift_m: float = float("nan")
    miss_m: float = float("nan")
    reason: str = ""

    @property
    def key(self) -> Key:
        """What makes it another run."""
        return self.method, self.gates, self.nodes, self.repeat

    @property
    def planned(self) -> bool:
        """Whether it ended with a plan, certified or not."""
        return self.status in ("certified", "uncertified")

    @property
    def accurate(self) -> bool:
        """Whether the plan is certified and accurate enough."""
        return self.certified and self.drift_m <= ACCURACY


@dataclass(frozen=True)
class Results:
    """Runs by method, gates and nodes; of repeats the first with the median CPU time."""

    runs: Sequence[Run]
    gates: Sequence[int]

    def of(self, method: str, gates: int) -> dict[int, Run]:
        """Runs of a method on a race, by nodes per gate, coarse to fine."""
        mine = [run for run in self.runs if (run.method, run.gates) == (method, gates)]
        return {n: middle([r for r in mine if r.nodes == n]) for n in sorted({r.nodes for r in mine})}

    def equal(self, method: str, nodes: int) -> list[Run]:
        """Runs with that many nodes per gate, by gates; those stopped on a coarser grid."""
        found = []
        for gates in self.gates:
            runs = self.of(method, gates)
            shown = [run for n, run in runs.items() if n == nodes or (n < nodes and run.status == STOPPED)]
            found += shown[-1:]
        return found

    def accurate(self, method: str) -> list[Run]:
        """The coarsest accurate run of each race, else its finest one."""
        found = []
        for gates in self.gates:
            runs = list(self.of(method, gates).values())
            found += ([run for run in runs if run.accurate] or runs[-1:])[:1]
        return found


def growth(line: Sequence[Run]) -> float | None:
    """Exponent of n = gates + 1 in the CPU time, by least squares; None of fewer than three races."""
    if len(line) < 3:
        return None
    segments, seconds = np.log([run.gates + 1 for run in line]), np.log([run.cpu_s for run in line])
    return float(np.polyfit(segments, seconds, 1)[0])


def one(*overrides: str) -> dict[str, object]:
    """Run here and return what is kept."""
    from benchbench.run.config import compose
    from benchbench.run.pipeline import run

    record = run(compose("+scenario=race", *overrides)).record
    return {
        "status": record["status"],
        "certified": record["certified"],
        "travel_time_s": record["travel_time_s"],
        "cpu_s": record["build_cpu_s"] + record["solve_cpu_s"],
        "iterations": record["iterations"],
        "drift_m": record["replay_drift_position_m"],
        "miss_m": record["gate_worst_miss_m"],
        "reason": (record["reasons"] or [""])[0],
    }


def child(
    method: str, gates: int, nodes: int, repeat: int, cpu_limit: float, prefix: Sequence[str] = ()
) -> Run:
    """Run one case in its own process, one thread; a crash and a run stopped after `cpu_limit` s are results too."""
    overrides = [*METHODS[method], SCHEDULE, f"scenario.gates={gates}", f"scenario.nodes_per_gate={nodes}"]
    command = [*prefix, sys.executable, __file__, f"{cpu_limit:g}", *overrides]
    environment = dict(os.environ, OMP_NUM_THREADS="1")
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    if done.returncode in (-signal.SIGXCPU, 128 + signal.SIGXCPU):
        return Run(method, gates, nodes, repeat, STOPPED, cpu_s=cpu_limit)
    if done.returncode:
        said = (done.stderr.strip().splitlines() or [""])[-1][:200]
        return Run(method, gates, nodes, repeat, f"exit {done.returncode}", reason=said)
    found = {k: v for k, v in json.loads(done.stdout.splitlines()[-1]).items() if v is not None}
    return Run(method, gates, nodes, repeat, **found)


def read(path: Path) -> list[Run]:
    """Return the runs of a file, none if there is none."""
    if not path.is_file():
        return []
    kinds: dict[str, Any] = {"str": str, "int": int, "float": float, "bool": lambda text: text == "True"}
    with path.open(newline="") as file:
        return [
            Run(**{f.name: kinds[str(f.type)](row[f.name]) for f in fields(Run)})
            for row in csv.DictReader(file)
        ]


def append(path: Path, run: Run) -> None:
    """Add a run to a file."""
    fresh = not path.is_file()
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a", newline="") as file:
        writer = csv.DictWriter(file, [f.name for f in fields(Run)])
        if fresh:
            writer.writeheader()
        writer.writerow(asdict(run))


def middle(runs: Sequence[Run]) -> Run:
    """Return the first of several repeats with the median of their CPU times."""
    first = min(runs, key=lambda run: run.repeat)
    return Run(**{**asdict(first), "cpu_s": median(run.cpu_s for run in runs)})


def stop_after(cpu_limit: float) -> None:
    """Let the system stop this process after that many seconds of CPU; the wall clock plays no part."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CPU, (round(cpu_limit), round(cpu_limit) + 5))


if __name__ == "__main__":
    stop_after(float(sys.argv[1]))
    print(json.dumps(one(*sys.argv[2:], "time_limit=1e6")))
