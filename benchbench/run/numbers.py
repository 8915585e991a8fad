"""Numbers and words of a run, and of how runs are carried out, with what they may be."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Literal, get_args

from benchbench.ground.errors import BadInput

NUMBERS = {"seed": (int, 0, 2**63 - 1), "time_limit": (float, 1e-3, 1e7), "iteration_limit": (int, 1, 10**9)}
"""Numbers of a run with their type, smallest and largest value."""
WORDS = {"accuracy": ("low", "medium", "high"), "compile": ("auto", "never")}
Rerun = Literal["missing", "failed", "all"]
AUTO: Literal["auto"] = "auto"
RANGES = {
    "workers": (1, 1024), "repeats": (1, 10_000), "hard_limit": (0.1, 1e9), "memory_limit_mb": (1, 1e9),
}  # fmt: skip
"""Smallest and largest values of how runs are carried out."""
COUNTS = ("workers", "repeats")


def check(values: Mapping[str, Any]) -> None:
    """Raise BadInput where a number or a word of a run that is among the values makes no sense."""
    for key, (kind, low, high) in NUMBERS.items():
        value: Any = values.get(key)
        fits = isinstance(value, (int, kind)) and not isinstance(value, bool)
        if key in values and (not fits or not low <= value <= high):  # NaN is nowhere between
            what = "whole number" if kind is int else "number of seconds"
            raise BadInput(key, f"{value!r} was given", f"a {what} of at least {low:g}, at most {high:g}")
    for key, allowed in WORDS.items():
        if key in values and values[key] not in allowed:
            raise BadInput(key, f"{values[key]!r} was given", ", ".join(allowed))


def check_execution(values: Mapping[str, Any]) -> None:
    """Raise BadInput where a field of `benchbench.run.settings` that is among the values makes no sense."""
    for name, (low, high) in RANGES.items():
        _check_range(name, values.get(name), low, high)
    if values.get("rerun", "missing") not in get_args(Rerun):
        raise BadInput("rerun", f"{values['rerun']!r} was given", ", ".join(get_args(Rerun)))
    picture = values.get("picture", AUTO)
    if not isinstance(picture, bool) and picture != AUTO:
        raise BadInput("picture", f"{picture!r} was given", "true, false or auto")


def _check_range(name: str, value: Any, low: float, high: float) -> None:
    kinds = (int,) if name in COUNTS else (int, float)
    fits = isinstance(value, kinds) and not isinstance(value, bool) and math.isfinite(value)
    if value is not None and not (fits and low <= value <= high):
        kind = "whole number" if name in COUNTS else "number"
        raise BadInput(name, f"{value!r} was given", f"a {kind} from {low:g} to {high:g}, or null")
