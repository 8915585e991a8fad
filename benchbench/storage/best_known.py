"""The best certified travel time (of an MPCC: objective) known for each task, and the command that gives it: `references/best_known.yaml`."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Self

import yaml  # type: ignore[import-untyped]

from benchbench.ground.errors import BadInput
from benchbench.storage.files import write_bytes
from benchbench.storage.schema import Record

BEST_KNOWN, REFERENCES = "best_known.yaml", "references"
"""Name of the file, and of the folder where it and other references are kept: no results, so that those can be deleted."""
OF_SUITES = "best_known_suites.yaml"
"""Name of the file with the tasks of suites, of which there are many."""
SAME = 1e-6
"""Relative difference up to which two travel times or objectives are the same."""
SMALL = 1e-3
"""Objectives below it are compared in units of 1: a certified pair may have G H = 1e-7, which moves an objective by the root of that."""
IDENTITY = ("scenario", "kappa_init", "vehicle", "dynamics", "intervals")
"""What people call the task; entries are ordered by it, and `task_hash` decides."""
FOUND = (
    "strategy", "solver", "solver_version", "casadi_version", "benchbench_version", "git_commit", "git_dirty",
    "started_at",
)  # fmt: skip
"""Columns of the record that say what found the plan, and when."""
HEAD = """# Best certified travel time known for each task, transcription and grid; `benchbench best DIR` updates it.
# `command` behind `python -m benchbench` gives it again. travel_time_s has the rewards of optional stops taken off;
# a problem that is no flight has its objective instead.
"""

KnownValue = dict[str, Any]


@dataclass(frozen=True)
class BestKnown:
    """Entries by `task_hash`; each has `travel_time_s` or `objective`, and `command` at least."""

    entries: Mapping[str, KnownValue]

    @classmethod
    def load(cls, *files: Path) -> Self:
        """Read files that exist, the better entry of each task; raises BadInput for one that cannot be used."""
        entries: dict[str, KnownValue] = {}
        for path in files:
            for entry in _read(path):
                old = entries.get(entry["task_hash"])
                if old is None or value(entry) < value(old):
                    entries[entry["task_hash"]] = entry
        return cls(entries)

    def compare(self, record: Record) -> dict[str, float]:
        """Return the record's column `best_known_s` or `best_known_objective` and, where it is certified, `gap_percent` to 1e-6 %."""
        one = self.entries.get(record["task_hash"])
        if one is None:
            return {}
        best, found = value(one), cost(record)
        told = {"best_known_s" if "travel_time_s" in one else "best_known_objective": best}
        if found is None or not record["certified"]:
            return told
        return {**told, "gap_percent": round(gap(found, best), 6) + 0.0}  # never -0.0

    def save(self, path: Path) -> None:
        """Write all entries, ordered by what people call the task; raises BadInput when the disk refuses."""
        rows = sorted(self.entries.values(), key=_order)
        text = yaml.safe_dump(rows, sort_keys=False, width=1000, allow_unicode=True)
        write_bytes(path, (HEAD + text).encode())
        _parsed.cache_clear()


def packaged(name: str = BEST_KNOWN) -> Path:
    """A file that comes with BenchBench: of the installed package, else of the checkout."""
    here = Path(__file__).resolve().parents[1]
    installed = here / name
    return installed if installed.is_file() else here.parent / REFERENCES / name


def known(*files: Path) -> BestKnown:
    """Return all that comes with BenchBench, and what other files say; raises BadInput as `BestKnown.load` does."""
    return BestKnown.load(packaged(), packaged(OF_SUITES), *files)


def net_time(record: Mapping[str, Any]) -> float | None:
    """Travel time in s of a record, rewards of optional stops taken off and own cost terms of the scenario added."""
    time, costs = record["travel_time_s"], dict(record.get("costs") or {})  # of a table they are pairs
    return (
        None
        if time is None
        else time - (record["reward_s"] or 0.0) + sum(price or 0.0 for price in costs.values())
    )


def cost(record: Mapping[str, Any]) -> float | None:
    """What is to be least: the travel time of a flight as `net_time`, the objective of a ready-made MPCC, which has no time grid."""
    if record["travel_time_s"] is not None:
        return net_time(record)
    found: float | None = record.get("objective") if record.get("intervals") is None else None
    return found


def value(one: KnownValue) -> float:
    """Return the value of an entry, be it travel time or objective."""
    return float(one["travel_time_s"] if "travel_time_s" in one else one["objective"])


def beats(found: float, best: float | None) -> bool:
    """Whether a travel time or an objective is better than the best known one, by more than `SAME`."""
    return best is None or found < best - SAME * _unit(best)


def gap(found: float, best: float) -> float:
    """How far a travel time or an objective is above the best known one, %."""
    return 100 * (found - best) / _unit(best)


def _unit(best: float) -> float:
    """What differences from the best known value are measured by."""
    return abs(best) if abs(best) >= SMALL else 1.0


def entry(record: Record, command: str) -> KnownValue:
    """Return what is stored of a certified record with a `task_hash`."""
    said = {name: record[name] for name in (*IDENTITY, *FOUND) if record[name] is not None}
    identity = {name: said.pop(name) for name in IDENTITY if name in said}
    name = "objective" if record["travel_time_s"] is None else "travel_time_s"
    found = {name: cost(record), "command": command}
    return {**identity, **found, "task_hash": record["task_hash"], **said}


def _order(one: KnownValue) -> tuple[tuple[bool, str, float], ...]:
    """Texts by alphabet, numbers by size, what is missing first."""
    values = [*(one.get(name) for name in IDENTITY), one["command"] if "objective" in one else None]
    return tuple(
        (v is not None, "", v) if isinstance(v, int) else (v is not None, v or "", 0) for v in values
    )


def _read(path: Path) -> Iterable[KnownValue]:
    if not path.is_file():
        return []
    try:
        status = path.stat()
        found = _parsed(path, status.st_mtime_ns, status.st_size)
    except (OSError, yaml.YAMLError) as error:
        raise BadInput(str(path), f"cannot be read: {str(error).splitlines()[0]}") from None
    if not isinstance(found, list) or not all(map(_complete, found)):
        allowed = "a list of entries with task_hash, command and travel_time_s > 0 or objective, as `benchbench best` writes it"
        raise BadInput(str(path), "is no file of best known values", allowed)
    return found


@lru_cache(maxsize=8)
def _parsed(path: Path, changed: int, size: int) -> Any:
    """What a file says; read again when it is changed."""
    return yaml.load(path.read_bytes(), getattr(yaml, "CSafeLoader", yaml.SafeLoader)) or []


def _complete(one: Any) -> bool:
    if not isinstance(one, dict):
        return False
    if not all(isinstance(one.get(name), str) for name in ("task_hash", "command")):
        return False
    time, objective = one.get("travel_time_s"), one.get("objective")
    if time is None:
        return isinstance(objective, int | float) and math.isfinite(objective)
    return isinstance(time, int | float) and time > 0
