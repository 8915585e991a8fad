"""Which plans are worth flying: travel time against the success that flights prove."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from benchbench.analysis.wilson import Rate, wilson

Row = Mapping[str, Any]


@dataclass(frozen=True)
class Candidate:
    """A certified plan that was flown: how it was asked for, its travel time in s, its flights.

    low: rate that its flights prove, exact and one-sided; interval: Wilson's, two-sided; reasons: against how many
    again: the same plan, flown in worlds that it was not chosen by
    """

    overrides: tuple[str, ...]
    travel_time: float
    flights: int
    succeeded: int
    low: float
    interval: tuple[float, float]
    reasons: Mapping[str, int]
    again: Candidate | None = None

    @property
    def whole(self) -> Rate:
        """How many of all its flights succeeded, those in other worlds included."""
        both = [one for one in (self, self.again) if one]
        return wilson(sum(one.succeeded for one in both), sum(one.flights for one in both))

    @property
    def rate(self) -> float:
        """Share of all its flights that succeeded."""
        flights = self.flights + (self.again.flights if self.again else 0)
        return (self.succeeded + (self.again.succeeded if self.again else 0)) / flights


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


def proves(one: Candidate, target: float) -> bool:
    """Whether its flights prove the target, those in other worlds, too, where it was flown there."""
    return one.low >= target and (one.again is None or one.again.low >= target)


def fastest(found: Sequence[Candidate], target: float) -> Candidate | None:
    """Return the fastest plan whose flights prove the target; None without one."""
    return min((one for one in found if proves(one, target)), key=lambda one: one.travel_time, default=None)


def elsewhere(overrides: Sequence[str]) -> tuple[str, ...]:
    """Return what flies the same plan in the worlds of the next seed."""
    return (*(text for text in overrides if not _of_seed(text)), f"seed={seed(overrides) + 1}")


def paired(found: Sequence[Candidate]) -> list[Candidate]:
    """Return the plans of a search, each with its flights `elsewhere`, where there are some."""
    there = {one.overrides: one for one in found}
    second = {elsewhere(one.overrides) for one in found} & {*there}
    return [
        replace(one, again=there.get(elsewhere(one.overrides)))
        for one in found
        if one.overrides not in second
    ]


def seed(overrides: Sequence[str]) -> int:
    """Return the seed of a run, 0 where none is said."""
    return next((int(text.partition("=")[2]) for text in overrides if _of_seed(text)), 0)


def _of_seed(text: str) -> bool:
    return text.lstrip("+").startswith("seed=")
