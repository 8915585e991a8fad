"""A table of runs for a terminal: what is the same in all rows is told once, and columns that do not fit are named."""

from __future__ import annotations

import pyarrow as pa
from rich.console import Console
from rich.table import Table
from rich.text import Text

from benchbench.run.fitting import fitted
from benchbench.storage.formats import texts

MOST, WIDEST, GAP = 1000, 24, 2
"""Rows that are drawn, characters of a cell in a line, spaces between columns."""


def draw(rows: pa.Table) -> bool:
    """Print it, unless it has so many rows that nobody looks; returns whether it did."""
    if rows.num_rows > MOST:
        return False
    cells = {str(name): column.tolist() for name, column in texts(rows).items()}
    same = [name for name, column in cells.items() if len(column) > 1 and len({*column}) == 1]
    if same:
        told = ", ".join(f"{_said(name)} {cells[name][0]}" for name in same)
        print(fitted(f"the same in all {rows.num_rows} rows: {told}", 2))
    left = {name: column for name, column in cells.items() if name not in same}
    console, widths = Console(highlight=False), {name: _width(name, column) for name, column in left.items()}
    fits: dict[str, list[str]] = {}
    used = 0
    for name, width in widths.items():
        used += width + GAP
        if used <= console.width + GAP or not fits:
            fits[name] = left[name]
    _print(fits, widths, console)
    if lost := [_said(name) for name in left if name not in fits]:
        print(fitted(f"no room for: {', '.join(lost)}; --columns A,B,... chooses, --output FILE has all", 2))
    return True


def _print(cells: dict[str, list[str]], widths: dict[str, int], console: Console) -> None:
    table = Table(box=None, pad_edge=False, padding=(0, GAP, 0, 0))
    for name in cells:
        table.add_column(_said(name), width=widths[name])
    for line in zip(*cells.values(), strict=True):
        table.add_row(*map(Text, line))
    console.print(table)


def _width(name: str, column: list[str]) -> int:
    """Of the longest word of its head, and of its cells up to `WIDEST`, beyond which those go on below."""
    return max(*map(len, _said(name).split()), min(WIDEST, max(map(len, column), default=0)))


def _said(name: str) -> str:
    return name.replace("_", " ")
