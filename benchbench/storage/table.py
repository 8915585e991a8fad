"""The table: one row per run, as a folder of small Parquet files that any tool can open as one dataset.

Every run writes its own file, so concurrent runs never touch each other's rows and a killed run leaves
the earlier rows intact. `record.json` in each run's folder is the source; who reads runs takes it, and rows only of runs without
one (`benchbench.storage.collect`).
"""

from __future__ import annotations

import json
import logging
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pyarrow as pa

from benchbench.storage.files import write_bytes
from benchbench.storage.row_file import SCHEMA, read_rows, row_bytes
from benchbench.storage.schema import Record, make_record
from benchbench.storage.upgrade import upgraded

if TYPE_CHECKING:
    import pandas as pd

LOG = logging.getLogger(__name__)

TABLE = "table"
"""Name of the folder with the rows."""
UNUSABLE = (OSError, ValueError, TypeError, pa.ArrowException)
"""What reading a file that is no row or no record raises."""
BATCH = 1000
"""Rows that are turned into columns together: as dictionaries they take ten times the memory."""
_RUN_ID = re.compile(r"[\w][\w.+=-]*")


def append(record: Mapping[str, Any], root: Path) -> Path:
    """Add a run's record (or replace the row of the same `run_id`) and return the row's file.

    Raises ValueError when `run_id` is not usable as a file name, BadInput("output", ...) when the file
    system refuses.
    """
    run_id = record.get("run_id")
    if not isinstance(run_id, str) or not _RUN_ID.fullmatch(run_id):
        raise ValueError(f"run_id {run_id!r} is not a plain file name")
    path = folder(root) / f"{run_id}.parquet"
    write_bytes(path, row_bytes(record))
    return path


def read(root: Path) -> pd.DataFrame:
    """Return all rows, ordered by `run_id`, with every column of the schema, as `frame` does.

    A file that is no row is logged and left out.
    """
    return frame(_load(root))


def frame(rows: pa.Table) -> pd.DataFrame:
    """Return rows of the table for pandas: nullable integers and booleans, numbers by name as dictionaries."""
    import pandas as pd  # half a second, which a run that writes its row need not take

    nullable = {pa.int64(): pd.Int64Dtype(), pa.bool_(): pd.BooleanDtype()}
    return rows.to_pandas(types_mapper=nullable.get, maps_as_pydicts="lossy")


def added(root: Path, seen: set[str], columns: Sequence[str]) -> Iterator[dict[str, Any]]:
    """Give some columns of the rows whose files are not among those `seen` before, to which they are added.

    A file that is no row, or not yet, is passed over.
    """
    for path in _files(root):
        if path.name not in seen:
            seen.add(path.name)
            yield from _rows(path, columns)


def table_of(rows: Iterable[Mapping[str, Any]]) -> pa.Table:
    """Return rows, asked for one after the other, as columns."""
    parts, left = [SCHEMA.empty_table()], iter(rows)
    while some := list(islice(left, BATCH)):
        parts.append(pa.Table.from_pylist(some, SCHEMA))
    return pa.concat_tables(parts)


def folder(root: Path) -> Path:
    """Folder of the table below the folder of results."""
    return root / TABLE


def load_record(path: str | Path) -> Record:
    """Read a `record.json` of any schema version; raises OSError, ValueError or TypeError for anything else."""
    try:
        with open(path, "rb") as file:
            values = json.loads(file.read())
    except RecursionError:
        raise ValueError("nested too deeply for a record") from None
    if not isinstance(values, dict):
        raise TypeError("not a record")
    return make_record(**upgraded(values))


def _load(root: Path) -> pa.Table:
    return table_of(row for path in _files(root) for row in _rows(path))


def _files(root: Path) -> list[Path]:
    """The rows' files, in order."""
    try:
        names = sorted(name for name in os.listdir(folder(root)) if name.endswith(".parquet"))
    except OSError:
        return []
    return [folder(root) / name for name in names]


def _rows(path: Path, columns: Sequence[str] | None = None) -> list[Record]:
    """The rows of a file, none of one that is no row, as is said; a sweep may have replaced or removed it just now."""
    try:
        return read_rows(path, columns)
    except FileNotFoundError:
        return []
    except UNUSABLE as error:
        LOG.warning("left out %s, which is not a row of the table: %s", path, error)
        return []
