"""Run every n-th of the best known values again: `python benchmarks/best_known_again.py [n] [first] [seconds]`.

Says of each whether it is certified under today's limits, and how far its travel time is from the stored one. seconds: wall clock
after which no further one is begun.
"""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchbench.storage.best_known import BestKnown, packaged


def main() -> int:
    """Run them one after the other; exit code 1 where one is not certified."""
    step, first, seconds = (float(a) for a in (*sys.argv[1:], *("8", "0", "1e9")[len(sys.argv) - 1 :]))
    entries = list(BestKnown.load(packaged()).entries.values())[int(first) :: int(step)]
    began, told, bad = time.monotonic(), 0, []
    for entry in entries:
        if time.monotonic() - began > seconds:
            break
        with tempfile.TemporaryDirectory() as scratch:
            command = [*shlex.split(entry["command"]), "picture=false", f"output={scratch}"]
            subprocess.run([sys.executable, "-m", "benchbench", *command], capture_output=True, check=False)
            records = [json.loads(path.read_text()) for path in Path(scratch).rglob("record.json")]
        record = (
            records[0] if records else {"certified": False, "gap_percent": None, "reasons": ["no record"]}
        )
        told += 1
        bad += [] if record["certified"] else [entry["command"]]
        print(
            "certified" if record["certified"] else f"NOT: {record['reasons']}", record["gap_percent"], "%",
            entry["command"], flush=True,
        )  # fmt: skip
    print(
        f"{told} of {len(BestKnown.load(packaged()).entries)} run again: {told - len(bad)} certified, {len(bad)} not"
    )
    return 1 if bad else 0


if __name__ == "__main__":
    raise SystemExit(main())
