"""Kill sweeps with SIGKILL at random moments and resume them: `python benchmarks/kill_test.py [kills] [seed]`.

Only kills that meet a sweep with something left to do are counted; sweeps start afresh until there are enough.

Says whether the final table equals that of an undisturbed sweep, whether every run of it has every file that it promises, also
at the moment of each kill, and whether a process was left behind.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from program import program
from test_launcher import RUNS, SWEEP, answers, kill_and_resume

from benchbench.storage.collect import collect

DRAWN = (*SWEEP, "picture=true")
FILES = ("config.yaml", "plan.mcap", "plan.png")


def lacking(root: Path) -> int:
    """Runs below a folder of results without one of their files."""
    folders = collect([root]).folders if root.is_dir() else ()
    return sum(place is None or not all((place / name).is_file() for name in FILES) for place in folders)


def main() -> int:
    """Run both sweeps and compare."""
    kills, seed = (int(a) for a in (*sys.argv[1:], *("20", "0")[len(sys.argv) - 1 :]))
    with tempfile.TemporaryDirectory() as scratch:
        calm = Path(scratch, "calm")
        calm.mkdir()
        began = time.monotonic()
        program(calm, *DRAWN)
        whole, wanted = time.monotonic() - began, answers(calm / "results")
        sweeps = different = poor = 0
        met: list[int] = []
        lost: list[int] = []
        while len(met) < kills:
            rough = Path(scratch, str(sweeps))
            rough.mkdir()
            rows = kill_and_resume(  # AssertionError for an orphan
                rough,
                3,
                1.3 * whole,
                seed + sweeps,
                DRAWN,
                lambda at=rough / "results": lost.append(lacking(at)),
            )
            met += [count for count in rows if count < RUNS]
            poor += lacking(rough / "results")
            different += not answers(rough / "results").equals(wanted)
            sweeps += 1
    print(
        f"{len(met)} kills of {sweeps} sweeps of {whole:.1f} s, rows by then {sorted(met)}: no process left, "
        f"{different} tables differ; runs without a promised file: "
        f"{sum(lost)} at the kills, {poor} in the end"
    )
    return 1 if different or poor or sum(lost) else 0


if __name__ == "__main__":
    raise SystemExit(main())
