"""The search space: Hydra's sweep syntax turned into Optuna's distributions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import IntervalSweep, Override, RangeSweep
from optuna.distributions import (
    BaseDistribution,
    CategoricalDistribution,
    FloatDistribution,
    IntDistribution,
)

from benchbench.ground.errors import BadInput
from benchbench.run.sweep_size import check_size

GRAMMAR = (
    "choice(a,b), range(first,last,step), interval(low,high), tag(log,interval(low,high)), int(interval(1,9))"
)


@dataclass(frozen=True)
class SearchSpace:
    """A tuning task: `tuned` distributions by field, the `problems` a trial must plan, `fixed` overrides."""

    tuned: dict[str, BaseDistribution]
    problems: tuple[tuple[str, ...], ...]
    fixed: tuple[str, ...]


def read(arguments: Sequence[str], over: Sequence[str]) -> SearchSpace:
    """Sort overrides into fields to tune, problems (swept fields named in `over`) and fixed ones.

    Raises BadInput for a range that is empty and if nothing is to be tuned.
    """
    tuned: dict[str, BaseDistribution] = {}
    problems: list[tuple[str, ...]] = [()]
    fixed = []
    overrides = OverridesParser.create().parse_overrides(list(arguments))
    check_size([one for one in overrides if one.key_or_group in over])
    for text, parsed in zip(arguments, overrides, strict=True):
        if not parsed.is_sweep_override():
            fixed.append(text)
        elif parsed.key_or_group in over:
            key = parsed.get_key_element()
            values = [f"{key}={value}" for value in parsed.sweep_string_iterator()]
            problems = [(*before, value) for before in problems for value in values]
        else:
            tuned[parsed.get_key_element()] = _distribution(parsed)
    if not any(len(getattr(d, "choices", (0, 1))) > 1 for d in tuned.values()):
        raise BadInput("hydra.sweeper", "no field is to be tuned", f"FIELD={GRAMMAR}")
    return SearchSpace(tuned, tuple(problems), tuple(fixed))


def _distribution(override: Override) -> BaseDistribution:
    sweep, field = override.value(), override.key_or_group
    log = "log" in getattr(sweep, "tags", ())
    try:
        if isinstance(sweep, IntervalSweep):
            low, high = sweep.start, sweep.end
            if low is None or high is None or not low < high:
                raise ValueError(f"the interval from {low} to {high} is empty")
            whole = isinstance(low, int) and isinstance(high, int)
            return (
                IntDistribution(int(low), int(high), log=log)
                if whole
                else FloatDistribution(low, high, log=log)
            )
        if isinstance(sweep, RangeSweep):
            check_size([override])
            values = list(sweep.range())
            return CategoricalDistribution(tuple(str(value) for value in values))
        return CategoricalDistribution(tuple(override.sweep_string_iterator()))
    except ValueError as error:
        raise BadInput(field, str(error), GRAMMAR) from None
