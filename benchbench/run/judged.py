"""Verdicts that this user's programs found before: kept in the user's own cache folder, for the same plan, task, limits and code.

A leaderboard of ten thousands of plans takes an hour to judge; the next one takes what is new.
"""

from __future__ import annotations

import hashlib
import json
from contextlib import suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from benchbench.mpcc.cache import cache_root, private
from benchbench.storage.contents import source_hash

LIBRARIES = ("casadi", "numpy", "scipy", "benchbench")


def recall(key: str) -> dict[str, Any] | None:
    """Return what was kept under a key, None where nothing was."""
    return _kept(_place()).get(key)


def keep(key: str, found: dict[str, Any]) -> None:
    """Keep what was found, plain values; a full disk is no reason to complain."""
    place = _place()
    _kept(place)[key] = found
    with suppress(OSError):
        place.touch(mode=0o600)
        with place.open("a") as file:
            file.write(json.dumps([key, found]) + "\n")


@cache
def _place() -> Path:
    """The file of this code with these libraries."""
    told = [source_hash(), *map(_version, LIBRARIES)]
    return cache_root() / f"judged-{hashlib.sha256(' '.join(told).encode()).hexdigest()[:24]}.jsonl"


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""


@cache
def _kept(place: Path) -> dict[str, dict[str, Any]]:
    """All that is in a file; a line that was cut off is left out."""
    found: dict[str, dict[str, Any]] = {}
    with suppress(OSError):
        for line in place.read_text().splitlines() if private(place) else ():
            with suppress(ValueError, TypeError):
                key, one = json.loads(line)
                found[str(key)] = dict(one)
    return found
