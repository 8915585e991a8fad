"""Records that have no row: a run that was killed between the two has all it promises, and gets its row."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from benchbench.storage.files import CONFIG, PLAN, RECORD, SOLUTION, run_name
from benchbench.storage.table import TABLE, UNUSABLE, append, folder, load_record


def adopt(root: Path) -> dict[str, Path]:
    """Give each record below a folder of results its row, and return the runs' folders by `run_id`.

    A folder of results inside it keeps its runs. A record that cannot be used has none. Raises BadInput when the disk refuses.
    """
    rows = {path.stem for path in folder(root).glob("*.parquet")}
    found: dict[str, Path] = {}
    for place in _recorded(root):
        name = run_name(place, root)
        if name not in rows:
            try:
                record = load_record(place / RECORD)
                name = str(record["run_id"])
                if name not in rows:
                    append(record, root)
            except UNUSABLE:
                continue
        found[name] = place
    return found


def whole(place: Path, record: Mapping[str, Any]) -> bool:
    """Whether a run's folder has what its record, or row, promises: the plan that it judges, or the solution of an MPCC."""
    if record["travel_time_s"] is not None:
        wanted = (CONFIG, PLAN)
    elif record["objective"] is not None:
        wanted = (CONFIG, SOLUTION)
    else:
        return True
    return all((place / name).is_file() for name in wanted)


def _recorded(root: Path) -> Iterator[Path]:
    """Folders with a record below a folder of results."""
    for here, below, names in os.walk(root):
        if Path(here) != root and TABLE in below:
            below.clear()
            continue
        below[:] = [name for name in below if name != ".hydra"]
        if RECORD in names:
            yield Path(here)
