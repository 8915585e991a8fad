"""Which combinations of a sweep have been run already."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from pathlib import Path
from typing import Any

from benchbench.run.execution import BAD_INPUT, CERTIFIED, NOT_CERTIFIED
from benchbench.run.settings import Rerun
from benchbench.storage import provenance
from benchbench.storage.status import Status

ENDED_ITSELF = (
    Status.CERTIFIED, Status.UNCERTIFIED, Status.INFEASIBLE, Status.ITERATION_LIMIT, Status.TIME_LIMIT,
)  # fmt: skip
"""Statuses that are an answer; a run with another one is repeated by `rerun=failed`."""

REFUSED = (Status.BAD_INPUT, Status.INCOMPATIBLE, Status.UNAVAILABLE)
"""Statuses of runs that never began; skipped, they still end the program with exit code 2."""


def earlier(root: Path, rerun: Rerun, repeats: int) -> dict[str, int]:
    """Configuration hashes that need not run again with this version of the code, and their exit codes.

    A run that was timed fewer than `repeats` times counts as missing, unless it died before it was timed.
    """
    if rerun == "all":
        return {}
    from benchbench.storage.table import read

    rows = read(root)
    code = ("benchbench_version", "git_commit", "git_dirty")
    now = _code()
    found: dict[str, int] = {}
    for row in rows[["config_hash", "status", "certified", "repeats", *code]].to_dict("records"):
        if row["status"] == Status.PRUNED:
            continue
        same = all(_plain(row[name]) == now[name] for name in code)
        timed = row["status"] not in ENDED_ITSELF or _count(row["repeats"]) >= repeats
        if same and timed and (rerun == "missing" or row["status"] in ENDED_ITSELF):
            key = str(row["config_hash"])
            found[key] = min(found.get(key, BAD_INPUT), _exit_code(row))
    return found


def _code() -> dict[str, Any]:
    commit, dirty = provenance.git_state(provenance.CHECKOUT)
    version = provenance.version("benchbench")
    return {"benchbench_version": version, "git_commit": commit, "git_dirty": dirty}


def _exit_code(row: Mapping[Hashable, Any]) -> int:
    if _plain(row["certified"]) is True:
        return CERTIFIED
    return BAD_INPUT if row["status"] in REFUSED else NOT_CERTIFIED


def _count(value: Any) -> int:
    import pandas as pd

    return 1 if pd.isna(value) else int(value)


def _plain(value: Any) -> Any:
    """A cell without pandas' ways to say that it is empty."""
    import pandas as pd

    return None if pd.isna(value) else value if isinstance(value, str) else bool(value)
