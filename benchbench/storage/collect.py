"""All runs below some folders, from whatever is there: records first, then rows of tables without a record."""

from __future__ import annotations

import gc
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import pyarrow as pa

from benchbench.ground.errors import BadInput
from benchbench.storage.files import RECORD
from benchbench.storage.row_file import read_rows
from benchbench.storage.schema import Record
from benchbench.storage.table import TABLE, UNUSABLE, load_record, table_of

Key = tuple[Any, Any]
ROW = ".parquet"


@dataclass(frozen=True)
class Collected:
    """What was found: the rows, each run's folder (None for a row whose folder is not there), broken files.

    `problems` says of each file that could not be used what is wrong with it.
    """

    rows: pa.Table
    folders: tuple[Path | None, ...]
    problems: dict[Path, str]


def collect(folders: Sequence[Path]) -> Collected:
    """Read every `record.json` and every Parquet table below the folders; a run found twice counts once.

    Rows are ordered by start, then `run_id`. A file that a sweep replaces or removes meanwhile is read before or after, or is
    not there. Raises BadInput for a folder that does not exist.
    """
    for place in folders:
        if not place.is_dir():
            raise BadInput(str(place), "there is no such folder", "folders with results, as runs write them")
    reader = _Reader()
    with _no_cycles():
        rows = table_of(reader.read(folders))
    order = sorted(range(len(reader.found)), key=lambda i: _order(reader.found[i][0]))
    return Collected(
        rows.take(pa.array(order, pa.int64())), tuple(reader.found[i][1] for i in order), reader.problems
    )


@final
class _Reader:
    """Gives each run once; `found` has its key and folder."""

    def __init__(self) -> None:
        self.found: list[tuple[Key, Path | None]] = []
        self.problems: dict[Path, str] = {}
        self._keys: set[Key] = set()

    def read(self, folders: Sequence[Path]) -> Iterator[Record]:
        """Records, then rows without one: a row of the same table and name is made of the record."""
        files = _files(folders)
        recorded: dict[str, list[str]] = {}
        for real, path in files.items():
            if not path.endswith(ROW):
                for record in self._told(path):
                    recorded.setdefault(f"{record['run_id']}{ROW}", []).append(real)
                    yield from self._once(record, Path(path).parent)
        for real, path in files.items():
            if path.endswith(ROW) and not _is_made_of(real, recorded):
                for record in self._told(path):
                    yield from self._once(record, None)

    def _told(self, path: str) -> list[Record]:
        try:
            return read_rows(path) if path.endswith(ROW) else [load_record(path)]
        except FileNotFoundError:
            return []
        except UNUSABLE as error:
            self.problems[Path(path)] = f"{type(error).__name__}: {error}"
            return []

    def _once(self, record: Record, place: Path | None) -> Iterator[Record]:
        key = record["run_id"], record["started_at"]  # results of two machines may use the same `run_id`
        if key not in self._keys:
            self._keys.add(key)
            self.found.append((key, place))
            yield record


@contextmanager
def _no_cycles() -> Iterator[None]:
    """Look for no garbage meanwhile: records have no cycles, and searching among so many takes half of all time."""
    before = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if before:
            gc.enable()


def _is_made_of(row: str, recorded: Mapping[str, Sequence[str]]) -> bool:
    """Whether a record of a row's name lies in the folder of results whose table the row is in; recorded: by that name."""
    table, _, name = row.rpartition(os.sep)
    root, _, last = table.rpartition(os.sep)
    return last == TABLE and any(record.startswith(root + os.sep) for record in recorded.get(name, ()))


def _order(key: Key) -> tuple[str, str]:
    return str(key[1] or ""), str(key[0])


def _files(folders: Sequence[Path]) -> dict[str, str]:
    """Records and Parquet files below the folders, each once, by where they really lie, in that order."""
    found: dict[str, str] = {}
    for place in map(str, folders):
        above = os.path.realpath(place)
        for here, below, names in os.walk(place):
            below[:] = [name for name in below if name != ".hydra"]  # half of all folders, and no results
            for name in names:
                if name == RECORD or name.endswith(ROW):
                    path = f"{here}/{name}"
                    real = os.path.realpath(path) if os.path.islink(path) else above + path[len(place) :]
                    found.setdefault(real, path)
    return dict(sorted(found.items()))
