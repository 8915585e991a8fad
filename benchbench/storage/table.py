"""The table: one row per run, as a folder of small Parquet files that any tool can open as one dataset.

Every run writes its own file, so concurrent runs never touch each other's rows and a killed run leaves
the earlier rows intact. `record.json` in each run's folder is the source; the table can be rebuilt from it.
"""

from __future__ import annotations

import json
import logging
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pyarrow as pa
import pyarrow.parquet as pq
from pyarrow.json import ParseOptions, ReadOptions, read_json

from benchbench.storage.files import RECORD, write_bytes
from benchbench.storage.schema import COLUMNS, Record, make_record
from benchbench.storage.upgrade import GAPS, NOW, upgraded

if TYPE_CHECKING:
    import pandas as pd

LOG = logging.getLogger(__name__)

_ARROW = {
    "int": pa.int64(),
    "float": pa.float64(),
    "str": pa.string(),
    "bool": pa.bool_(),
    "strings": pa.list_(pa.string()),
    "numbers": pa.map_(pa.string(), pa.float64()),
}
_RUN_ID = re.compile(r"[\w][\w.+=-]*")

SCHEMA = pa.schema(
    [pa.field(c.name, _ARROW[c.type], metadata={"unit": c.unit, "meaning": c.meaning}) for c in COLUMNS]
)

_ITEMS = pa.list_(pa.struct([pa.field("key", pa.string(), nullable=False), pa.field("value", pa.float64())]))
_JSON = pa.schema([f.with_type(_ITEMS) if pa.types.is_map(f.type) else f for f in SCHEMA])


def append(record: Mapping[str, Any], root: Path) -> Path:
    """Add a run's record (or replace the row of the same `run_id`) and return the row's file.

    Raises ValueError when `run_id` is not usable as a file name, BadInput("output", ...) when the file
    system refuses.
    """
    run_id = record.get("run_id")
    if not isinstance(run_id, str) or not _RUN_ID.fullmatch(run_id):
        raise ValueError(f"run_id {run_id!r} is not a plain file name")
    path = folder(root) / f"{run_id}.parquet"
    write_bytes(path, _parquet(_row(record)))
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
    for path in sorted(path for path in folder(root).glob("*.parquet") if path.name not in seen):
        seen.add(path.name)
        try:
            with pq.ParquetFile(path) as file:
                row = file.read(columns=list(columns), use_threads=False)
        except (OSError, pa.ArrowException) as error:
            LOG.warning("left out %s, which is not a row of the table: %s", path, error)
            continue
        for values in row.to_pylist():
            yield {name: values.get(name) for name in columns}


def rebuild(root: Path) -> tuple[int, dict[Path, str]]:
    """Make the table again from all `record.json` below `root`.

    Returns the number of rows and, for each record that could not be used, the reason. Rows without a
    record are removed, but only if every record could be used.
    """
    earlier = set(folder(root).glob("*.parquet"))
    made: dict[Path, Path] = {}
    problems: dict[Path, str] = {}
    for source in sorted(root.rglob(RECORD)):
        try:
            path = append(load_record(source), root)
        except (OSError, ValueError, TypeError) as error:
            problems[source] = f"{type(error).__name__}: {error}"
            continue
        if path in made:
            problems[source] = f"same run_id as {made[path]}, whose row it replaced"
        made[path] = source
    if not problems:
        for orphan in earlier - made.keys():
            orphan.unlink(missing_ok=True)
    return len(made), problems


def export(root: Path, path: Path) -> None:
    """Write the whole table to one .parquet, .csv, .md or .tex file; raises BadInput for another suffix."""
    from benchbench.storage.formats import WRITERS, format_of  # pandas writes some of them

    write_bytes(path, WRITERS[format_of(path)](_load(root)))


def folder(root: Path) -> Path:
    """Folder of the table below the folder of results."""
    return root / "table"


def _load(root: Path) -> pa.Table:
    rows = [SCHEMA.empty_table()]
    for path in sorted(folder(root).glob("*.parquet")):
        try:
            with pq.ParquetFile(path) as file:
                row = file.read(use_threads=False)
            rows.append(row if row.schema.equals(SCHEMA) else conform(row))
        except (OSError, pa.ArrowException) as error:
            LOG.warning("left out %s, which is not a row of the table: %s", path, error)
    return pa.concat_tables(rows).cast(SCHEMA)


def conform(table: pa.Table) -> pa.Table:
    """Give rows of any schema version today's columns; what they do not have is empty."""
    gone = [name for name in GAPS if name in table.column_names]
    if gone:
        now = [upgraded(row) for row in table.select(gone).to_pylist()]
        for name in NOW:
            values = pa.array([row.get(name) for row in now], SCHEMA.field(name).type)
            table = table.append_column(name, values)
    columns = [
        table[field.name].cast(field.type)
        if field.name in table.column_names
        else pa.nulls(table.num_rows, field.type)
        for field in SCHEMA
    ]
    return pa.table(columns, schema=SCHEMA)


def load_record(path: Path) -> Record:
    """Read a `record.json` of any schema version; raises OSError, ValueError or TypeError for anything else."""
    try:
        values = json.loads(path.read_bytes())
    except RecursionError:
        raise ValueError("nested too deeply for a record") from None
    if not isinstance(values, dict):
        raise TypeError("not a record")
    return make_record(**upgraded(values))


def _row(record: Mapping[str, Any]) -> pa.Table:
    """A record as a row, by way of JSON: Table.from_pylist imports pandas. Raises ValueError for what the schema does not take."""
    numbers = {field.name for field in SCHEMA if pa.types.is_map(field.type)}
    values = {
        name: [{"key": key, "value": number} for key, number in value.items()]
        if name in numbers and value is not None
        else value
        for name, value in record.items()
    }
    text = json.dumps(values, allow_nan=False).encode()
    table = read_json(
        pa.BufferReader(text),
        ReadOptions(use_threads=False, block_size=len(text) + 1),
        ParseOptions(explicit_schema=_JSON, unexpected_field_behavior="ignore"),
    )
    return pa.table([_mapped(table[field.name], field) for field in SCHEMA], schema=SCHEMA)


def _mapped(column: pa.ChunkedArray, field: pa.Field) -> pa.ChunkedArray:
    """A column of JSON as the schema has it: Arrow reads no maps, only lists of their items."""
    if not pa.types.is_map(field.type):
        return column
    if column.null_count:
        return pa.chunked_array([pa.nulls(len(column), field.type)])
    items = column.chunk(0)
    return pa.chunked_array(
        [pa.MapArray.from_arrays(items.offsets, items.values.field(0), items.values.field(1))]
    )


def _parquet(table: pa.Table) -> bytes:
    """One row as Parquet without what only large files need: 6 kB instead of 22 kB."""
    sink = pa.BufferOutputStream()
    pq.write_table(
        table, sink, compression="none", use_dictionary=False, write_statistics=False, store_schema=False
    )
    return sink.getvalue().to_pybytes()
