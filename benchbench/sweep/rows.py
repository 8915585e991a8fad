"""What the table has of the runs of a sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from benchbench.analysis.front import Candidate, candidate
from benchbench.sweep.sweep import Swept

Row = Mapping[str, Any]
FLOWN = (
    "certified", "travel_time_s", "flights", "flights_succeeded", "flights_low_exact", "flights_low", "flights_high",
    "flight_reasons", "config_hash",
)  # fmt: skip


def rows_of(swept: Sequence[Swept], columns: Sequence[str]) -> dict[str, Row]:
    """Return the newest row of each run that took part, by its hash."""
    from benchbench.storage.table import added

    found: dict[str, Row] = {}
    wanted = {one.place.labels["config_hash"] for one in swept if one.place}
    for root in {one.place.root for one in swept if one.place}:
        for row in added(root, set(), (*columns, "started_at")):
            old = found.get(row["config_hash"])
            if row["config_hash"] in wanted and (old is None or _began(old) <= _began(row)):
                found[row["config_hash"]] = row
    return found


def _began(row: Row) -> str:
    return row["started_at"] or ""


def candidates(swept: Sequence[Swept]) -> list[Candidate]:
    """Return the certified plans that were flown, in the order of their runs, asked for by all their overrides."""
    rows = rows_of(swept, FLOWN)
    return [
        found
        for one in swept
        if one.place
        and (row := rows.get(one.place.labels["config_hash"]))
        and (found := candidate(one.overrides, row))
    ]
