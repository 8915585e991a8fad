"""Whole runs of a folder of results: which there are, taking some away, taking in those of other folders."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from benchbench.ground.errors import BadInput
from benchbench.storage.collect import collect
from benchbench.storage.files import RECORD, write_record
from benchbench.storage.schema import Record
from benchbench.storage.table import append, folder


@dataclass(frozen=True)
class StoredRun:
    """A run: its record, and its folder, None where only its row is left."""

    record: Record
    folder: Path | None

    @property
    def name(self) -> str:
        """What the run is called, its `run_id`."""
        return str(self.record["run_id"])


def stored(root: Path) -> list[StoredRun]:
    """Return all runs below a folder of results, by start; raises BadInput where there is no such folder."""
    found = collect([root])
    return [
        StoredRun(*run)
        for run in zip(found.rows.to_pylist(maps_as_pydicts="strict"), found.folders, strict=True)
    ]


def remove(root: Path, names: Sequence[str]) -> list[StoredRun]:
    """Remove the folders and rows of runs by `run_id` or folder and return them; raises BadInput for a name that is no run's.

    Nothing is removed unless every name is known.
    """
    runs = stored(root)
    chosen = [_named(name, runs) for name in names]
    for run in chosen:
        if run.folder is not None:
            shutil.rmtree(run.folder)
        (folder(root) / f"{run.name}.parquet").unlink(missing_ok=True)
    return chosen


def merge(root: Path, others: Sequence[Path]) -> list[Path]:
    """Copy the runs of other folders of results into `root` and return their new folders; those that are there already stay.

    Two runs are the same where `run_id` and start are. A name that another run has already gets a number.
    """
    root.mkdir(parents=True, exist_ok=True)
    here = {run.name: run.record["started_at"] for run in stored(root)}
    made = []
    for other in others:
        for run in stored(other):
            if run.folder is None or here.get(run.name) == run.record["started_at"]:
                continue
            name = _free(run.name, here)
            place = root / "runs" / "merged" / name
            shutil.copytree(run.folder, place, ignore=shutil.ignore_patterns(RECORD))
            record = {**run.record, "run_id": name}
            write_record(place, record)
            append(record, root)
            here[name] = run.record["started_at"]
            made.append(place)
    return made


def _named(name: str, runs: Sequence[StoredRun]) -> StoredRun:
    for run in runs:
        if run.name == name or (run.folder is not None and run.folder.resolve() == Path(name).resolve()):
            return run
    raise BadInput(
        name, "is no run of this folder", "a run_id or a run's folder, as `benchbench runs` lists them"
    )


def _free(name: str, taken: dict[str, str]) -> str:
    numbered = (f"{name}.{i}" for i in range(2, len(taken) + 3))
    return name if name not in taken else next(new for new in numbered if new not in taken)
