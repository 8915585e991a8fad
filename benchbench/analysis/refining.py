"""Which plan to fly next: one field decides how gently the target is met, and success falls where it grows."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

from benchbench.analysis.front import Candidate, elsewhere, fastest, proves

STEP = 0.1
"""Difference between success rates of neighbours that is worth a plan between them: two of 20 flights."""
CLOSEST = 1.06
"""Ratio of two values of the field between which none is tried."""
BACK, FURTHER, OFTEN = 0.9, 0.7, 0.7
"""Of the gentlest value, where that does not prove enough: a step back if it succeeds often, else a longer one."""
Family = list[tuple[float, Candidate]]


def finer(found: Sequence[Candidate], field: str, target: float) -> list[tuple[str, ...]]:
    """Return overrides of plans that may be faster than the best, or fill the front; none where the search is done.

    Plans that differ in nothing but the field are compared, from the gentlest on: between neighbours the value halfway is tried
    where success falls, and a gentler one than all where even the gentlest does not prove the target. Nothing is tried of which
    a plan that was flown has both already: the mean of the neighbours' travel times and of their success rates.
    """
    return [
        _with(family[0][1].overrides, field, value)
        for family in _families(found, field)
        for value in _values(family, found, target)
    ]


def unseen(found: Sequence[Candidate], target: float) -> list[tuple[str, ...]]:
    """Return overrides that fly the best plan in worlds that it was not chosen by; none where that is done, or there is none.

    The best of many plans has been lucky in its worlds, too: what it proves there is told of each plan by itself.
    """
    best = fastest(found, target)
    return [elsewhere(best.overrides)] if best and best.again is None else []


def _values(family: Family, found: Sequence[Candidate], target: float) -> Iterator[float]:
    best = fastest(found, target)
    value, gentlest = family[0]
    if not proves(gentlest, target) and (best is None or gentlest.travel_time < best.travel_time):
        yield _rounded((BACK if _rate(gentlest) >= OFTEN else FURTHER) * value)
    for (low, gentle), (high, bold) in pairwise(family):
        proved = proves(gentle, target) and not proves(bold, target)
        falls = abs(_rate(gentle) - _rate(bold)) >= STEP or proved
        if falls and high / low >= CLOSEST and not _beaten(gentle, bold, found):
            yield _rounded((low + high) / 2)


def _beaten(gentle: Candidate, bold: Candidate, found: Sequence[Candidate]) -> bool:
    """Whether one that was flown is as fast and as good as what is to be expected between two."""
    speed, rate = (gentle.travel_time + bold.travel_time) / 2, (_rate(gentle) + _rate(bold)) / 2
    return any(one.travel_time <= speed and _rate(one) >= rate for one in found)


def _rate(one: Candidate) -> float:
    """Its success where it was not chosen for it, if it was flown there."""
    return (one.again or one).rate


def _families(found: Sequence[Candidate], field: str) -> list[Family]:
    """Plans by their other overrides, each family by growing values of the field."""
    families: dict[tuple[str, ...], Family] = {}
    for one in found:
        rest = tuple(text for text in one.overrides if _key(text) != field)
        value = next((float(text.partition("=")[2]) for text in one.overrides if _key(text) == field), None)
        if value is not None:
            families.setdefault(rest, []).append((value, one))
    return [sorted(family, key=lambda pair: pair[0]) for family in families.values()]


def _key(text: str) -> str:
    return text.lstrip("+").partition("=")[0]


def _with(overrides: Sequence[str], field: str, value: float) -> tuple[str, ...]:
    return tuple(f"{field}={value:g}" if _key(text) == field else text for text in overrides)


def _rounded(value: float) -> float:
    """Three digits are enough for a field, and are read again as they were."""
    return round(value, 2 - math.floor(math.log10(value)))
