"""Sweeps of honest runs among hostile ones: `python benchmarks/hostile.py [WAY ...]`, all ways of tests/hostile.py if none.

Every hostile run is followed by an honest one on the same worker, and then stands beside honest ones on a second worker.
Says of each way how its run ended, and what is wrong: an honest run that differs from one alone in its row or in a bit of
its plan, a hostile one without a row or a reason, a process that was left behind, another exit code.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from hostile import WAYS
from hostile_sweep import SLOW, Swept, alone, swept

CHUNK = 10


def main() -> int:
    """Run the sweeps, two for each ten ways: on one worker and on two."""
    asked = sys.argv[1:] or list(WAYS)
    kinds = [way for way in asked if way not in SLOW], [way for way in asked if way in SLOW]
    chunks = [kind[n : n + CHUNK] for kind in kinds for n in range(0, len(kind), CHUNK)]
    began, honest, faults = time.monotonic(), 0, list[str]()
    with tempfile.TemporaryDirectory() as scratch:
        truth = alone(Path(scratch, "alone"))
        for number, ways in enumerate(chunks):
            names = [name for way in ways for name in (way, f"fine_{way}")]
            for workers in (1, 2):
                done = swept(Path(scratch, f"{number}_{workers}"), names, workers)
                show(done, workers)
                honest += len(ways)
                faults += done.faults(truth)
    print(*faults, sep="\n")
    print(f"{len(asked)} ways, {honest} honest runs, {time.monotonic() - began:.0f} s: {len(faults)} faults")
    return 1 if faults else 0


def show(done: Swept, workers: int) -> None:
    """Print a line per hostile run."""
    for name in done.names:
        if not name.startswith("fine"):
            for row in done.rows.get(name, []):
                print(f"{name:32s} {workers} {row['status']}: {row['reasons'][0][:90]}", flush=True)


if __name__ == "__main__":
    raise SystemExit(main())
