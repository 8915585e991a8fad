"""What a search for a plan that succeeds refuses once, since each of its runs would."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import Override

from benchbench.flight.errand import errand
from benchbench.ground.errors import BadInput, BenchBenchError
from benchbench.planning.case import Case
from benchbench.run import config
from benchbench.run.flying import campaign
from benchbench.run.settings import Settings

HANDOVER = "+scenario=NAME of a handover with one target"


def parsed(typed: Sequence[str]) -> list[Override]:
    """Return what overrides say; raises what Hydra does."""
    overrides: list[Override] = OverridesParser.create().parse_overrides(list(typed))
    return overrides


def check_numbers(typed: Sequence[str]) -> None:
    """Raise BadInput for a target, or a number of flights, of which nothing can come."""
    for one in parsed(typed):
        if one.key_or_group == "target_success" and not _between(said := one.get_value_string()):
            raise BadInput("target_success", f"'{said}' was given", "a number above 0 and below 1")
        if one.key_or_group == "flights":
            wrong = [value for value in _values(one) if not (value.isdecimal() and int(value) > 0)]
            for value in wrong:
                allowed = "a whole number of at least 1: success is told of flights"
                raise BadInput("flights", f"'{value}' was given", allowed)


def check_scenario(typed: Sequence[str]) -> None:
    """Raise BadInput for a scenario of ours that has nothing to be flown, before fields are added that it does not have."""
    overrides = parsed(typed)
    single = [one.input_line for one in overrides if not one.is_sweep_override()]
    fields = [text for text in single if text and text.lstrip("+").startswith("scenario.")]
    for one in overrides:
        for name in _values(one) if one.key_or_group == "scenario" else ():
            if name in config.choices("scenario"):
                _check_errand(name, fields)


def check_first(told: Sequence[str]) -> None:
    """Raise BadInput, or IncompatibleCase, where the first of all combinations cannot be flown, whatever is searched.

    A field that is searched may be wrong in one run and right in the next, which the runs tell.
    """
    overrides = parsed(told)
    searched = {one.key_or_group for one in overrides if one.is_sweep_override()}
    if any(one.is_sweep_override() and not one.is_discrete_sweep() for one in overrides):
        return
    first = [
        f"{one.get_key_element()}={next(iter(_values(one)), '')}" if one.is_sweep_override() else str(one.input_line)
        for one in overrides
        if not one.key_or_group.startswith("hydra")
    ]  # fmt: skip
    try:
        cfg, chosen = config.composed(*first)
        Settings.of(cfg)
        found, case = campaign(cfg, chosen), config.build(cfg, chosen)
        if found is not None and isinstance(case, Case):
            found.check(case.scenario, case.model)
    except BadInput as error:
        if not any(_about(error.field, key) or _about(key, error.field) for key in searched):
            raise


def _check_errand(name: str, fields: Sequence[str]) -> None:
    try:
        cfg, _ = config.composed(f"+scenario={name}", *fields)
        values = config.make(cfg, "scenario")
        scenario = config.scenario_of(values) if isinstance(values, dict) else values
    except BenchBenchError:  # something has to be said besides, which the runs are told
        return
    try:
        errand(scenario)
    except BadInput as error:
        raise BadInput("scenario", error.problem, HANDOVER) from None


def _values(one: Override) -> Iterator[str]:
    """The values that are searched, or the one that is said."""
    if one.is_discrete_sweep():
        yield from one.sweep_string_iterator()
    else:
        yield one.get_value_string()


def _about(field: str, whole: str) -> bool:
    """Whether a field is another one, or a part of it."""
    return f"{field}.".startswith(f"{whole}.")


def _between(said: str) -> bool:
    try:
        return 0 < float(said) < 1
    except ValueError:
        return False
