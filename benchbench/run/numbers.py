"""Numbers and words of a run with what they may be, and which of the command line are plainly out of it before Hydra is imported."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from benchbench.ground.errors import BadInput, invalid

NUMBERS = {"seed": (int, 0, 2**63 - 1), "time_limit": (float, 1e-3, 1e7), "iteration_limit": (int, 1, 10**9)}
"""Numbers of a run with their type, smallest and largest value."""
WORDS = {"accuracy": ("low", "medium", "high"), "compile": ("auto", "never")}
SIZES = {"intervals": "Intervals", "kappa_init": "Nodes"}
"""Fields of handovers and transfers, and what they are called in `benchbench.ocp.sizes`."""
WHOLE, BROKEN, WORD = r"-?(?:0|[1-9]\d*)", r"-?\d+\.\d+", r"[a-z_]\w*"
"""What Hydra reads as it stands: whole numbers, others, words."""
NOT_WORDS = ("null", "true", "false", "nan", "inf")


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


def check_at_once(arguments: Sequence[str], place: Path) -> None:
    """Raise BadInput where overrides say so by themselves; place: the folder of scenarios. What is not plain is left to the run."""
    told = _told(arguments)
    check({key: value for key, value in told.items() if key in (*NUMBERS, *WORDS)})
    scenario = _text(place, str(told.get("+scenario")))
    for field, size in SIZES.items():
        value = told.get(f"scenario.{field}")
        if isinstance(value, int) and re.search(rf"^{field}:", scenario, re.MULTILINE):
            _check_size(field, size, value)


def _told(arguments: Sequence[str]) -> dict[str, int | float | str]:
    """Values that are numbers or words, by what stands before the equals sign, of all that are given once."""
    pairs = [text.partition("=")[::2] for text in arguments]
    names = [name.lstrip("+~") for name, _ in pairs]
    read = {name: _value(text) for name, text in pairs if names.count(name.lstrip("+~")) == 1}
    return {name: value for name, value in read.items() if value is not None}


def _value(text: str) -> int | float | str | None:
    if re.fullmatch(WHOLE, text):
        return int(text)
    if re.fullmatch(BROKEN, text):
        return float(text)
    return text if re.fullmatch(WORD, text) and text not in NOT_WORDS else None


def _text(place: Path, name: str) -> str:
    """What a scenario's YAML says, and what it builds on; nothing where it is no flight, of a kind of its own, or not ours."""
    try:
        own = (place / f"{name}.yaml").read_text()
    except OSError:
        return ""
    if re.search(r"^(_target_|kind):", own, re.MULTILINE):
        return ""
    listed = re.search(r"^defaults:\n((?:  - .*\n)+)", own, re.MULTILINE)
    bases = re.findall(r"^  - (\w+)\s*$", listed[1], re.MULTILINE) if listed else []
    return own + "".join(_text(place, base) for base in bases if base != "_self_")


def _check_size(field: str, size: str, value: int) -> None:
    from pydantic import ValidationError, create_model  # a third of the time of all else here

    from benchbench.ocp import sizes

    fields: dict[str, Any] = {field: (getattr(sizes, size), ...)}
    try:
        create_model("Sizes", **fields)(**{field: value})
    except ValidationError as error:
        raise invalid("scenario", error) from None
