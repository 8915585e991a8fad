"""Which plugins are installed: entry points, one group per family; a broken one is an answer, not a crash."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any

FAMILIES = (
    "models", "dynamics", "contacts", "motions", "relaxations", "solvers", "strategies", "guesses", "collections", "peers",
    "scenarios", "task_families", "worlds", "controllers", "autopilots", "residuals", "payloads", "predictors",
)  # fmt: skip

PARTS = ("costs",)
"""Groups of entry points beside them, of which a scenario may have some by name."""


@dataclass(frozen=True)
class Plugin:
    """One entry point of the group `benchbench.<family>`.

    target        "module:Class" as registered
    distribution  name of the package that registers it
    kind          the class, or None when it could not be loaded
    summary       first line of the class's docstring
    error         why it could not be loaded, empty otherwise
    """

    family: str
    name: str
    target: str
    distribution: str
    kind: type | None
    summary: str = ""
    error: str = ""


def installed(family: str) -> list[Plugin]:
    """Return the plugins of one of `FAMILIES`, ordered by name; raises ValueError for another family."""
    if family not in FAMILIES:
        raise ValueError(f"there is no family {family!r}; families: {', '.join(FAMILIES)}")
    return [_load(family, entry) for _, group in sorted(entries(family).items()) for entry in group]


def entries(group: str) -> dict[str, tuple[EntryPoint, ...]]:
    """Return the entry points of `benchbench.<group>` by name, from metadata alone; nothing is imported.

    A name has several where packages disagree about what it is.
    """
    return dict(_group(tuple(sys.path), group))


@cache
def _group(path: tuple[str, ...], group: str) -> dict[str, tuple[EntryPoint, ...]]:
    found = {(e.name, e.value): e for e in _scanned(path).select(group=f"benchbench.{group}")}
    return {name: tuple(found[key] for key in sorted(found) if key[0] == name) for name, _ in found}


@cache
def _scanned(path: tuple[str, ...]) -> Any:
    """All entry points of the packages on a path, read once: EntryPoints, or Python 3.11's elder form of it."""
    return entry_points()


def targets(families: Iterable[str] = FAMILIES) -> set[str]:
    """Return what is registered in some families as "module:Class", without loading any of it."""
    return {entry.value for family in families for group in entries(family).values() for entry in group}


def _load(family: str, entry: EntryPoint) -> Plugin:
    origin = entry.dist.name if entry.dist else "unknown"
    kind, error = None, ""
    try:
        kind = entry.load()
    except Exception as problem:  # noqa: BLE001  # importing somebody's module can raise anything
        error = f"{type(problem).__name__}: {problem}"
    if not error and not isinstance(kind, type):
        kind, error = None, f"{entry.value} is no class"
    summary = ((kind.__doc__ or "").strip().splitlines() or [""])[0] if kind else ""
    return Plugin(family, entry.name, entry.value, origin, kind, summary, error)
