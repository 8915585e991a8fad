"""A check: one limit, what was measured against it, and what is said where it is broken."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from benchbench.ground.arrays import Array


@dataclass(frozen=True)
class Check:
    """One limit: its `value` against `limit` in `unit`; `reason` says in words why it failed, else "".

    A value that is not a number never passes, whatever `ok` says. advice: what to change where it is broken. what: what is
    measured, in words, where `value` may be any share of `limit`.
    """

    name: str
    value: float
    limit: float
    unit: str
    ok: bool
    reason: str = ""
    advice: str = ""
    what: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        """Fail what is not a number."""
        if self.ok and math.isnan(self.value):
            object.__setattr__(self, "ok", False)
            object.__setattr__(self, "reason", f"{self.name} is not a number")

    @property
    def used(self) -> float:
        """Share of the limit that is used, 0 where there is none to use."""
        return self.value / self.limit if self.what and self.ok and self.limit > 0 < self.value else 0.0

    @property
    def use(self) -> str:
        """The same in words."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.what} {self.value:.5g} of {self.limit:.5g}{unit}"


Checks = Iterator[Check]


BEYOND = "exceeds its limits by"


def at_most(
    name: str, what: str, value: float, limit: float, unit: str, where: str = "", verb: str = "reaches",
    *, advice: str = "",
) -> Check:  # fmt: skip
    """Check value <= limit; NaN fails. `what` is the subject of the reason, `where` its place or time."""
    if math.isnan(value):
        return Check(name, value, limit, unit, False, f"{what} is not a number{where}", advice)
    reason = f"{what} {verb} {_number(value, unit)}{where}, allowed {_number(limit, unit)}"
    measured = f"{what} beyond its limits" if verb == BEYOND else what
    return Check(name, value, limit, unit, value <= limit, "" if value <= limit else reason, advice, measured)


def at_least(
    name: str, what: str, value: float, limit: float, unit: str, slack: float = 0.0, *, advice: str = ""
) -> Check:
    """Check value >= limit - slack; NaN fails."""
    ok = value >= limit - slack
    reason = f"{what} is only {_number(value, unit)}, required {_number(limit, unit)}"
    return Check(name, value, limit, unit, ok, "" if ok else reason, advice)


def worst(values: Array) -> tuple[float, tuple[int, ...]]:
    """Largest value of an array and where it stands; NaN counts as largest."""
    at = np.unravel_index(np.argmax(np.where(np.isnan(values), np.inf, values)), values.shape)
    return float(values[at]), tuple(int(i) for i in at)


def _number(value: float, unit: str) -> str:
    return f"{value:.6g} {unit}".rstrip() if unit != "1" else f"{value:.6g}"
