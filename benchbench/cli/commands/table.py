"""`benchbench table [DIR ...]`: runs, bundles of them too, as a table."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from benchbench.cli.arguments import Parser
from benchbench.ground.errors import BadInput, unknown_field
from benchbench.run.fitting import on_terminal
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
SHARED = ("machine", "certificate")
"""Columns beside those of the record where runs come from several places: whose they are, and whose word the verdict is."""

EXAMPLES = """examples
  benchbench table                                            short Markdown table of all runs below results
  benchbench table results other --output runs.parquet        every column
  benchbench table laptop.zip server.zip                      bundles of several machines; their plans are certified anew
  benchbench table --query "select solver, avg(solve_cpu_s) as s from runs where certified group by solver"
"""


def run(arguments: Sequence[str]) -> int:
    """Write the table to a file or stdout; raises BadInput."""
    from benchbench.cli.drawn_table import draw
    from benchbench.storage.describe import describe
    from benchbench.storage.files import write_bytes
    from benchbench.storage.formats import WRITERS
    from benchbench.storage.query import query

    asked = parser().parse_args(arguments)
    if asked.describe:
        sys.stdout.write(describe())
        return 0
    kind = _format(asked.format, asked.output)
    rows, shared = _rows(asked.folders, asked.as_recorded)
    rows = rows if asked.query is None else query(rows, asked.query)
    short = kind in READ_BY_PEOPLE and asked.query is None
    flown = short and rows["flights"].null_count < rows.num_rows
    usual = SHARED * shared + SHORT + FLOWN * flown
    rows = _choose(rows, asked.columns or (",".join(usual) if short else "all"))
    if asked.output is None and asked.format is None and on_terminal() and draw(rows):
        return 0
    data = WRITERS[kind](rows)
    if asked.output:
        write_bytes(asked.output, data)
        print(f"{rows.num_rows} rows in {asked.output}")
    else:
        sys.stdout.flush()
        sys.stdout.buffer.write(data)
    return 0


def _rows(places: Sequence[Path], trust: bool) -> tuple[pa.Table, bool]:
    """All runs, with the columns `SHARED` where they come from several places, as is told."""
    from benchbench.cli.gathering import gathered
    from benchbench.run.working import Working
    from benchbench.storage.bundle import is_bundle

    with Working("reading runs") as hear, gathered(places, hear, trust=trust) as found:
        rows = found.rows
    for path, problem in found.problems.items():
        complain("left out", f"{path}: {problem}")
    if found.said:
        complain("bundles", found.said)
    shared = len(places) > 1 or any(map(is_bundle, places))
    for name, texts in zip(SHARED, (found.machines, found.whose), strict=True) if shared else ():
        rows = rows.append_column(name, [texts])
    return rows, shared


def parser() -> Parser:
    """Return the arguments it takes."""
    takes = Parser(
        "table", "Write all runs below folders, or of bundles, as one table, a run per row.", EXAMPLES
    )
    takes.add_argument(
        "folders",
        nargs="*",
        type=Path,
        default=[Path("results")],
        metavar="DIR",
        help="folders with results, or bundles of them (default: results)",
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
    takes.add_argument(
        "--as-recorded",
        action="store_true",
        help="take the word of bundles: certify none of their plans anew",
    )
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
