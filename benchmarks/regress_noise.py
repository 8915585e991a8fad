"""Ten comparisons of an unchanged program while the other cores are kept busy: `python benchmarks/regress_noise.py [runs]`.

The baseline is the one in the repository, measured without that load. Says how many comparisons raised an alarm.
"""

from __future__ import annotations

import multiprocessing
import os
import re
import subprocess
import sys
from pathlib import Path


def burn() -> None:
    """Use a core and its caches."""
    block = bytearray(2**25)
    while True:
        block[::64] = bytes(len(block) // 64)


def main() -> int:
    """Compare and count."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 10
    load = [
        multiprocessing.Process(target=burn, daemon=True) for _ in range(max((os.cpu_count() or 2) - 1, 1))
    ]
    for process in load:
        process.start()
    alarms = 0
    for number in range(runs):
        command = [sys.executable, "-m", "benchbench", "regress"]
        done = subprocess.run(
            command, cwd=Path(__file__).parents[1], env={**os.environ, "OMP_NUM_THREADS": "1"},
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        changes = [float(x) for x in re.findall(r"reference[^\n]*?([+-]\d+\.\d)%", done.stdout)]
        alarms += done.returncode != 0
        span = (
            f"solve ratios {min(changes):+.1f} % to {max(changes):+.1f} %" if changes else done.stderr.strip()
        )
        print(f"{number + 1:3d}  exit code {done.returncode}, {span}", flush=True)
    for process in load:
        process.kill()
    print(f"{alarms} alarms in {runs} comparisons under load")
    return 1 if alarms else 0


if __name__ == "__main__":
    raise SystemExit(main())
