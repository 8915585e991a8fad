"""What overrides imply, and those of a sweep, made independent of the order in which Hydra composes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache

from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import Override
from omegaconf import DictConfig, OmegaConf

from benchbench.ocp.track_file import beside_the_lap

SMOOTH, RELAXING = "auto", "relax"
"""The default strategy, which has no complementarity to relax, and the one for those who ask for a relaxation."""
TRACK = "scenario.track"
MARGINS = ("scenario.rate_margin", "scenario.contact_margin")
"""Margins by hand; a strategy with a field `margin` above 0 keeps them, and measures on top of them (`benchbench.planning.margins`)."""
KEPT = "scenario.kept_margins"


def implied(overrides: Sequence[str], cfg: DictConfig) -> list[str]:
    """Return what is meant beside the overrides, given the configuration they lead to, that of Hydra included.

    Who asks for a relaxation, or sets a field of one, and for no strategy does not mean one that ignores it. Who sets
    margins wants at least those from a strategy that measures its own. Who names a track file means what it says of start,
    end, radius and gates, but for what they say themselves.
    """
    return [*_of_the_track(overrides, cfg), *_of_the_method(overrides, cfg)]


def _of_the_track(overrides: Sequence[str], cfg: DictConfig) -> list[str]:
    """What a track file says beside its gates: it wins over what is shipped, and what is typed wins over it."""
    asked = keys(overrides)
    if TRACK not in asked:
        return []
    return [
        f"++scenario.{name}={value if isinstance(value, int | float) else quoted(str(value))}"
        for name, value in beside_the_lap(OmegaConf.select(cfg, TRACK)).items()
        if not asked & {f"scenario.{name}", f"scenario.{name.partition('.')[0]}"}
    ]


def _of_the_method(overrides: Sequence[str], cfg: DictConfig) -> list[str]:
    if _relaxing(overrides) and cfg.hydra.runtime.choices.get("strategy") == SMOOTH:
        return [f"strategy={RELAXING}"]
    kept = _by_hand(overrides)
    strategy = cfg.get("strategy")
    if not kept or KEPT in keys(overrides) or not isinstance(strategy, DictConfig) or not _measures(strategy):
        return []
    return [f"++{KEPT}=[{','.join(kept)}]"]


def implying(overrides: Sequence[str]) -> bool:
    """Whether these overrides may imply others."""
    return _relaxing(overrides) or bool(_by_hand(overrides)) or TRACK in keys(overrides)


def quoted(text: str) -> str:
    """Return any text as the value of an override, in Hydra's grammar."""
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


def _relaxing(overrides: Sequence[str]) -> bool:
    """Whether a relaxation is asked for, but no strategy."""
    asked = keys(overrides)
    return "strategy" not in asked and any(key.partition(".")[0] == "relaxation" for key in asked)


def _by_hand(overrides: Sequence[str]) -> list[str]:
    """Names of the margins that are set, as `rate_margin.arm`."""
    parsed = _parsed(tuple(overrides))
    return sorted({name for o in parsed if not o.is_delete() for name in _set(o)})


def _set(override: Override) -> Iterator[str]:
    """Names of the margins that one override sets: the one it is about, or all of a mapping."""
    key = override.key_or_group
    field = next((field for field in MARGINS if f"{key}.".startswith(f"{field}.")), None)
    if field is None:
        return
    values = [override.value()] if not override.is_sweep_override() else list(override.sweep_iterator())
    own = (
        [key]
        if key != field
        else [f"{field}.{name}" for value in values if isinstance(value, dict) for name in value]
    )
    yield from (name.removeprefix("scenario.") for name in own)


def keys(overrides: Sequence[str]) -> set[str]:
    """Return the fields and choices that overrides are about. Raises what Hydra does for what is no override."""
    return {o.key_or_group for o in _parsed(tuple(overrides))}


@lru_cache(maxsize=64)
def _parsed(overrides: tuple[str, ...]) -> list[Override]:
    """What overrides say; several questions are asked of the same ones."""
    return OverridesParser.create().parse_overrides(list(overrides))


def _measures(node: DictConfig) -> bool:
    """Whether a strategy, or one inside it, measures margins."""
    return any(
        _measures(value) if isinstance(value, DictConfig)
        else key == "margin" and isinstance(value, (int, float)) and value > 0
        for key, value in node.items()
    )  # fmt: skip


def carried(overrides: Sequence[str]) -> list[str]:
    """Return overrides for a multirun, with fixed fields of swept choices written as sweeps of one value.

    Hydra composes once without everything that is swept. `+scenario=a,b scenario.intervals=20` would fail
    there, since no scenario is chosen yet; `scenario.intervals=choice(20)` waits for the combinations.
    """
    parsed = _parsed(tuple(overrides))
    swept = {o.key_or_group for o in parsed if o.is_sweep_override()}
    return [_waiting(o) if _belongs(o, swept) else text for o, text in zip(parsed, overrides, strict=True)]


def _belongs(override: Override, swept: set[str]) -> bool:
    plain = not (override.is_sweep_override() or override.is_delete())
    return plain and "." in override.key_or_group and override.key_or_group.partition(".")[0] in swept


def _waiting(override: Override) -> str:
    return f"{override.get_key_element()}=choice({override.get_value_element_as_str()})"
