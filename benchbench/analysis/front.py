"""Which plans are worth flying: travel time against the success that flights prove."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

Row = Mapping[str, Any]


@dataclass(frozen=True)
class Candidate:
    """A certified plan that was flown: how it was asked for, its travel time in s, its flights.

    low: rate that its flights prove, exact and one-sided; interval: Wilson's, two-sided; reasons: against how many
    """

    overrides: tuple[str, ...]
    travel_time: float
    flights: int
    succeeded: int
    low: float
    interval: tuple[float, float]
    reasons: Mapping[str, int]

    @property
    def rate(self) -> float:
        """Share of flights that succeeded."""
        return self.succeeded / self.flights


def candidate(overrides: Sequence[str], row: Row) -> Candidate | None:
    """Return a row of the table as a candidate; None where no plan was certified and flown."""
    if row["certified"] is not True or not row["flights"]:
        return None
    return Candidate(
        tuple(overrides), float(row["travel_time_s"]), int(row["flights"]), int(row["flights_succeeded"]),
        float(row["flights_low_exact"]), (float(row["flights_low"]), float(row["flights_high"])),
        {name: int(count) for name, count in dict(row["flight_reasons"] or ()).items()},
    )  # fmt: skip


def front(found: Sequence[Candidate]) -> list[Candidate]:
    """Return those that no other beats in travel time and success rate, the fastest first."""
    kept: list[Candidate] = []
    for one in sorted(found, key=lambda c: (c.travel_time, -c.rate)):
        if not kept or one.rate > kept[-1].rate:
            kept.append(one)
    return kept


def fastest(found: Sequence[Candidate], target: float) -> Candidate | None:
    """Return the fastest plan whose flights prove the target; None without one."""
    return min((one for one in found if one.low >= target), key=lambda one: one.travel_time, default=None)
