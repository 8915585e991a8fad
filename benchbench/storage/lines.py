"""A CSV file of a plan as its lines of text: read as it is written, or refused."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path

from benchbench.ground.errors import BadInput

LARGEST = 500_000_000
"""Bytes of a file that is still read; a plan of 100 000 rows has 30 million."""
AT_ONCE = 1e-9
"""Rounding of a time that is said to be 0, s."""


def read_lines(path: Path) -> list[list[str]]:
    """Return header and rows, each with as many cells as the header; what is missing at the end of a row is empty.

    A mark of the byte order is no part of a name. Raises BadInput for a file that cannot be read or is too large, a name that is
    there twice, and a row that is longer than the header.
    """
    try:
        if path.stat().st_size > LARGEST:
            raise BadInput(str(path), f"is larger than {LARGEST / 1e6:g} MB", "a plan of fewer rows")
        with path.open(newline="", encoding="utf-8-sig") as file:
            return lines_of(file, str(path))
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(str(path), f"cannot be read: {error}", "a CSV file with a header") from None


def lines_of(text: Iterable[str], path: str) -> list[list[str]]:
    """Return header and rows of an open file, or of the lines of a text; path: what messages call it. Raises BadInput as above."""
    try:
        lines = [line for line in csv.reader(text, skipinitialspace=True) if line]
    except csv.Error as error:
        raise BadInput(path, f"cannot be read: {error}", "a CSV file with a header") from None
    header = [name.strip() for name in lines[0]] if lines else []
    check_once(header, path)
    for number, row in enumerate(lines[1:], 2):
        if len(row) > len(header):
            problem = f"has {len(row)} cells, the header has {len(header)}"
            raise BadInput(f"{path}, line {number}", problem, "as many cells as the header has names")
    return [header, *(row + [""] * (len(header) - len(row)) for row in lines[1:])]


def check_once(names: Sequence[str], where: str) -> None:
    """Raise BadInput for a name that is there twice: nobody knows which one is meant."""
    seen = set[str]()
    for name in names:
        if name in seen:
            raise BadInput(where, f"has two columns {name}", "each name once")
        seen.add(name)


def check_start(time: float, place: str) -> None:
    """Raise BadInput for a plan that does not start at 0 s, when the task begins: targets move with time."""
    if abs(time) > AT_ONCE:
        problem = f"starts at {time:g} s"
        raise BadInput(
            place, problem, "0, when the task begins; subtract it from all times where that is meant"
        )
