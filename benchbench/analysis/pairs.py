"""Two sets of runs side by side: which run of one answers to which of the other, and what differs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from benchbench.ground.families import FLOWN, PLANNED

Row = Mapping[str, Any]
TASK = ("scenario", "seed", "task_hash")
"""Columns that tell tasks apart: where the sides share some of them, those are compared."""
CHOICES = (*TASK, *PLANNED[1:], "intervals", "kappa_init", *FLOWN)
"""Columns that say what was asked."""


@dataclass(frozen=True)
class Pairs:
    """Runs of both sides that answer to each other, the newest of each.

    differ  column, values in one, values in the other, of what was chosen differently throughout
    names   columns that tell the pairs apart
    pairs   by the values of those
    single  how many runs of each side have no partner
    """

    differ: tuple[tuple[str, tuple[str, ...], tuple[str, ...]], ...]
    names: tuple[str, ...]
    pairs: dict[tuple[Any, ...], tuple[Row, Row]]
    single: tuple[int, int]


def paired(one: Sequence[Row], other: Sequence[Row]) -> Pairs:
    """Pair runs by what both sides chose alike; the rows of each side by start.

    A column in which the sides have different values is what is compared, and tells no two runs apart.
    """
    chosen = {name: ({row.get(name) for row in one}, {row.get(name) for row in other}) for name in CHOICES}
    alike = [name for name, (a, b) in chosen.items() if a == b or (name in TASK and a & b)]
    first, second = ({tuple(row.get(name) for name in alike): row for row in rows} for rows in (one, other))
    shared = [key for key in first if key in second]
    names = _telling(alike, shared)
    return Pairs(
        tuple(
            (name, _told(a), _told(b)) for name, (a, b) in chosen.items() if name not in (*alike, "task_hash")
        ),
        names,
        {_part(key, alike, names): (first[key], second[key]) for key in shared},
        (len(first) - len(shared), len(second) - len(shared)),
    )


def _telling(alike: Sequence[str], shared: Sequence[tuple[Any, ...]]) -> tuple[str, ...]:
    """Columns that vary among the pairs; the hash of the task only where nothing else tells them apart."""
    vary = tuple(name for i, name in enumerate(alike) if len({key[i] for key in shared}) > 1)
    plain = tuple(name for name in vary if name != "task_hash")
    return plain if len({_part(key, alike, plain) for key in shared}) == len(shared) else vary


def _part(key: tuple[Any, ...], alike: Sequence[str], names: Sequence[str]) -> tuple[Any, ...]:
    return tuple(key[alike.index(name)] for name in names)


def _told(values: set[Any]) -> tuple[str, ...]:
    return tuple(sorted("-" if value is None else str(value) for value in values))
