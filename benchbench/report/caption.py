"""What stands above a picture: what was planned, and the verdict."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def caption(record: Mapping[str, Any]) -> tuple[str, str]:
    """Return title and verdict of a run's plan from its record; the title names each choice once."""
    grid = None if record["intervals"] is None else f"N = {record['intervals']}"
    named = (
        *(record[k] for k in ("scenario", "vehicle", "dynamics")), grid,
        *(record[k] for k in ("relaxation", "solver", "strategy")),
    )  # fmt: skip
    title = ", ".join(str(name) for name in named if name)
    if record["certified"]:
        fullest = next(iter(record["limits_used_said"] or ()), "")
        return title, f"certified; closest to a limit: {fullest}" if fullest else "certified"
    return title, f"NOT certified: {next(iter(record['reasons'] or ()), record['status'])}"
