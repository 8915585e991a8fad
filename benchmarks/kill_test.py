"""Kill a sweep with SIGKILL at random moments and resume it: `python benchmarks/kill_test.py [kills] [seed]`.

Says whether the final table equals that of an undisturbed sweep and whether a process was left behind.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from test_launcher import SWEEP, answers, kill_and_resume
from test_program import program


def main() -> int:
    """Run both sweeps and compare."""
    kills, seed = (int(a) for a in (*sys.argv[1:], *("20", "0")[len(sys.argv) - 1 :]))
    with tempfile.TemporaryDirectory() as scratch:
        calm, rough = Path(scratch, "calm"), Path(scratch, "rough")
        calm.mkdir(), rough.mkdir()
        began = time.monotonic()
        program(calm, *SWEEP)
        whole = time.monotonic() - began
        kill_and_resume(rough, kills, 0.8 * whole, seed)  # stops with an AssertionError for an orphan
        same = answers(rough / "results").equals(answers(calm / "results"))
        rows = len(answers(rough / "results"))
    print(
        f"{kills} kills within {whole:.1f} s, {rows} rows, no process left, tables {'equal' if same else 'DIFFER'}"
    )
    return 0 if same else 1


if __name__ == "__main__":
    raise SystemExit(main())
