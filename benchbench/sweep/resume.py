"""Which combinations of a sweep have been run already."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, final

from benchbench.run.execution import BAD_INPUT, CERTIFIED, NOT_CERTIFIED
from benchbench.run.numbers import Rerun
from benchbench.storage import provenance
from benchbench.storage.contents import source_hash
from benchbench.storage.status import Status

ENDED_ITSELF = (
    Status.CERTIFIED, Status.UNCERTIFIED, Status.INFEASIBLE, Status.ITERATION_LIMIT, Status.TIME_LIMIT,
)  # fmt: skip
"""Statuses that are an answer; a run with another one is repeated by `rerun=failed`."""

COLUMNS = ("run_id", "config_hash", "status", "certified", "repeats", "travel_time_s", "objective")
"""Columns of the table that say whether a run counts."""
REFUSED = (Status.BAD_INPUT, Status.INCOMPATIBLE, Status.UNAVAILABLE)
"""Statuses of runs that never began; skipped, they still end the program with exit code 2."""


@final
class Earlier:
    """Runs that need not run again with this version of the code; the table is read when first asked.

    A run that was timed fewer than `repeats` times counts as missing, unless it died before it was timed.
    """

    def __init__(self, root: Path, rerun: Rerun, repeats: int) -> None:
        """Take the folder of results and what the user asks for."""
        self._root, self._rerun, self._repeats = root, rerun, repeats
        self._seen: set[str] = set()
        self._found: dict[str, Mapping[str, Any]] = {}
        self._folders: dict[str, Path] | None = None
        self._code = _code()

    def exit_code(self, config_hash: str) -> int | None:
        """Exit code of the run with this configuration, None if there is none to count: one with all that it promises."""
        from benchbench.storage.adopt import whole

        row, folder = self._found.get(config_hash), self.folder(config_hash)
        return None if row is None or (folder is not None and not whole(folder, row)) else _exit_code(row)

    def folder(self, config_hash: str) -> Path | None:
        """Folder of the run with this configuration, None if only its row is there."""
        row = self._found.get(config_hash)
        return None if row is None else (self._folders or {}).get(row["run_id"])

    def read(self, ours: Collection[str]) -> None:
        """Read the rows that were added since the last time, but for those of our own runs, given by `run_id`.

        The first time, records without a row get one.
        """
        from benchbench.storage.adopt import adopt
        from benchbench.storage.table import added

        if self._folders is None:
            self._folders = adopt(self._root)
        for row in added(self._root, self._seen, (*COLUMNS, *self._code)):
            if row["run_id"] not in ours and self._counts(row):
                key = str(row["config_hash"])
                known = self._found.get(key)
                if known is None or _exit_code(row) < _exit_code(known):
                    self._found[key] = {name: row[name] for name in COLUMNS}

    def _counts(self, row: Mapping[str, Any]) -> bool:
        if row["status"] == Status.PRUNED or any(row[name] != now for name, now in self._code.items()):
            return False
        if row["status"] in ENDED_ITSELF:
            return (row["repeats"] or 1) >= self._repeats
        return self._rerun == "missing"


def _code() -> dict[str, Any]:
    """What a row has to say of the program that made it: the same source of BenchBench and of all plugins."""
    return {"benchbench_version": provenance.version("benchbench"), "source_hash": source_hash()}


def _exit_code(row: Mapping[str, Any]) -> int:
    if row["certified"] is True:
        return CERTIFIED
    return BAD_INPUT if row["status"] in REFUSED else NOT_CERTIFIED
