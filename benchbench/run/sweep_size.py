"""How many runs a sweep asks for, counted before they are listed."""

from __future__ import annotations

import math
from collections.abc import Sequence

from hydra.core.override_parser.types import ChoiceSweep, Override, RangeSweep

from benchbench.ground.errors import BadInput

RUNS = 1_000_000
"""Most runs of one sweep."""


def check_size(overrides: Sequence[Override]) -> None:
    """Raise BadInput for a range or choice without any value, and for more runs than anybody waits for."""
    total = 1.0
    for override in overrides:
        if override.is_discrete_sweep():
            count = _count(override)
            said = f"{override.input_line}".partition("=")[2]
            if not count >= 1:
                raise BadInput(override.key_or_group, f"'{said}' has no value", "one value or more")
            total *= count
            if total > RUNS:
                problem = f"'{said}' makes it {total:g} runs"
                raise BadInput(override.key_or_group, problem, f"at most {RUNS} in one sweep")


def _count(override: Override) -> float:
    """Number of values of a sweep, NaN where that is none."""
    sweep = override.value()
    if isinstance(sweep, RangeSweep):
        first, last = float(sweep.start or 0), float(sweep.stop or 0)
        return math.ceil(_ratio(last - first, float(sweep.step)))
    if isinstance(sweep, ChoiceSweep | list):
        return len(sweep if isinstance(sweep, list) else sweep.list)
    return 1


def _ratio(length: float, step: float) -> float:
    if not step or not math.isfinite(step) or math.isnan(length):
        return 0.0
    return min(length / step, 2.0 * RUNS)
