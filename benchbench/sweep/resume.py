"""Which combinations of a sweep have been run already."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from benchbench.settings import Rerun
from benchbench.storage import provenance
from benchbench.storage.status import Status

ENDED_ITSELF = (
    Status.CERTIFIED, Status.UNCERTIFIED, Status.INFEASIBLE, Status.ITERATION_LIMIT, Status.TIME_LIMIT,
)  # fmt: skip
"""Statuses that are an answer; a run with another one is repeated by `rerun=failed`."""


def earlier(root: Path, rerun: Rerun) -> dict[str, bool]:
    """Configuration hashes that need not run again with this version of the code, and whether certified."""
    if rerun == "all":
        return {}
    from benchbench.storage.table import read

    rows = read(root)
    code = ("benchbench_version", "git_commit", "git_dirty")
    now = _code()
    found: dict[str, bool] = {}
    for row in rows[["config_hash", "status", "certified", *code]].to_dict("records"):
        same = all(_plain(row[name]) == now[name] for name in code)
        if same and (rerun == "missing" or row["status"] in ENDED_ITSELF):
            key = str(row["config_hash"])
            found[key] = found.get(key, False) or _plain(row["certified"]) is True
    return found


def _code() -> dict[str, Any]:
    commit, dirty = provenance.git_state(provenance.CHECKOUT)
    version = provenance.version("benchbench")
    return {"benchbench_version": version, "git_commit": commit, "git_dirty": dirty}


def _plain(value: Any) -> Any:
    """A cell without pandas' ways to say that it is empty."""
    import pandas as pd

    return None if pd.isna(value) else value if isinstance(value, str) else bool(value)
