"""A table of runs as bytes in each file format: Parquet, CSV, Markdown, LaTeX.

Text formats join lists (`reasons`) by "; "; Markdown and LaTeX round to six digits and leave out empty columns.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv
import pyarrow.parquet as pq

from benchbench.ground.errors import BadInput, Unavailable

SUFFIXES = {".parquet": "parquet", ".csv": "csv", ".md": "markdown", ".tex": "latex"}


def format_of(path: Path) -> str:
    """Name of the format that a file name asks for; raises BadInput for an unknown suffix."""
    if path.suffix not in SUFFIXES:
        allowed = "a file name that ends in " + ", ".join(SUFFIXES)
        raise BadInput("output", f"cannot tell the format of '{path.name}'", allowed)
    return SUFFIXES[path.suffix]


def parquet(table: pa.Table) -> bytes:
    """The table as it is, with the unit and meaning of each column in its schema."""
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink)
    return sink.getvalue().to_pybytes()


FORMULA = r"^([=+\-@\t\r])"
"""How a cell begins that a spreadsheet runs as a formula."""


def csv(table: pa.Table) -> bytes:
    """Comma-separated values at full precision, with a header; UTF-8.

    Text that a spreadsheet would run as a formula gets an apostrophe in front.
    """
    flat, sink = _flat(table), pa.BufferOutputStream()
    for place, field in enumerate(flat.schema):
        if pa.types.is_string(field.type):
            harmless = pc.replace_substring_regex(flat.column(place), FORMULA, r"'\1")
            flat = flat.set_column(place, field.name, harmless)
    pyarrow.csv.write_csv(flat, sink)
    return sink.getvalue().to_pybytes()


def markdown(table: pa.Table) -> bytes:
    """A table as GitHub shows it."""
    rows = texts(table)
    lines = [rows.columns.tolist(), ["---"] * rows.shape[1], *rows.to_numpy().tolist()]
    escaped = [[text.replace("|", "\\|") for text in line] for line in lines]
    return "".join(f"| {' | '.join(line)} |\n" for line in escaped).encode()


def latex(table: pa.Table) -> bytes:
    """A tabular for the package booktabs, escaped. Raises Unavailable where jinja2 is not installed."""
    rows = texts(table)
    sides = "".join("r" if _is_number(table.schema.field(name).type) else "l" for name in rows)
    try:
        return rows.to_latex(index=False, escape=True, column_format=sides).encode()
    except ImportError as error:
        raise Unavailable(f"LaTeX: {error.name} is not installed; pip install 'benchbench[report]'") from None


WRITERS: dict[str, Callable[[pa.Table], bytes]] = {
    "parquet": parquet, "csv": csv, "markdown": markdown, "latex": latex,
}  # fmt: skip


def _flat(table: pa.Table) -> pa.Table:
    """Lists, and numbers by name, joined, since a text format has neither."""
    for place, field in enumerate(table.schema):
        if pa.types.is_list(field.type) or pa.types.is_map(field.type):
            joined = [_joined(value) for value in table.column(place).to_pylist()]
            table = table.set_column(place, field.name, pa.array(joined, pa.string()))
    return table


def _joined(values: list[Any] | None) -> str | None:
    """Texts, or pairs of a name and a number, in one text."""
    if values is None:
        return None
    return "; ".join(f"{one[0]} {one[1]}" if isinstance(one, tuple) else str(one) for one in values)


def texts(table: pa.Table) -> pd.DataFrame:
    """What people read: every cell a short text, no empty column."""
    used = [name for name in table.column_names if table[name].null_count < table.num_rows]
    rows = _flat(table).select(used)
    return pd.DataFrame(
        {name: [_cell(value) for value in rows[name].to_pylist()] for name in used}, dtype=str
    )


def _cell(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else " ".join(str(value).split())


def _is_number(kind: pa.DataType) -> bool:
    return bool(pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_decimal(kind))
