"""Kill sweeps with SIGKILL at random moments and resume them: `python benchmarks/kill_test.py [kills] [seed]`.

Only kills that meet a sweep with something left to do are counted; sweeps start afresh until there are enough.

Says whether the final table equals that of an undisturbed sweep and whether a process was left behind.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from program import program
from test_launcher import RUNS, SWEEP, answers, kill_and_resume


def main() -> int:
    """Run both sweeps and compare."""
    kills, seed = (int(a) for a in (*sys.argv[1:], *("20", "0")[len(sys.argv) - 1 :]))
    with tempfile.TemporaryDirectory() as scratch:
        calm = Path(scratch, "calm")
        calm.mkdir()
        began = time.monotonic()
        program(calm, *SWEEP)
        whole, wanted = time.monotonic() - began, answers(calm / "results")
        sweeps = different = 0
        met: list[int] = []
        while len(met) < kills:
            rough = Path(scratch, str(sweeps))
            rough.mkdir()
            rows = kill_and_resume(rough, 3, whole, seed + sweeps)  # AssertionError for an orphan
            met += [count for count in rows if count < RUNS]
            different += not answers(rough / "results").equals(wanted)
            sweeps += 1
    print(
        f"{len(met)} kills of {sweeps} sweeps of {whole:.1f} s, rows by then {sorted(met)}: no process left, {different} tables differ"
    )
    return 0 if not different else 1


if __name__ == "__main__":
    raise SystemExit(main())
