"""What a method did on the tasks of a suite, from their records."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

from benchbench.analysis.wilson import Rate, wilson
from benchbench.storage.best_known import beats, cost

CPU = ("build_cpu_s", "solve_cpu_s", "certificate_cpu_s")
MOST = 0.95
Row = Mapping[str, Any]


@dataclass(frozen=True)
class Outcome:
    """How one method did; of a task without a record (it was refused) the row is None, which counts as not certified.

    certified       of how many tasks, with its interval
    statuses        how many tasks ended how
    cpu_median_s    CPU time of build, solve and check; None where more than half of the tasks do not say
    cpu_most_s      what 95 % of the tasks stay within; None where more than 5 % do not say
    gap_median      %, of certified tasks with a best known value: how far above it
    gap_worst       %
    compared        how many those are
    better          tasks whose plan is the first known, or better than the best known
    bound_median    %, of certified tasks with a proven lower bound above 0: how far above it
    bounded         how many those are
    level_median    %, of the same above the larger of that and of the bound for level flights
    """

    certified: Rate
    statuses: dict[str, int]
    cpu_median_s: float | None
    cpu_most_s: float | None
    gap_median: float | None
    gap_worst: float | None
    compared: int
    better: int
    bound_median: float | None
    bounded: int
    level_median: float | None


def outcome(rows: Sequence[Row | None]) -> Outcome:
    """Return it of the records of all tasks, one each."""
    certified = [row for row in rows if row and row["certified"] is True]
    costs = sorted(cpu(row) for row in rows)
    gaps = [row["gap_percent"] for row in certified if row["gap_percent"] is not None]
    level = [gap for row in certified if (gap := above_bound(row, level=True)) is not None]
    above = [gap for row in certified if (gap := above_bound(row)) is not None]
    return Outcome(
        wilson(len(certified), len(rows)),
        dict(Counter(str(row["status"]) if row else "bad_input" for row in rows).most_common()),
        _at(costs, 0.5), _at(costs, MOST),
        median(gaps) if gaps else None, max(gaps, default=None), len(gaps), sum(map(_better, certified)),
        median(above) if above else None, len(above), median(level) if level else None,
    )  # fmt: skip


def cpu(row: Row | None) -> float:
    """Seconds of CPU that a task took in build, solve and check; infinite where the record does not say."""
    parts = [row[name] if row else None for name in CPU]
    return sum(math.inf if part is None else float(part) for part in parts)


def above_bound(row: Row, level: bool = False) -> float | None:
    """How far the travel time is above the proven bound, %; None where there is none that says anything.

    level: above that for flights whose nose is turned by yaw torque alone, where there is one.
    """
    bound, time = row["lower_bound_s"], row["travel_time_s"]
    if level and row["level_bound_s"] is not None:
        bound = row["level_bound_s"]
    return 100 * (time / bound - 1) if bound and time is not None else None


def _better(row: Row) -> bool:
    found = cost(row)
    best = row["best_known_s"] if row["best_known_s"] is not None else row.get("best_known_objective")
    return bool(row["task_hash"]) and found is not None and beats(found, best)


def _at(costs: Sequence[float], share: float) -> float | None:
    """The smallest of the sorted costs that so large a share of all stays within."""
    found = costs[math.ceil(share * len(costs)) - 1] if costs else math.inf
    return found if math.isfinite(found) else None
