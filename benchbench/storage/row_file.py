"""One row of the table as a file: Parquet for any tool, and the same record as JSON in its footer for ourselves.

Parquet takes 1 ms to open a file of a hundred columns, whatever is in it; the JSON takes a twentieth of that.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
from pyarrow.json import ParseOptions, ReadOptions, read_json

from benchbench.storage.schema import COLUMNS, Record, make_record
from benchbench.storage.upgrade import GAPS, NOW, upgraded

_ARROW = {
    "int": pa.int64(),
    "float": pa.float64(),
    "str": pa.string(),
    "bool": pa.bool_(),
    "strings": pa.list_(pa.string()),
    "numbers": pa.map_(pa.string(), pa.float64()),
}
SCHEMA = pa.schema(
    [pa.field(c.name, _ARROW[c.type], metadata={"unit": c.unit, "meaning": c.meaning}) for c in COLUMNS]
)
_ITEMS = pa.list_(pa.struct([pa.field("key", pa.string(), nullable=False), pa.field("value", pa.float64())]))
_JSON = pa.schema([f.with_type(_ITEMS) if pa.types.is_map(f.type) else f for f in SCHEMA])
KEY, MARK = "benchbench", b"benchbench.record:"
"""Name of the text in the footer, and how it begins."""
MAGIC, TAIL = b"PAR1", 8
"""What a Parquet file ends with, after four bytes with the length of its footer."""
_DECODER = json.JSONDecoder()


def row_bytes(record: Mapping[str, Any]) -> bytes:
    """Return a file of one row, without what only large files need; raises ValueError for NaN or infinity."""
    given = {name: value for name, value in record.items() if value is not None}
    said, mark = json.dumps(given, allow_nan=False, separators=(",", ":")), MARK.decode()
    text = mark + said.replace(mark, mark[:-1] + r"\u003a")  # so that the last mark in the file is ours
    sink, row = pa.BufferOutputStream(), _row(record)
    small: dict[str, Any] = {"compression": "none", "use_dictionary": False, "write_statistics": False}
    with pq.ParquetWriter(sink, SCHEMA, store_schema=False, **small) as file:
        file.write_table(row)
        file.add_key_value_metadata({KEY: text})
    return sink.getvalue().to_pybytes()


def read_rows(path: str | Path, columns: Sequence[str] | None = None) -> list[Record]:
    """Return the records of a Parquet file of rows, of one row or many and of any schema version.

    columns: those that are needed; others may be empty. Raises OSError, ValueError, TypeError or ArrowException for what is no
    such file.
    """
    with open(path, "rb") as file:
        data = file.read()
    said = _said(data)
    if said is not None:
        wanted = said if columns is None else {name: said[name] for name in columns if name in said}
        with contextlib.suppress(
            ValueError, TypeError
        ):  # a later version's: Parquet knows what of it is ours
            return [make_record(**upgraded(wanted))]
    with pq.ParquetFile(pa.BufferReader(data)) as parquet:
        table = parquet.read(columns=columns, use_threads=False)
    if "run_id" not in table.column_names:
        raise ValueError("a Parquet file that is no table of runs")
    return conform(table).to_pylist()


def conform(table: pa.Table) -> pa.Table:
    """Give rows of any schema version today's columns; what they do not have is empty."""
    if table.schema.equals(SCHEMA):
        return table
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


def _said(data: bytes) -> dict[str, Any] | None:
    """The record in the footer of a whole file, None where there is none to be read."""
    if len(data) < TAIL or not data.startswith(MAGIC) or not data.endswith(MAGIC):
        return None
    footer = data[-TAIL - int.from_bytes(data[-TAIL : -len(MAGIC)], "little") : -TAIL]
    place = footer.rfind(MARK)
    if place < 0:
        return None
    try:
        said, _ = _DECODER.raw_decode(footer.decode("latin-1"), place + len(MARK))  # the JSON is ASCII
    except (ValueError, RecursionError):
        return None
    return said if isinstance(said, dict) else None
