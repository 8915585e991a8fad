"""Races compared: a row for each way to plan and grid, a column for each number of gates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from benchbench.analysis.costs import plan_time
from benchbench.analysis.naming import options
from benchbench.storage.settings import Settings

GRID = ("scenario.gates", "scenario.nodes_per_gate")
"""Fields that have a column or a cell of their own."""


@dataclass(frozen=True)
class Cell:
    """Runs of one kind on one race; medians, the worst error of the replay (None: none has a plan)."""

    runs: int
    certified: int
    travel_time_s: float | None
    cpu_s: float | None
    error_m: float | None
    reasons: Sequence[str]
    """Why runs are not certified, or how they ended, each once."""


@dataclass(frozen=True)
class RaceRow:
    """How the races were planned: dynamics and what else differs, vehicle, nodes per gate; cells by gates before the end."""

    method: str
    race: str
    nodes: int
    cells: Mapping[int, Cell]


def races(runs: pd.DataFrame, settings: Sequence[Settings | None]) -> list[RaceRow]:
    """Return the table; empty without races.

    runs: named, see `benchbench.analysis.naming.name_runs`; a race is a run that knows its gates.
    """
    known = runs.gates.notna() & runs.intervals.notna()
    on = [i for i, here in enumerate(known) if here]
    if not on:
        return []
    raced = runs[known].assign(race=_named(runs, settings, on), cpu=plan_time(runs)[known])
    raced = raced.assign(
        method=[m if m.startswith(d) else f"{d} / {m}" for d, m in zip(raced.dynamics.fillna(""), raced.method, strict=True)],
        nodes=raced.intervals.astype(int) // (raced.gates.astype(int) + 1),
    )  # fmt: skip
    rows = raced[["method", "race", "nodes"]].drop_duplicates().sort_values(["method", "race", "nodes"])
    return [_row(raced, *row) for row in rows.itertuples(index=False, name=None)]


def _row(raced: pd.DataFrame, method: str, race: str, nodes: int) -> RaceRow:
    mine = raced[(raced.method == method) & (raced.race == race) & (raced.nodes == nodes)]
    gates = sorted(set(mine.gates.astype(int)))
    return RaceRow(method, race, nodes, {count: _cell(mine[mine.gates == count]) for count in gates})


def _named(runs: pd.DataFrame, settings: Sequence[Settings | None], on: Sequence[int]) -> list[str]:
    """Vehicle, and the options in which these races differ, gates and grid apart."""
    told = options(
        settings, on, lambda name: name.startswith(("scenario.", "certificate.")) and name not in GRID
    )
    return [
        " ".join(filter(None, (str(runs.vehicle.iloc[i]), text))) for i, text in zip(on, told, strict=True)
    ]


def _cell(same: pd.DataFrame) -> Cell:
    certified = same.certified.fillna(False).astype(bool)
    reasons = [_reason(row) for row in same[~certified].to_dict("records")]
    return Cell(
        len(same),
        int(certified.sum()),
        _known(same.travel_time_s.astype(float).median()),
        _known(same.cpu.astype(float).median()),
        _known(same.replay_drift_position_m.astype(float).max()),
        list(dict.fromkeys(reasons)),
    )


def _reason(row: Mapping[Any, Any]) -> str:
    reasons = row["reasons"]
    return str(reasons[0]) if reasons is not None and len(reasons) else str(row["status"])


def _known(value: float) -> float | None:
    return None if pd.isna(value) else float(value)
