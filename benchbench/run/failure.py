"""The record of a run that ended without a plan: a sweep shows it as a row like any other."""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping
from typing import Any

from benchbench.ground.errors import (
    BadInput,
    BenchBenchError,
    Crash,
    IncompatibleCase,
    OutOfMemory,
    Pruned,
    Timeout,
    Unavailable,
)
from benchbench.ground.families import PLANNED
from benchbench.storage import provenance
from benchbench.storage.schema import Record, Status, make_record

LONGEST = 2_000
"""Characters of a reason that are kept."""


def failed(error: BaseException, chosen: Mapping[str, Any], labels: Mapping[str, Any]) -> Record:
    """Return the record of a run that `error` ended.

    chosen: names of the choices by family; labels: other columns that are known by now.
    """
    names = {family: chosen[family] for family in PLANNED if family in chosen}
    if chosen.get("peer"):  # it stands for the solver; our other choices played no part
        ours = ("scenario", "vehicle", "strategy")
        names = {"solver": chosen["peer"], **{family: names[family] for family in ours if family in names}}
    known = {
        **provenance.collect(), **names, "status": status(error), "reasons": [reason(error)],
        "claimed_success": False, "certified": False, "peak_memory_mb": provenance.peak_memory_mb(),
    }  # fmt: skip
    return make_record(**{**known, **labels})


def status(error: BaseException) -> Status:
    """Typed outcome of a run that ended with an error."""
    match error:
        case IncompatibleCase():
            return Status.INCOMPATIBLE
        case Unavailable():
            return Status.UNAVAILABLE
        case Pruned():
            return Status.PRUNED
        case Timeout():
            return Status.TIMEOUT
        case Crash():
            return Status.CRASH
        case MemoryError() | OutOfMemory():
            return Status.OUT_OF_MEMORY
        case BadInput():
            return Status.BAD_INPUT
    return Status.ERROR


def reason(error: BaseException) -> str:
    """One line: our own text as it is, another error with its type and last line, which names the cause.

    It can be printed and stored whatever an error of a plugin says of itself.
    """
    text = said(error)
    if not isinstance(error, BenchBenchError):
        lines = [line.strip() for line in text.splitlines() if line.strip()]
        text = f"{type(error).__name__}: {lines[-1]}" if lines else type(error).__name__
    return "".join(
        letter if _printable(letter) else "\N{REPLACEMENT CHARACTER}" for letter in cut(text, LONGEST)
    )


def said(error: BaseException) -> str:
    """What an error says, nothing where not even that works."""
    try:
        return str(error)
    except BaseException:  # noqa: BLE001  # a plugin's own
        return ""


def cut(text: str, longest: int) -> str:
    """A text of at most so many characters: of a longer one the beginning and the end."""
    if len(text) <= longest:
        return text
    half = longest // 2
    return f"{text[:half]} [...] {text[-half:]}"


def _printable(letter: str) -> bool:
    return letter in "\n\t" or not unicodedata.category(letter).startswith(
        "C"
    )  # control, half of a pair, none
