"""What overrides imply, and those of a sweep, made independent of the order in which Hydra composes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import Override

SMOOTH, RELAXING = "phases", "relax"
"""The default strategy, which has no complementarity to relax, and the one for those who ask for a relaxation."""


def implied(overrides: Sequence[str], chosen: Mapping[str, Any]) -> list[str]:
    """Return what is meant beside the overrides, given the choices they lead to.

    Who asks for a relaxation, or sets a field of one, and for no strategy does not mean one that ignores it.
    """
    return [f"strategy={RELAXING}"] if relaxing(overrides) and chosen.get("strategy") == SMOOTH else []


def relaxing(overrides: Sequence[str]) -> bool:
    """Whether a relaxation is asked for, but no strategy."""
    parsed = OverridesParser.create().parse_overrides(list(overrides))
    asked = {o.key_or_group.partition(".")[0] for o in parsed}
    return "relaxation" in asked and "strategy" not in asked


def carried(overrides: Sequence[str]) -> list[str]:
    """Return overrides for a multirun, with fixed fields of swept choices written as sweeps of one value.

    Hydra composes once without everything that is swept. `+scenario=a,b scenario.intervals=20` would fail
    there, since no scenario is chosen yet; `scenario.intervals=choice(20)` waits for the combinations.
    """
    parsed = OverridesParser.create().parse_overrides(list(overrides))
    swept = {o.key_or_group for o in parsed if o.is_sweep_override()}
    return [_waiting(o) if _belongs(o, swept) else text for o, text in zip(parsed, overrides, strict=True)]


def _belongs(override: Override, swept: set[str]) -> bool:
    plain = not (override.is_sweep_override() or override.is_delete())
    return plain and "." in override.key_or_group and override.key_or_group.partition(".")[0] in swept


def _waiting(override: Override) -> str:
    return f"{override.get_key_element()}=choice({override.get_value_element_as_str()})"
