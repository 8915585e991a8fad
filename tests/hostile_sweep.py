"""Sweeps of hostile runs among honest ones, and what has to be true of them; no tests here."""

from __future__ import annotations

import os
import subprocess
import uuid
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from program import COMMAND, ENVIRONMENT, Done, told

from benchbench.storage.playback import read_mcap
from benchbench.storage.table import read

HERE = str(Path(__file__).parent)
HOSTILE = ("~strategy", "+strategy._target_=hostile.Hostile", "scenario.intervals=12", "picture=false")
SLOW = ("spin_deaf", "native_loop", "stop_itself", "stop_its_keeper", "dead_lock")
"""Ways that end at the wall-clock limit."""
SAME = ("status", "travel_time_s", "iterations", "evaluations", "objective", "mpcc_hash", "reasons")
MARK = "BENCHBENCH_TEST_MARK"

Truth = tuple[dict[str, Any], bytes]


@dataclass(frozen=True)
class Swept:
    """A sweep that has ended: the names of its runs, what the program said, rows by name, processes that are left."""

    names: Sequence[str]
    folder: Path
    done: Done
    rows: Mapping[str, list[dict[str, Any]]]
    left: list[str]

    def faults(self, truth: Truth) -> list[str]:
        """What is wrong."""
        found = [f"left behind: {process}" for process in self.left]
        for name in self.names:
            rows = self.rows.get(name, [])
            found += [f"{name}: {len(rows)} rows"] * (len(rows) != 1)
            if name.startswith("fine"):
                found += [f"{name} differs" for row in rows if judged(self.folder, row) != truth]
            else:
                found += [f"{name} has no reason" for row in rows if not any(row["reasons"])]
        statuses = {row["status"] for rows in self.rows.values() for row in rows}
        code = 2 if "bad_input" in statuses else 1
        return found + [f"exit code {self.done.returncode}"] * (self.done.returncode != code)


def alone(folder: Path) -> Truth:
    """An honest run without company, in this process."""
    folder.mkdir()
    told(folder, "+scenario=static", *HOSTILE, "+strategy.way=fine", PYTHONPATH=HERE)
    (row,) = read(folder / "results").to_dict("records")
    return judged(folder, {str(name): value for name, value in row.items()})


def swept(folder: Path, names: Sequence[str], workers: int, *more: str) -> Swept:
    """Sweep runs of these names: ways of `hostile`, or honest ones."""
    folder.mkdir()
    mark = uuid.uuid4().hex
    command = [
        *COMMAND, "-m", "+scenario=static", *HOSTILE, f"+strategy.way={','.join(names)}", f"workers={workers}",
        "hard_limit=60", "memory_limit_mb=3000", *more,
    ]  # fmt: skip
    path = os.pathsep.join([HERE, os.environ.get("PYTHONPATH", "")])
    environment = {**os.environ, **ENVIRONMENT, "PYTHONPATH": path, MARK: mark}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    rows: dict[str, list[dict[str, Any]]] = {}
    for row in read(folder / "results").to_dict("records"):
        name = names[int(row["run_id"].rpartition("_")[2])]
        rows.setdefault(name, []).append({str(column): value for column, value in row.items()})
    return Swept(names, folder, done, rows, processes_with(f"{MARK}={mark}"))


def judged(folder: Path, row: Mapping[str, Any]) -> Truth:
    """What must be the same in every honest row, and the numbers of the plan to the last bit."""
    found = [path for path in folder.rglob("plan.mcap") if row["run_id"].endswith(f"_{path.parent.name}")]
    plan = read_mcap(found[0]).plan
    parts = (plan.time, plan.configuration, plan.velocity, plan.inputs)
    numbers = b"".join(np.asarray(part).tobytes() for part in parts)
    return {name: list(row[name]) if name == "reasons" else row[name] for name in SAME}, numbers


def processes_with(variable: str) -> list[str]:
    """Commands of the processes that were started with a variable of the environment; a fork has its parent's."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            dead = (entry / "stat").read_text().rpartition(")")[2].split()[0] in "ZX"
            if not dead and variable.encode() in (entry / "environ").read_bytes():
                found.append((entry / "cmdline").read_text().replace("\0", " "))
        except OSError:
            continue
    return found
