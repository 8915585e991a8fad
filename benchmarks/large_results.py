"""What a large folder of results costs: `python benchmarks/large_results.py [rows] [folder]`.

Sweeps a few small runs, copies them with other fields until there are so many, each with its folder, record, configuration, plan
and row, and prints CPU time, memory and size of `benchbench table`, of `benchbench report`, and of a sweep that finds all its
runs in the table; then of the table alone, without the runs' folders. A folder that is given is kept, and used again.
"""

from __future__ import annotations

import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchbench.storage.files import CONFIG, PLAN, RECORD
from benchbench.storage.row_file import row_bytes
from benchbench.storage.table import folder, load_record

SWEEP = (
    "-m", "+scenario=static", "scenario.intervals=12,14", "relaxation=scholtes,elastic", "guess=line,simple", "seed=0,1",
    "picture=false", "iteration_limit=30",
)  # fmt: skip
SOLVERS = ("ipopt", "uno", "sqpmethod")
COMMAND = (sys.executable, "-m", "benchbench")


def fill(root: Path, rows: int) -> None:
    """Copy the runs of a sweep below `root` until there are so many."""
    subprocess.run([*COMMAND, *SWEEP, f"output={root}"], check=False, capture_output=True)
    models = [path.parent for path in sorted(root.glob("sweeps/**/record.json"))]
    for number in range(len(models), rows):
        copy(root, models[number % len(models)], number, rows)


def copy(root: Path, model: Path, number: int, rows: int) -> None:
    """Make one more run: its numbers, its seed, its solver and its problem are its own."""
    record = load_record(model / RECORD)
    place = root / "sweeps" / "copied" / str(number)
    place.mkdir(parents=True)
    sizes = {"intervals": 12 + number // 16 % 12, "kappa_init": 1 + number // 200 % 8, "seed": number}
    solver, factor = SOLVERS[number // 16 % len(SOLVERS)], 1 + 0.3 * number / rows
    certified = number % 3 > 0
    numbers = {n: v * factor for n, v in record.items() if type(v) is float}
    record |= numbers | sizes | {
        "run_id": f"sweeps_copied_{number}", "config_hash": f"{number:016x}", "solver": solver, "certified": certified,
        "status": "certified" if certified else record["status"], "reasons": [] if certified else record["reasons"],
        "started_at": f"2026-01-01T{number // 3600:02}:{number // 60 % 60:02}:{number % 60:02}Z",
    }  # fmt: skip
    (place / RECORD).write_text(json.dumps(record, indent=2))
    config = (model / CONFIG).read_text()
    for name, value in {**sizes, "output": "elsewhere"}.items():
        config = re.sub(rf"\b{name}: .*", f"{name}: {value}", config)
    (place / CONFIG).write_text(config)
    if (model / PLAN).exists():
        os.link(model / PLAN, place / PLAN)
    (folder(root) / f"{record['run_id']}.parquet").write_bytes(row_bytes(record))


def measured(name: str, *command: str, file: Path | None = None) -> None:
    """Run a command and print what it cost."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    timed = [sys.executable, "-c", PEAK, *command]
    done = subprocess.run(timed, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    size = f", {file.stat().st_size / 1e6:.1f} MB" if file and file.exists() else ""
    peak, said = done.stdout.splitlines()[-1], (done.stdout + done.stderr).splitlines()[-2]
    print(
        f"{name}: {cpu:.1f} s CPU, {time.monotonic() - began:.1f} s, {peak} MB{size}   ({said[:100]})",
        flush=True,
    )


PEAK = """import resource, subprocess, sys
subprocess.run(sys.argv[1:])
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss // 1024)"""


def main() -> int:
    """Make the folder, unless it is there, and measure."""
    rows = int(sys.argv[1]) if len(sys.argv) > 1 else 20_000
    with tempfile.TemporaryDirectory() as scratch:
        place = Path(sys.argv[2] if len(sys.argv) > 2 else scratch).resolve()
        root = place / "results"
        if not root.is_dir():
            place.mkdir(parents=True, exist_ok=True)
            fill(root, rows)
        csv, page = place / "runs.csv", place / "report.html"
        measured("table, short", *COMMAND, "table", str(root), "--output", str(place / "short.md"))
        measured("table, all columns", *COMMAND, "table", str(root), "--output", str(csv), file=csv)
        measured("report", *COMMAND, "report", str(root), "--output", str(page), file=page)
        measured("resume", *COMMAND, *SWEEP, f"output={root}")
        alone = place / "alone"
        shutil.copytree(folder(root), folder(alone), dirs_exist_ok=True)
        measured("table of rows alone", *COMMAND, "table", str(alone), "--output", str(csv), file=csv)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
