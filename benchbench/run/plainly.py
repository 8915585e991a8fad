"""What is plainly wrong on the command line, told before Hydra is imported: by the rules of the run itself, in its words."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from benchbench.ground.errors import invalid
from benchbench.run import numbers

WHOLE, BROKEN, WORD = r"-?(?:0|[1-9]\d*)", r"-?(?:\d+\.\d*(?:e[-+]?\d+)?|\d+e[-+]?\d+|inf|nan)", r"[a-z_]\w*"
"""What Hydra reads as it stands: whole numbers, others, words."""
MEANT = {"null": None, "true": True, "false": False}
PLACE, FAMILY = "scenario.", "family"
"""Where a scenario's fields stand, and the one by which some of them may say `drawn` (see `benchbench.run.random_task`)."""


def check(arguments: Sequence[str], place: Path) -> None:
    """Raise BadInput where overrides say so by themselves; place: the folder of scenarios. What is not plain is left to the run."""
    told = _told(arguments)
    numbers.check(told)
    numbers.check_execution(told)
    fields = {key.removeprefix(PLACE): value for key, value in told.items() if key.startswith(PLACE)}
    if fields:
        _check_scenario(fields, _content(place, str(told.get("+scenario"))))


def _told(arguments: Sequence[str]) -> dict[str, Any]:
    """Values that are numbers or words, by what stands before the equals sign, of all that are given once."""
    pairs = [text.partition("=")[::2] for text in arguments]
    names = [name.lstrip("+~") for name, _ in pairs]
    return {
        name: value for name, text in pairs if names.count(name.lstrip("+~")) == 1 for value in _values(text)
    }


def _values(text: str) -> list[Any]:
    """The value that a text means; none where that is not plain."""
    if text in MEANT:
        return [MEANT[text]]
    if re.fullmatch(WHOLE, text):
        return [int(text)]
    if re.fullmatch(BROKEN, text):
        return [float(text)]
    return [text] if re.fullmatch(WORD, text) else []


def _content(place: Path, name: str) -> dict[str, Any]:
    """Fields of a scenario's YAML and of what it builds on; none where it is not ours, or cannot be read."""
    from benchbench.ocp.reading import plain_yaml

    try:
        own = plain_yaml((place / f"{name}.yaml").read_bytes())
    except (OSError, ValueError):
        return {}
    bases = [base for base in own.pop("defaults", ()) if isinstance(base, str) and base.isidentifier()]
    found: dict[str, Any] = {}
    for base in bases:
        found = _merged(found, _content(place, base) if base != "_self_" else {})
    return _merged(found, own)


def _merged(one: Mapping[str, Any], other: Mapping[str, Any]) -> dict[str, Any]:
    inner = {
        key: _merged(one[key], value)
        for key, value in other.items()
        if isinstance(value, dict) and isinstance(one.get(key), dict)
    }
    return {**one, **other, **inner}


def _check_scenario(told: Mapping[str, Any], content: Mapping[str, Any]) -> None:
    """Raise BadInput where a field that the scenario's YAML has, by its place there, cannot have the value that is told."""
    from pydantic import ValidationError, create_model

    from benchbench.ocp.values import own_kind

    kind = own_kind(content)
    if "_target_" in content or kind is None:
        return
    fields: dict[str, Any] = {}
    for place, value in told.items():
        if _has(content, place) and not (FAMILY in content and isinstance(value, str)):
            fields = _merged(fields, _nested(place, value))
    known = {name: info for name, info in kind.model_fields.items() if name in fields}
    types: dict[str, Any] = {name: (info.annotation, info) for name, info in known.items()}
    try:
        create_model("Told", **types)(**fields)  # a few fields are ready sooner than all
    except ValidationError as error:
        raise invalid("scenario", error) from None


def _has(content: Any, place: str) -> bool:
    key, _, inner = place.partition(".")
    there = isinstance(content, dict) and key in content
    return there and (not inner or _has(content[key], inner))


def _nested(place: str, value: Any) -> dict[str, Any]:
    key, _, inner = place.partition(".")
    return {key: _nested(inner, value) if inner else value}
