"""All runs below some folders, from whatever is there: records first, then rows of tables without a record."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from benchbench.errors import BadInput
from benchbench.storage.files import RECORD
from benchbench.storage.schema import Record
from benchbench.storage.table import SCHEMA, conform, load_record

Key = tuple[Any, Any]


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

    Rows are ordered by start, then `run_id`. Raises BadInput for a folder that does not exist.
    """
    for folder in folders:
        if not folder.is_dir():
            raise BadInput(str(folder), "there is no such folder", "folders with results, as runs write them")
    found: dict[Key, tuple[Record, Path | None]] = {}
    problems: dict[Path, str] = {}
    for record, place in _records(folders, problems):
        found.setdefault(_key(record), (record, place))
    for record in _rows(folders, problems):
        found.setdefault(_key(record), (record, None))
    order = sorted(found, key=lambda key: (str(key[1] or ""), str(key[0])))
    rows = pa.Table.from_pylist([found[key][0] for key in order], SCHEMA)
    return Collected(rows, tuple(found[key][1] for key in order), problems)


def _key(record: Record) -> Key:
    """What tells runs apart: results of two machines may use the same `run_id`."""
    return record["run_id"], record["started_at"]


def _records(folders: Sequence[Path], problems: dict[Path, str]) -> Iterator[tuple[Record, Path]]:
    for path in _files(folders, RECORD):
        try:
            yield load_record(path), path.parent
        except (OSError, ValueError, TypeError) as error:
            problems[path] = f"{type(error).__name__}: {error}"


def _rows(folders: Sequence[Path], problems: dict[Path, str]) -> Iterator[Record]:
    for path in _files(folders, "*.parquet"):
        try:
            with pq.ParquetFile(path) as file:
                table = file.read(use_threads=False)
            if "run_id" not in table.column_names:
                raise ValueError("a Parquet file that is no table of runs")
            rows = conform(table).to_pylist()
        except (OSError, ValueError, pa.ArrowException) as error:
            problems[path] = f"{type(error).__name__}: {error}"
        else:
            yield from rows


def _files(folders: Sequence[Path], pattern: str) -> list[Path]:
    return sorted({path.resolve(): path for folder in folders for path in folder.rglob(pattern)}.values())
