"""The end of a sweep: how many plans are certified and how good they are, why the others are not, and where everything is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from statistics import median

from rich.console import Console
from rich.table import Table

from benchbench.analysis.suite import Row
from benchbench.cli.suite_summary import why
from benchbench.run.fitting import fitted
from benchbench.run.sweep_line import show_line
from benchbench.run.wording import above, near
from benchbench.sweep.rows import rows_of
from benchbench.sweep.sweep import Swept, shared

COLUMNS = (
    "config_hash", "scenario", "status", "reasons", "certified", "b_stationary", "travel_time_s", "objective", "gap_percent",
    "flights", "flights_succeeded", "intervals",
)  # fmt: skip
MOST = 20
"""Runs without a certified plan whose reason is told, and runs of earlier calls that are shown."""
Run = tuple[Swept, Row | None]


def conclude(swept: Sequence[Swept]) -> None:
    """Print it; the newest row of each run says how it ended."""
    rows = rows_of(swept, COLUMNS)
    common = shared([one.overrides for one in swept])
    runs: list[Run] = [
        (one, rows.get(one.place.labels["config_hash"]) if one.place else None) for one in swept
    ]
    _earlier(runs, common)
    console = Console(highlight=False)
    console.print(_table([row for _, row in runs if row]))
    for line in _failures(runs, common):
        print(fitted(line, 6))
    for root in dict.fromkeys(near(one.place.root) for one in swept if one.place):
        console.print(
            f"{'results':<9}{root}\n{'report':<9}benchbench report {root}", soft_wrap=True, markup=False
        )


def _earlier(runs: Sequence[Run], common: set[str]) -> None:
    """Rows of runs that were skipped."""
    found = [(one, row) for one, row in runs if one.earlier and row]
    for one, row in found[:MOST]:
        show_line(one.number, row, _told(one, common))
    if len(found) > MOST:
        print(f"      and {len(found) - MOST} more")


def _table(rows: Sequence[Row]) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for heading in ("scenario", "certified", "best", "gap to best known", "worst gap"):
        table.add_column(heading, justify="left" if heading == "scenario" else "right")
    for scenario in dict.fromkeys(row["scenario"] for row in rows):
        of = [row for row in rows if row["scenario"] == scenario]
        good = [row for row in of if row["certified"] is True]
        gaps = [row["gap_percent"] for row in good if row["gap_percent"] is not None]
        table.add_row(
            str(scenario), f"{len(good)} of {len(of)}", _best(good),
            f"median {above(median(gaps))}" if gaps else "-", above(max(gaps)) if gaps else "-",
        )  # fmt: skip
    return table


def _best(good: Sequence[Row]) -> str:
    """The least travel time, or the least objective of a problem that is no flight."""
    times = [row["travel_time_s"] for row in good if row["travel_time_s"] is not None]
    if times:
        return f"{min(times):.4f} s"
    objectives = [row["objective"] for row in good if row["objective"] is not None]
    return f"{min(objectives):.6g}" if objectives else "-"


def _failures(runs: Sequence[Run], common: set[str]) -> Iterator[str]:
    failed = [(one, row) for one, row in runs if row is None or row["certified"] is not True]
    for one, row in failed[:MOST]:
        yield f"{one.number:>4}  {row['status'] if row else 'bad_input'}: {why(row)}  ({_told(one, common)})"
    if len(failed) > MOST:
        yield f"      and {len(failed) - MOST} more, see the report"


def _told(one: Swept, common: set[str]) -> str:
    return " ".join(text for text in one.overrides if text not in common)
