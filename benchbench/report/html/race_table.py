"""The table of races as plain texts: dynamics and method by number of gates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from benchbench.analysis.races import RaceRow


@dataclass(frozen=True)
class RaceCell:
    """Lines of a cell of the table of races, "good" or "bad" where it holds runs, what a pointer shows."""

    lines: Sequence[str]
    verdict: str = ""
    hint: str = ""


def race_rows(rows: Sequence[RaceRow]) -> tuple[list[int], list[list[RaceCell]]]:
    """Numbers of gates, and for each row method, vehicle and nodes per gate, then a cell for each number of gates."""
    gates = sorted({count for row in rows for count in row.cells})
    names = [[RaceCell((text,)) for text in (row.method, row.race, str(row.nodes))] for row in rows]
    return gates, [
        [*name, *(_race_cell(row, n) for n in gates)] for name, row in zip(names, rows, strict=True)
    ]


def _race_cell(row: RaceRow, gates: int) -> RaceCell:
    cell = row.cells.get(gates)
    if cell is None:
        return RaceCell(("",))
    lines = [
        f"{value:.{digits}f} {unit}"
        for value, digits, unit in (
            (cell.travel_time_s, 4, "s"),
            (cell.cpu_s, 2, "s CPU"),
            (None if cell.error_m is None else 1e3 * cell.error_m, 2, "mm"),
        )
        if value is not None
    ]
    count = "" if cell.runs == 1 else f"{cell.certified} of {cell.runs} "
    good = cell.certified == cell.runs
    verdict = "certified" if good or cell.certified else "not certified"
    return RaceCell(
        (*lines, count * bool(cell.certified) + verdict), "good" if good else "bad", "; ".join(cell.reasons)
    )
