"""Small sweeps: with runs that end badly on purpose, and one that is compared however it was carried out."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pandas as pd
from program import told

from benchbench.storage.table import read

HERE = str(Path(__file__).parent)
COARSE = ("strategy=phases", "strategy.margin=0", "dynamics=midpoint", "picture=false")
"""One solve; its replay, too, is found at once on the coarsest grids, where most others are flown interval by interval."""
QUICK = (*COARSE, "scenario.intervals=12")
"""One solve on a grid too coarse to be certified."""
BAD = ("~strategy", "+strategy._target_=bad_runs.Bad", "scenario.intervals=12", "picture=false")
SWEEP = ("-m", "+scenario=static", *COARSE, "scenario.intervals=11,12,13")
RUNS = 3


def path_with_bad_runs() -> str:
    return os.pathsep.join(filter(None, [HERE, os.environ.get("PYTHONPATH", "")]))


def answers(root: Path) -> pd.DataFrame:
    """The table without what names or times a run."""
    rows = read(root).sort_values("config_hash", ignore_index=True)
    same = [
        c for c in rows if c not in ("run_id", "started_at", "peak_memory_mb", "wall_s") and "_cpu_" not in c
    ]
    return rows[same]


def calm(folder: Path) -> None:
    """The sweep, undisturbed; `seconds` is how long it took."""
    began = time.monotonic()
    assert told(folder, *SWEEP).returncode == 1  # so coarse a grid is never certified
    (folder / "seconds").write_text(str(time.monotonic() - began))
