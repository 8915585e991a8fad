"""`benchbench table [DIR ...]`: all runs as a table: text, CSV, Parquet."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from benchbench.cli.arguments import Parser
from benchbench.errors import BadInput, unknown_field
from benchbench.run.telling import complain

if TYPE_CHECKING:
    import pyarrow as pa

SHORT = (
    "scenario", "intervals", "kappa_init", "dynamics", "relaxation", "solver", "strategy", "status",
    "travel_time_s", "gap_percent", "iterations", "solve_cpu_s", "replay_defect_position_m",
)  # fmt: skip
"""Columns that fit on a page, for the formats people read."""
FLOWN = ("residual", "mismatch", "flights", "flights_succeeded", "flights_low_exact", "flight_error_before_m")
"""Those beside them where plans were flown."""
READ_BY_PEOPLE = ("markdown", "latex")

EXAMPLES = """examples
  benchbench table                                            short Markdown table of all runs below results
  benchbench table results other --output runs.parquet        every column
  benchbench table --query "select solver, avg(solve_cpu_s) as s from runs where certified group by solver"
"""


def run(arguments: Sequence[str]) -> int:
    """Write the table to a file or stdout; raises BadInput."""
    from benchbench.storage.collect import collect
    from benchbench.storage.describe import describe
    from benchbench.storage.files import write_bytes
    from benchbench.storage.formats import WRITERS
    from benchbench.storage.query import query

    asked = parser().parse_args(arguments)
    if asked.describe:
        sys.stdout.write(describe())
        return 0
    kind = _format(asked.format, asked.output)
    found = collect(asked.folders)
    for path, problem in found.problems.items():
        complain("left out", f"{path}: {problem}")
    rows = found.rows if asked.query is None else query(found.rows, asked.query)
    short = kind in READ_BY_PEOPLE and asked.query is None
    flown = short and rows["flights"].null_count < rows.num_rows
    rows = _choose(rows, asked.columns or (",".join(SHORT + (FLOWN if flown else ())) if short else "all"))
    data = WRITERS[kind](rows)
    if asked.output:
        write_bytes(asked.output, data)
        print(f"{rows.num_rows} rows in {asked.output}")
    else:
        sys.stdout.flush()
        sys.stdout.buffer.write(data)
    return 0


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser("table", "Write all runs below the folders as one table, a run per row.", EXAMPLES)
    takes.add_argument(
        "folders",
        nargs="*",
        type=Path,
        default=[Path("results")],
        metavar="DIR",
        help="folders with results (default: results)",
    )
    takes.add_argument(
        "--format",
        choices=["parquet", "csv", "markdown", "latex"],
        help="default: what the name of the output asks for, else markdown",
    )
    takes.add_argument("--output", type=Path, metavar="FILE", help="default: standard output")
    takes.add_argument(
        "--columns",
        metavar="A,B,...",
        help="columns to write, or all (default: all, a short choice for markdown and latex)",
    )
    takes.add_argument("--query", metavar="SQL", help="DuckDB SQL over the table 'runs'")
    takes.add_argument("--describe", action="store_true", help="print what the columns mean")
    return takes  # fmt: skip


def _format(asked: str | None, output: Path | None) -> str:
    from benchbench.storage.formats import format_of

    kind = asked or (format_of(output) if output else "markdown")
    if kind == "parquet" and output is None and sys.stdout.isatty():
        raise BadInput("--output", "Parquet is nothing to read on a terminal", "a file name")
    return kind


def _choose(rows: pa.Table, columns: str) -> pa.Table:
    names = rows.column_names if columns == "all" else [name.strip() for name in columns.split(",")]
    for name in names:
        if name not in rows.column_names:
            raise unknown_field(f"--columns {name}", rows.column_names)
    return rows.select(names)
