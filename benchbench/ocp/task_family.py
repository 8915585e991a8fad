"""A family of tasks: ranges, and one task drawn from them by a seed, the same on every machine and for every version.

A draw is a number in [0, 1) made of SHA-256 of the family's name, the seed and the name of what is drawn. No stream is
consumed, so a number that is drawn besides, or no longer, leaves all others as they are; a generator's stream (NumPy's PCG64
keeps its bits, not what its distributions make of them) would shift. What is drawn is rounded to `DIGITS`: a sine or a root
may differ in its last bit from one C library to another, and the task's hash would, too.
"""

from __future__ import annotations

import hashlib
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, final

from pydantic import AfterValidator, Field

from benchbench.ocp.scenario import Finite, NonNegative, Positive

DIGITS = 4
"""Decimals of a drawn number: 0.1 mm, 0.1 mrad, less than any tolerance of a task."""
BITS = 53
"""Of a float's mantissa."""


def increasing(pair: tuple[float, float]) -> tuple[float, float]:
    """Return a range as it is; raises ValueError for one that is reversed."""
    if not pair[0] <= pair[1]:
        raise ValueError("the first number must not exceed the second")
    return pair


def _some(weights: dict[str, float]) -> dict[str, float]:
    if not sum(weights.values()) > 0:
        raise ValueError("one of them must be above 0")
    return weights


Between = Annotated[tuple[Finite, Finite], AfterValidator(increasing)]
"""Smallest and largest number that may be drawn; the same twice for one that is always the same."""
AtLeastZero = Annotated[tuple[NonNegative, NonNegative], AfterValidator(increasing)]
AboveZero = Annotated[tuple[Positive, Positive], AfterValidator(increasing)]
Count = Annotated[int, Field(ge=1)]
Counts = Annotated[tuple[Count, Count], AfterValidator(increasing)]
"""Smallest and largest whole number, both may be drawn."""
Shares = Annotated[dict[str, NonNegative], AfterValidator(_some)]
"""How often each of some names is drawn, in any unit: {fixed: 1, circle: 2}."""
Chance = Annotated[float, Field(ge=0, le=1)]


@final
@dataclass(frozen=True)
class Draws:
    """What one seed of one family draws, by name; the same name always gives the same."""

    family: str
    seed: int

    def share(self, name: str) -> float:
        """Return a number in [0, 1), uniform."""
        digest = hashlib.sha256(f"{self.family}\n{self.seed}\n{name}".encode()).digest()
        return (int.from_bytes(digest[:8], "big") >> (64 - BITS)) / 2**BITS

    def number(self, name: str, between: tuple[float, float]) -> float:
        """Return a number between two, uniform, rounded."""
        low, high = between
        return min(max(rounded(low + self.share(name) * (high - low)), low), high)

    def whole(self, name: str, between: tuple[int, int]) -> int:
        """Return a whole number between two, each as likely."""
        low, high = between
        return low + math.floor(self.share(name) * (high - low + 1))

    def chance(self, name: str, probability: float) -> bool:
        """Return true with this probability."""
        return self.share(name) < probability

    def one_of(self, name: str, shares: Mapping[str, float]) -> str:
        """Return one of some names, each as often as its share says; the order of the mapping does not matter."""
        there = sorted(key for key, share in shares.items() if share > 0)
        left = self.share(name) * sum(shares[key] for key in there)
        for key in there:
            left -= shares[key]
            if left < 0:
                return key
        return there[-1]


def rounded(value: float) -> float:
    """Return a number as it stands in a drawn task; never -0.0."""
    return round(value, DIGITS) + 0.0


class TaskFamily(ABC):
    """Ranges, and how a task is made of numbers that are drawn from them."""

    @abstractmethod
    def draw(self, draws: Draws) -> dict[str, Any]:
        """Return what is drawn as fields of a scenario, of plain values as YAML has them; equal draws give equal fields.

        Raises BadInput for ranges that no task fits in.
        """
